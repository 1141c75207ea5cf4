// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace inverse {

/// A pose as GstInverseDepthMeta has it: the first three rows of the matrix, row by row, that takes
/// meters in the camera's axes (x right, y down, z forward) to the world's.
using PoseRows = std::array<double, 12>;

/// Whether the numbers are finite, and the left part is a rotation.
bool is_pose(std::span<const double, 12> rows);

/// Where a camera was, by time.
class Trajectory {
 public:
  /// Reads a file as TUM RGB-D has: lines "time tx ty tz qx qy qz qw", in seconds and meters, the
  /// unit quaternion from the camera's axes to the world's. Lines that are something else become
  /// warnings. Throws Error(file) if it cannot be read or has no pose.
  Trajectory(const std::string& path, std::vector<std::string>& warnings);

  /// The pose between the two nearest ones, or the nearest one if only that is within `tolerance`
  /// (s); nothing if none is.
  std::optional<PoseRows> at(double seconds, double tolerance) const;
  /// "from A to B s", for messages.
  std::string span() const;

 private:
  struct Entry {
    double seconds;
    std::array<double, 3> place;
    std::array<double, 4> rotation;  // x, y, z, w
  };
  static PoseRows rows_between(const Entry& a, const Entry& b, double part);

  std::vector<Entry> entries_;  // in the order of time
};

}  // namespace inverse
