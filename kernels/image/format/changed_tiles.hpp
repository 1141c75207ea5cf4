// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "pixel_format.hpp"

namespace inverse {

/// Finds the tiles of 16 x 16 pixels whose bytes differ from those of the previous frame. Keeps a
/// copy of that frame.
class ChangedTiles {
 public:
  ChangedTiles(PixelFormat format, Extent extent);
  /// A plane of samples: its first row and the bytes from row to row (negative: bottom-up).
  struct Rows {
    const uint8_t* data;
    ptrdiff_t stride;
  };
  /// Compares the next frame, one Rows per plane of the format. Returns one byte per tile, row by
  /// row: 1 if it differs. Empty if there is no previous frame. Valid until the next call.
  std::span<const uint8_t> next(std::span<const Rows> planes);
  /// Forgets the previous frame.
  void reset() { known_ = false; }

 private:
  PixelFormat format_;
  Extent extent_;
  std::vector<uint8_t> before_, changed_;
  bool known_ = false;
};

}  // namespace inverse
