// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "calibration.hpp"
#include "gst/base/pictures/picture_file.hpp"
#include "trajectory.hpp"

namespace inverse {

/// How a recording is read. Empty texts and zeros leave it to the recording.
struct RecordingSettings {
  std::string location;
  std::string color_folder, depth_folder;  ///< inside it
  std::string calibration;                 ///< file, as read_calibration takes
  std::string poses;                       ///< file, as Trajectory takes
  double unit = 0;                         ///< meters of a step of depth
  double fx = 0, fy = 0, cx = 0, cy = 0;   ///< pixels of the picture
  double rate = 0;                         ///< pictures a second
  double max_difference = 20;  ///< ms between a picture and its depth image or pose, at most
};

/// A recording of a camera with depth in a folder: of TUM RGB-D, of 7-Scenes, or a folder for color
/// and one for depth (docs/reference/elements/rgbdsrc.md).
class Recording {
 public:
  /// A frame that was not read yet.
  struct Entry {
    double seconds = 0;
    std::string color, depth;              // paths; empty: missing
    std::optional<CalibratedCamera> lens;  // of the picture, if the recording has it for each
    std::optional<PoseRows> pose;
  };
  struct Frame {
    Picture8 color;
    Extent depth_extent;
    std::vector<uint16_t> depth;  ///< steps, row by row; 0: unknown
  };

  /// Lists the frames, and reads the first one. Throws Error if it has none that can be read.
  explicit Recording(const RecordingSettings& settings);

  size_t frames() const { return entries_.size(); }
  /// When a frame comes, counted from the first one; with n = frames() the end of the last one.
  double seconds(size_t n) const { return n < frames() ? entries_[n].seconds : end_; }
  /// The median time from frame to frame.
  double period() const { return period_; }
  /// Of all pictures.
  Extent extent() const { return extent_; }
  /// Meters of a step of depth.
  double unit() const { return unit_; }
  /// Of a frame's depth image.
  CalibratedCamera lens(size_t n) const;
  const std::optional<PoseRows>& pose(size_t n) const { return entries_[n].pose; }
  /// Pictures without depth image, and depth images without picture, which are left out.
  size_t unpaired() const { return unpaired_; }
  /// What a user should know of it.
  const std::vector<std::string>& warnings() const { return warnings_; }

  /// Reads a frame; may run in several threads. Throws Error(file) if a picture is missing,
  /// damaged, or of another size than the first.
  Frame read(size_t n) const;

 private:
  void leave_out_unpaired();
  void find_poses(const std::string& path);
  /// `period`: of a single frame.
  void count_from_zero(double period);
  void read_first();

  RecordingSettings settings_;
  std::vector<Entry> entries_;
  double end_ = 0, period_ = 0, unit_ = 0;
  CalibratedCamera camera_;  // of the pictures
  Extent extent_, depth_extent_;
  size_t unpaired_ = 0;
  std::optional<Registration> registration_;
  std::vector<std::string> warnings_;
};

}  // namespace inverse
