// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "small_picture.hpp"

namespace inverse::run {

/// Frames at equal intervals of a video of unknown length, tiled into one image.
///
/// Keeps every k-th frame; at twice the number of tiles it drops every second one and doubles k.
class ContactSheet {
 public:
  static constexpr int kColumns = 2, kRows = 3;
  static constexpr int kTileWidth = 640;  ///< pixels; the height follows the video's shape

  /// Adds the next frame. `caps` are of raw video in system memory; they may change.
  void offer(GstBuffer* buffer, const GstCaps* caps);
  /// Writes the sheet as PNG. Throws std::runtime_error if there are no frames or the file cannot
  /// be written.
  void write(const std::string& path) const;

 private:
  using Tile = std::vector<uint8_t>;  // RGB, kTileWidth × the maker's height, no padding
  SmallPictureMaker maker_{kTileWidth};
  std::vector<Tile> tiles_;
  uint64_t frames_ = 0, step_ = 1;
};

}  // namespace inverse::run
