#pragma once
#include <gst/gst.h>

#include <atomic>
#include <string>
#include <vector>

#include "key_color.hpp"
#include "small_picture.hpp"

namespace inverse::run {

/// Chooses what an intrinsicrecolor repaints from the first three seconds of a video: the color
/// that find_key_color finds, as bright as it is, in another hue; where there is none, every
/// surface in one paint. Says on stderr which.
class Paint {
 public:
  /// `recolor` stays as it is until something is chosen.
  explicit Paint(GstElement* recolor);
  Paint(const Paint&) = delete;
  Paint& operator=(const Paint&) = delete;
  ~Paint();

  /// Reads the first seconds and chooses. Does nothing where `uri` cannot be played.
  void choose_for(const std::string& uri);
  /// Takes a frame of a video that can be read only once; chooses when it has seen enough of them.
  void offer(GstBuffer* buffer, const GstCaps* caps);
  bool chosen() const { return chosen_; }

 private:
  void choose();

  GstElement* recolor_;
  SmallPictureMaker maker_;
  std::vector<LinearPicture> moments_;
  GstClockTime next_ = 0;  // when the next moment is taken
  std::atomic<bool> chosen_{false};
};

}  // namespace inverse::run
