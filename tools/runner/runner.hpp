#pragma once
#include <string>

#include "input.hpp"

namespace inverse::run {

enum class View { automatic, window, file };

struct Options {
  Input input;
  std::string chain;  ///< a piece of a gst-launch-1.0 line: takes raw video, gives raw video
  std::string folder = "out";  ///< where files go; made if it is not there
  std::string paint;   ///< the intrinsicrecolor in the chain that repaints what Paint chooses
  double seconds = 0;  ///< stop after that much video; 0: at its end
  View view = View::automatic;  ///< automatic: a window where a display answers, else files
};

/// Plays the input through the chain: in a window, in time, or to FOLDER/decomposition.mkv (VP8,
/// the sound as it came) and FOLDER/contact-sheet.png, as fast as it goes. Progress goes to
/// stderr, what was written and how fast it went to stdout. Ctrl-C ends early and properly. Throws
/// std::runtime_error with a message for the user.
void run(const Options& options);

}  // namespace inverse::run
