// SPDX-License-Identifier: LGPL-2.1-or-later
// Frames with ground truth from the renderer of the bundled clip.
#pragma once
#include "tests/bench/support/scene.hpp"
#include "tools/clip/transport.hpp"

namespace inverse::bench {

/// A scene as a camera would deliver it, 8 bits of sRGB, with reflectance, direct and indirect
/// light.
TruthFrame rendered(const clip::Scene& scene, int width, int height, clip::Quality quality);

inline clip::Paint plain(clip::Vec3 color) { return {clip::Pattern::kPlain, {color}, 1, ""}; }

}  // namespace inverse::bench
