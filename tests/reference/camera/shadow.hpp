// SPDX-License-Identifier: LGPL-2.1-or-later
// Specification of kernels/camera/shadow.glsl.
#pragma once
#include "volume.hpp"

namespace inverse::reference {

/// How much of a lamp is seen along a ray of length `reach` in a unit direction; meters. The least
/// of 1/2 + d / 2 w over the ray, in steps of a tenth of a voxel: d is the distance to a surface, w
/// `spread` times the way there, from a voxel to a truncation. What was never seen is free.
double lit_share(const Volume& volume, const Vec3& from, const Vec3& way, double reach,
                 double spread);

}  // namespace inverse::reference
