// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/gst.h>

#include <cstdint>
#include <string>
#include <vector>

namespace inverse::testing {

/// A decoded picture, packed RGB.
struct Image {
  int width = 0, height = 0;
  std::vector<uint8_t> rgb;

  /// Mean of one channel (0…2) over the rectangle in fractions of the image, 0…255.
  double mean(int channel, double left = 0, double top = 0, double right = 1,
              double bottom = 1) const;
  /// Variance of the channels' mean over the same.
  double variance(double left = 0, double top = 0, double right = 1, double bottom = 1) const;
};

/// Content of a file.
struct Media {
  std::vector<Image> frames;
  std::vector<GstClockTime> times;  ///< presentation time of each frame
  struct Sound {
    std::string caps;
    std::vector<std::vector<uint8_t>> packets;  ///< undecoded, as stored in the file
  };
  std::vector<Sound> sounds;
  std::vector<std::string> errors;
};

/// Reads a file of video and sound, or a picture.
Media read_media(const std::string& path, unsigned seconds = 60);

/// Fails the test if the video has another size, fewer frames, times that do not increase, or
/// images that are black or uniform.
void expect_video(const Media& media, int width, int height, size_t min_frames);

/// Writes a file with a launch line that ends in a muxer; "name" of the sink is filled in.
void make_media(const std::string& path, const std::string& line);

}  // namespace inverse::testing
