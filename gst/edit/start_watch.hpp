// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/gst.h>

#include <memory>
#include <string>

namespace inverse {

/// Watches the push of a frame through a pad of intrinsicsplit while other pads wait for their
/// first one. If what follows the pad waits for those others, neither ever comes: that is warned of
/// on the bus after two seconds, once. A slow element is none to warn of, nor is a paused pipeline.
///
/// The system clock calls it: no main loop is needed.
class StartWatch {
 public:
  /// `waiting` names the pads that got no frame yet.
  StartWatch(GstElement* split, GstPad* pad, const std::string& waiting);
  StartWatch(const StartWatch&) = delete;
  StartWatch& operator=(const StartWatch&) = delete;
  /// The push has returned.
  ~StartWatch();

 private:
  struct State;
  std::shared_ptr<State> state_;
  GstClockID id_;
};

}  // namespace inverse
