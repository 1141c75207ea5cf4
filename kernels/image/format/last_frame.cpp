// SPDX-License-Identifier: LGPL-2.1-or-later
#include "last_frame.hpp"

#include <cstring>

namespace inverse {
namespace {
constexpr uint32_t kStep = 16;      // rows from one that is compared to the next if many differed
constexpr uint32_t kDifferent = 8;  // frames in a row; film at 30 Hz repeats one of five
}  // namespace

LastFrame::LastFrame(PixelFormat format, Extent extent) : format_(format), extent_(extent) {
  for (uint32_t plane = 0; plane < format.planes; ++plane)
    bytes_ += size_t{row_bytes(format, extent, plane)} * plane_rows(format, extent, plane);
}

bool LastFrame::repeats(std::span<const Rows> planes) {
  before_.resize(bytes_);
  const bool some = known_ && different_ >= kDifferent;  // rows are kept, not all
  if (some && !keep(planes, kStep, true)) return false;
  const bool compare = known_ && !some, same = keep(planes, 1, compare);
  different_ = compare && !same ? different_ + 1 : 0;
  known_ = true;
  return same;
}

bool LastFrame::keep(std::span<const Rows> planes, uint32_t step, bool compare) {
  bool same = compare;
  uint8_t* of_plane = before_.data();
  for (uint32_t plane = 0; plane < planes.size(); ++plane) {
    const size_t bytes = row_bytes(format_, extent_, plane);
    const uint32_t rows = plane_rows(format_, extent_, plane);
    for (uint32_t row = 0; row < rows; row += step) {
      uint8_t* before = of_plane + row * bytes;
      const uint8_t* now = planes[plane].data + static_cast<ptrdiff_t>(row) * planes[plane].stride;
      same = same && memcmp(before, now, bytes) == 0;
      if (!same) memcpy(before, now, bytes);
    }
    of_plane += rows * bytes;
  }
  return same;
}

}  // namespace inverse
