// SPDX-License-Identifier: LGPL-2.1-or-later
// What follows a depth camera and fuses its frames, behind one interface, for comparison.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "rgbd_source.hpp"

namespace inverse::bench {

/// A frame, on the device and on the host.
struct Seen {
  RgbdFrame frame;
  std::vector<float> depth;  ///< meters, 0 where unknown
  Pixels picture;            ///< linear RGB, w = 1
};

/// What all of them are given.
struct Setting {
  Extent extent;
  Lens lens;
  Pose first;                           ///< of the first frame
  std::array<double, 3> low{}, high{};  ///< corners of a box around the scene, meters
  double voxel = 0.01;                  ///< meters
  bool tracked = true;                  ///< false: frames are where their pose says
};

class Follower {
 public:
  virtual ~Follower() = default;
  /// Follows the camera to a frame and adds it. False: the camera is lost, and nothing was added.
  virtual bool follow(const Lab& lab, const Seen& seen) = 0;
  virtual Pose pose(const Lab& lab) const = 0;
  /// The surface from a pose: meters along the optical axis, 0 where there is none. Empty: it keeps
  /// none, or does not show it.
  virtual std::vector<float> depth_from(const Lab&, const Pose&) { return {}; }
  /// Of the last frame, ms: following, fusion, rendering of what the next frame is followed by.
  std::array<double, 3> parts{};
  uint64_t bytes = 0;  ///< that it has allocated
};

struct NamedFollower {
  std::string name;
  /// Null, after a message, if this build of a library lacks it.
  std::function<std::unique_ptr<Follower>(const Lab&, const Setting&)> make;
};
/// Tracker and Volume, with brightness and by geometry alone. The picture is in place of
/// reflectance: the truth is not used.
std::vector<NamedFollower> own_followers();
/// OpenCV's module rgbd, on the CPU.
std::vector<NamedFollower> opencv_followers();

}  // namespace inverse::bench
