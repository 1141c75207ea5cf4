// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <string>

#include "input.hpp"

namespace inverse::run {

enum class View { automatic, window, file };

struct Options {
  Input input;
  std::string chain;            ///< a piece of a gst-launch-1.0 line: raw video in, raw video out
  std::string folder = "out";   ///< output folder; created if missing
  std::string paint;            ///< name of the intrinsicrecolor in the chain that Paint sets
  bool overwrite = false;       ///< replace files of an earlier run
  double seconds = 0;           ///< stop after this much video; 0: at its end
  View view = View::automatic;  ///< automatic: a window if a display is available, else files
};

/// Plays the input through the chain: in a window in real time, or as fast as possible to
/// FOLDER/decomposition.mkv (VP8, original sound) and FOLDER/contact-sheet.png. Prints progress to
/// stderr, the written files and the speed to stdout. Ctrl-C ends early and finishes the files.
/// They appear when they are whole; what is there is only replaced if `overwrite` is set.
/// Throws std::runtime_error with a message for the user.
void run(const Options& options);

}  // namespace inverse::run
