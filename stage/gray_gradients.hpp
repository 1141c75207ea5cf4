#pragma once

namespace inverse {

/// The warning where gradients come from a camera without color.
inline constexpr const char* kGrayGradients =
    "the gradients come as gray video, which does not hold what red, green and blue light tell of "
    "directions: use a color camera (of a Bayer sensor, bayer2rgb), or take a frame for each color "
    "of the gradients and join them";

}  // namespace inverse
