// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/gst.h>

#include <string>

namespace inverse::run {

/// Source of video: a file, a URI or a camera device.
struct Input {
  bool live = false;      ///< a camera: frames arrive in real time
  std::string location;   ///< the device of a camera, else a URI
  std::string described;  ///< the user's text, for messages
};

/// Parses the user's text: "/dev/video0", "rtsp://…", "clip.mp4". Throws std::runtime_error with a
/// message for the user if it does not exist or cannot be opened. If it is a file, no list of
/// streams is played from then on: it would open connections to the hosts that it names.
Input parse_input(const std::string& text);

/// Whether caps are those of a list of streams.
bool is_list(const GstCaps* caps);

}  // namespace inverse::run
