#pragma once
#include <string>

namespace inverse::run {

/// Where video comes from: a file, a URI or a camera device.
struct Input {
  bool live = false;      ///< a camera: frames come when they come
  std::string location;   ///< the device for a camera, else a URI
  std::string described;  ///< for messages: what the user wrote
};

/// Understands what the user wrote: "/dev/video0", "rtsp://…", "clip.mp4". Throws
/// std::runtime_error with a message for the user where it does not exist or nothing here can open
/// it.
Input parse_input(const std::string& text);

}  // namespace inverse::run
