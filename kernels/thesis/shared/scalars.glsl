// SPDX-License-Identifier: LGPL-2.1-or-later
// The scalars of conjugate gradients on the device.
#define CG_RZ 0          // rᵀz
#define CG_ALPHA 1
#define CG_BETA 2
#define CG_FIRST_RZ 3    // rᵀz at the start of the first of several systems
#define CG_CONTINUES 4   // 1, or 0 below the tolerance
#define CG_ITERATIONS 5  // of all systems since the scalars were cleared
#define CG_SIZE 6
