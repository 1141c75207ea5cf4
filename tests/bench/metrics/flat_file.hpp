// SPDX-License-Identifier: LGPL-2.1-or-later
// Flat dumps of images: no libraries, for programs that are copied to other machines.
#pragma once

#include <string>
#include <vector>

#include "image.hpp"

namespace inverse::bench {

/// A flat dump: the text line "F32 width height channels frames" (further words after it are the
/// writer's own), then little-endian float32, frame by frame, row by row, pixel by pixel.
struct FlatFile {
  std::string words;  ///< what follows the numbers on the first line
  std::vector<Image> frames;
};
FlatFile read_flat(const std::string& path);
void write_flat(const std::string& path, const FlatFile& file);

/// Channels `first` … `first + count - 1`.
Image channels(const Image& image, int first, int count);
/// All images side by side in one; equal sizes.
Image stacked(const std::vector<const Image*>& images);

}  // namespace inverse::bench
