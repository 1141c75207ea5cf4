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
/// copy of that frame; while most tiles change, only of every 16th row, by which it sees that they
/// no longer do: a copy of 3840 x 2160 takes longer than the frame on a GPU.
class ChangedTiles {
 public:
  ChangedTiles(PixelFormat format, Extent extent);
  /// A plane of samples: its first row and the bytes from row to row (negative: bottom-up).
  struct Rows {
    const uint8_t* data;
    ptrdiff_t stride;
  };
  /// Compares the next frame, one Rows per plane of the format. Returns one byte per tile, row by
  /// row: 1 if it differs. Empty if it is not known: without a previous frame, or while most tiles
  /// change. Valid until the next call.
  std::span<const uint8_t> next(std::span<const Rows> planes);
  /// Forgets the previous frame.
  void reset() {
    known_ = false;
    moving_ = 0;
  }

 private:
  /// Whether most tiles change, by every 16th row.
  bool moves(std::span<const Rows> planes);
  bool over_half_changed() const;
  /// Flags the tiles that differ in every step-th row, unless not to compare, and keeps the rows.
  void find_changed(std::span<const Rows> planes, uint32_t step, bool compare);

  PixelFormat format_;
  Extent extent_;
  size_t bytes_ = 0;             // of a frame
  std::vector<uint8_t> before_;  // empty until the first frame, as the device may refuse the size
  std::vector<uint8_t> changed_;
  bool known_ = false;
  uint32_t moving_ = 0;  // frames running of which most tiles changed
};

}  // namespace inverse
