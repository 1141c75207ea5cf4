// SPDX-License-Identifier: LGPL-2.1-or-later
const float kDarkest = -3.9;  // ln of the brightest channel below which a cell is dark: 2 % of full scale
