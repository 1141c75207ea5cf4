#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "pixel_format.hpp"

namespace inverse {

/// Finds the tiles of 16 x 16 pixels of a frame in memory whose bytes are not those of the frame
/// before. Keeps a copy of that frame.
class ChangedTiles {
 public:
  ChangedTiles(PixelFormat format, Extent extent);
  /// A plane of samples: its first row, and bytes from a row to the next (negative upside down).
  struct Rows {
    const uint8_t* data;
    ptrdiff_t stride;
  };
  /// Takes the next frame, a Rows for each of the format's planes. Returns a byte a tile, row by
  /// row, 1 where it differs, valid until the next call; empty where there is no frame before.
  std::span<const uint8_t> next(std::span<const Rows> planes);
  /// The next frame has none before it.
  void reset() { known_ = false; }

 private:
  PixelFormat format_;
  Extent extent_;
  std::vector<uint8_t> before_, changed_;
  bool known_ = false;
};

}  // namespace inverse
