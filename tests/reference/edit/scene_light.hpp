// SPDX-License-Identifier: LGPL-2.1-or-later
// Specification of kernels/edit/relight/scene_light.comp.
#pragma once
#include "relight.hpp"
#include "tests/reference/volume/volume.hpp"

namespace inverse::reference {

/// Light of lamps in the world on what a pixel sees of a scene: normal toward the camera in its
/// axes and depth, 0 where unknown. The volume's normal is taken where it is known and of the same
/// surface.
Rgb scene_light(const Camera& camera, int x, int y, const Rgba& surface,
                const std::vector<SceneLamp>& lamps, const Volume& volume, bool shadows);

}  // namespace inverse::reference
