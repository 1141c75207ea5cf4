// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "kernels/camera/camera.hpp"

namespace inverse {

/// Frames whose pose is known, by small pictures of brightness and depth: where a camera that is
/// lost may be. Needs no device.
class Keyframes {
 public:
  /// A frame in cells: ln brightness; depth in meters, 0 where it is unknown.
  struct Picture {
    std::vector<float> brightness, depth;
  };
  /// One of those that are remembered.
  struct Frame {
    Picture picture;
    Pose pose;
  };
  explicit Keyframes(size_t limit) : limit_(limit) {}

  /// Remembers a frame if it is unlike all others and there is room.
  void add(const Picture& picture, const Pose& pose);
  /// The poses of the frames most like this one, best first, at most `count`.
  std::vector<Pose> like(const Picture& picture, size_t count) const;
  size_t size() const { return frames_.size(); }
  const std::vector<Frame>& frames() const { return frames_; }
  /// Takes the place of all: the first `limit` of these.
  void set(std::vector<Frame> frames) {
    frames_ = std::move(frames);
    if (frames_.size() > limit_)
      frames_.erase(frames_.begin() + static_cast<std::ptrdiff_t>(limit_), frames_.end());
  }

  /// Mean over cells of the differences: of ln brightness without its mean, at most 1; and of
  /// inverse depth in units of .2 per meter, at most 1; 1 where only one of them knows the depth.
  static double distance(const Picture& a, const Picture& b);

 private:
  size_t limit_;
  std::vector<Frame> frames_;
};

}  // namespace inverse
