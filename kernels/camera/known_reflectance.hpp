// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "kernels/gpu/buffer.hpp"
#include "kernels/image/plane.hpp"

namespace inverse {

/// What is known of a frame's surfaces before it is decomposed. Of the size `extent`, it shows what
/// the frame shows, if that has another size.
struct KnownReflectance {
  Extent extent;
  gpu::BufferPtr reflectance;  ///< vec4 a pixel: ln R; w: confidence, 0…1
  gpu::BufferPtr known_depth;  ///< a scalar a pixel, meters: of these surfaces; 0: nothing is known
  gpu::BufferPtr depth;        ///< the same of the frame
  gpu::BufferPtr valid;        ///< a vec4, x: 0 if none of it counts
  float weight = 0;            ///< of each pixel, against those of the method's other terms
  /// A vec4 a pixel: unit normal of these surfaces toward the camera in its axes, 0 where unknown;
  /// w: known_depth.
  gpu::BufferPtr surface = nullptr;
  gpu::BufferPtr outdated = nullptr;  ///< a word: 0 if `surface` is that of the frame before
  float focal = 0;                    ///< focal length of `surface`, pixels
};

}  // namespace inverse
