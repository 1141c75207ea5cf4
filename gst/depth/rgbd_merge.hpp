// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/base/gstaggregator.h>
#include <gst/video/video.h>

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "calibration.hpp"
#include "gst/base/property_table.hpp"
#include "trajectory.hpp"

namespace inverse {

struct RgbdMergeParams {
  enum class Unpaired { drop, pass };
  std::string calibration, poses;
  double poses_start = 0;
  double unit = 0.001, fx = 0, fy = 0, cx = 0, cy = 0;
  double max_difference = 20;
  Unpaired unpaired = Unpaired::drop;
};
const PropertyTable<RgbdMergeParams>& rgbd_merge_properties();

/// Finds the depth image of each picture by its time, and attaches it.
class RgbdMerge {
 public:
  RgbdMerge(GstElement* element, GstAggregatorPad* color, GstAggregatorPad* depth)
      : element_(element), color_(color), depth_(depth), parameters_(rgbd_merge_properties()) {}
  ~RgbdMerge();

  PropertyStore& parameters() { return parameters_; }
  /// The caller owns it.
  GstStructure* stats() const;
  /// READY → PAUSED: reads calibration and poses. Throws Error.
  void start();
  void stop();
  void flush();
  void set_color_caps(const GstCaps* caps);
  /// Those of the pictures that `aggregate` takes next; a new reference, or null before there are.
  GstCaps* color_caps() const;
  /// Throws Error(unsupported).
  void set_depth_caps(const GstCaps* caps);
  /// `timeout`: what did not come yet will not be waited for.
  GstFlowReturn aggregate(GstAggregator* aggregator, bool timeout);

  GstAggregatorPad* color() const { return color_; }

 private:
  GstFlowReturn push(GstAggregator* aggregator, GstBuffer* color, bool paired,
                     GstClockTime difference);
  void attach(GstBuffer* color, const RgbdMergeParams& params);
  std::optional<PoseRows> pose_of(GstBuffer* color, const RgbdMergeParams& params);
  void drop_depth();

  GstElement* element_;
  GstAggregatorPad *color_, *depth_;  // which the element has
  Parameters<RgbdMergeParams> parameters_;
  /// How to read depth images of some caps.
  struct DepthFormat {
    GstVideoInfo info;
    std::optional<Registration> registration;
  };
  GstVideoInfo color_info_{};
  GstCaps* color_caps_ = nullptr;
  std::shared_ptr<const DepthFormat> depth_format_;  // of the caps now
  std::optional<Calibration> calibration_;
  std::vector<uint16_t> registered_;
  std::optional<Trajectory> trajectory_;
  GstBuffer* held_ = nullptr;  // the last depth image
  std::shared_ptr<const DepthFormat> held_format_;
  GstClockTime held_time_ = GST_CLOCK_TIME_NONE;
  bool held_used_ = false;
  mutable std::mutex mutex_;  // for the counts
  guint64 merged_ = 0, unpaired_ = 0, depth_dropped_ = 0, posed_ = 0;
  guint recent_ = 0, recent_unpaired_ = 0;  // pictures since unpaired ones were last counted
  bool told_ = false;                       // that these were too many
};

}  // namespace inverse
