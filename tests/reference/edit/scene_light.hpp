// SPDX-License-Identifier: LGPL-2.1-or-later
// Specification of kernels/edit/relight/scene_shadows.comp and scene_light.comp.
#pragma once
#include "relight.hpp"
#include "tests/reference/camera/volume.hpp"

namespace inverse::reference {

/// Light of lamps in the world on what the pixels of a view see of a scene: normal toward the
/// camera in its axes and depth, 0 where unknown. Shadows and normals are those of every second
/// pixel, bilinear in between among those of the same surface. The volume's normal is taken where
/// it is known and of the same surface.
std::vector<Rgb> scene_light(const Camera& camera, const Plane& surface,
                             const std::vector<SceneLamp>& lamps, const Volume& volume,
                             bool shadows);

}  // namespace inverse::reference
