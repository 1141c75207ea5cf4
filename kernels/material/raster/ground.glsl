// SPDX-License-Identifier: LGPL-2.1-or-later
// Grids on the ground below an object of radius 1 at the origin: x right, y (rows) towards the camera.
const float kPerUnit = 16.0;  // pixels a unit
const int kHeights = 32;      // the object's underside, from -1 to 1
const int kOcclusion = 64;    // from -kReach to kReach
const float kReach = 2.0;
