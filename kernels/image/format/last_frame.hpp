// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "pixel_format.hpp"

namespace inverse {

/// Compares each frame with the one before, byte by byte, up to the first difference. Keeps a copy
/// of that frame; once many differed, only of every 16th row, until these no longer do: a copy of
/// 3840 x 2160 takes longer than the frame on a GPU.
class LastFrame {
 public:
  LastFrame(PixelFormat format, Extent extent);
  /// A plane of samples: its first row and the bytes from row to row (negative: bottom-up).
  struct Rows {
    const uint8_t* data;
    ptrdiff_t stride;
  };
  /// Whether the next frame, one Rows per plane of the format, is the same as the one before.
  /// False if that is not known: without a frame before, or after a copy of some rows.
  bool repeats(std::span<const Rows> planes);
  /// Forgets the frame before.
  void reset() {
    known_ = false;
    different_ = 0;
  }

 private:
  /// Keeps every step-th row; returns whether all of them are those kept before, false if not to
  /// compare.
  bool keep(std::span<const Rows> planes, uint32_t step, bool compare);

  PixelFormat format_;
  Extent extent_;
  size_t bytes_ = 0;             // of a frame
  std::vector<uint8_t> before_;  // empty until the first frame, as the device may refuse the size
  bool known_ = false;           // there is a frame before
  uint32_t different_ = 0;       // frames in a row that differed
};

}  // namespace inverse
