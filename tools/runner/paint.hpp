// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/gst.h>

#include <atomic>
#include <string>
#include <vector>

#include "key_color.hpp"
#include "small_picture.hpp"

namespace inverse::run {

/// Chooses the color that an intrinsicrecolor repaints from the first three seconds of a video: the
/// color found by find_key_color, in another hue of the same brightness. Without such a color, all
/// surfaces become one paint. Prints the choice to stderr.
class Paint {
 public:
  /// `recolor` is unchanged until the choice.
  explicit Paint(GstElement* recolor);
  Paint(const Paint&) = delete;
  Paint& operator=(const Paint&) = delete;
  ~Paint();

  /// Reads the first seconds and chooses. Does nothing if `uri` cannot be played.
  void choose_for(const std::string& uri);
  /// Adds a frame of a video that can be read only once; chooses after enough frames.
  void offer(GstBuffer* buffer, const GstCaps* caps);
  bool chosen() const { return chosen_; }

 private:
  void choose();

  GstElement* recolor_;
  SmallPictureMaker maker_;
  std::vector<LinearPicture> moments_;
  GstClockTime next_ = 0;  // time of the next sample
  std::atomic<bool> chosen_{false};
};

}  // namespace inverse::run
