// SPDX-License-Identifier: LGPL-2.1-or-later
const float kJump = 0.03;  // of the depth: neighbors of one surface differ by less
