// SPDX-License-Identifier: LGPL-2.1-or-later
// Shared by the tone kernels.
const float kShadingFloor = 0.001953125;  // 2^-9: darker shading counts as this dark
