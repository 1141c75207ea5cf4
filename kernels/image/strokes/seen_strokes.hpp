// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <optional>
#include <span>

#include "kernels/gpu/buffer.hpp"
#include "stroke.hpp"

namespace inverse {

/// Strokes of a remembered scene as a frame sees them. The images show what the frame shows, in a
/// size of their own.
struct SeenStrokes {
  Extent extent;
  gpu::BufferPtr ids;          ///< a word a pixel: 0, or the id of its stroke
  gpu::BufferPtr known_depth;  ///< a scalar a pixel, meters: of the surface that has it
  gpu::BufferPtr depth;        ///< the same of the frame; 0: unknown
  gpu::BufferPtr valid;        ///< a vec4, x: 0 if none of it counts
  std::span<const std::optional<Stroke>> strokes;  ///< by id, from 1 on

  /// 0: the scene does not have it.
  uint32_t id_of(const Stroke& stroke) const {
    for (uint32_t i = 0; i < strokes.size(); ++i)
      if (strokes[i] == stroke) return i + 1;
    return 0;
  }
};

}  // namespace inverse
