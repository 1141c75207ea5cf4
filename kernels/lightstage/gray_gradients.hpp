// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

namespace inverse {

/// Warning if gradients come from a gray camera.
inline constexpr const char* kGrayGradients =
    "the gradients are gray video, which lacks the directions that red, green and blue light "
    "encode: use a color camera (for a Bayer sensor, bayer2rgb), or take one frame per color of "
    "the gradients and join them";

}  // namespace inverse
