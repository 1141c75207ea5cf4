// SPDX-License-Identifier: LGPL-2.1-or-later
#include "rgbd_merge.hpp"

#include <algorithm>
#include <span>
#include <utility>

#include "gst/base/log/errors.hpp"
#include "gst/base/log/log.hpp"
#include "gst/depth/meta/depth_meta.hpp"

namespace inverse {
namespace {

constexpr guint kPictures = 30, kMaxUnpaired = 18;  // of these
constexpr guint64 kManyUnposed = 30;

GstClockTime running_time(GstAggregatorPad* pad, GstBuffer* buffer) {
  return gst_segment_to_running_time(&pad->segment, GST_FORMAT_TIME, GST_BUFFER_PTS(buffer));
}

GstClockTime apart(GstClockTime a, GstClockTime b) {
  if (!GST_CLOCK_TIME_IS_VALID(a) || !GST_CLOCK_TIME_IS_VALID(b)) return GST_CLOCK_TIME_NONE;
  return a > b ? a - b : b - a;
}

}  // namespace

const PropertyTable<RgbdMergeParams>& rgbd_merge_properties() {
  using P = RgbdMergeParams;
  constexpr Mutable kReady = Mutable::ready;
  static const PropertyTable<P> table{
      text<P>(
          "calibration", &P::calibration,
          "JSON file with both cameras and how they stand to each other (OpenCV's conventions); "
          "empty = depth shows what the picture shows, with the lens of fx, fy, cx, cy",
          kReady),
      text<P>(
          "poses", &P::poses,
          "File with the poses of the camera of the pictures, as TUM RGB-D has: lines \"time tx "
          "ty tz qx qy qz qw\"; empty = those that pictures or depth images bring",
          kReady),
      number<P>("poses-start", &P::poses_start, -1e10, 1e10,
                "Time in that file at which pictures begin (stream time 0), s"),
      number<P>("depth-unit", &P::unit, 1e-6, 1.,
                "Meters of a step of depth; a calibration's wins"),
      number<P>("fx", &P::fx, 0., 1e5,
                "Focal length in pixels of the picture; 0 = a view of 62 degrees across"),
      number<P>("fy", &P::fy, 0., 1e5, "The same along y; 0 = as fx"),
      number<P>("cx", &P::cx, 0., 1e5, "Center in pixels of the picture; 0 = its middle"),
      number<P>("cy", &P::cy, 0., 1e5, "The same along y; 0 = its middle"),
      number<P>("max-difference", &P::max_difference, 0., 1e4,
                "Time between a picture and its depth image or pose, at most, ms"),
      choice<P>("unpaired", &P::unpaired, "GstInverseRgbdUnpaired",
                {{int(P::Unpaired::drop), "drop", "Drop pictures that have no depth image"},
                 {int(P::Unpaired::pass), "pass", "Let them pass without depth"}},
                "What becomes of pictures without a depth image of their time"),
  };
  return table;
}

RgbdMerge::~RgbdMerge() {
  drop_depth();
  gst_clear_caps(&color_caps_);
}

GstStructure* RgbdMerge::stats() const {
  std::lock_guard lock(mutex_);
  return gst_structure_new("inverse-stats", "merged", G_TYPE_UINT64, merged_, "unpaired",
                           G_TYPE_UINT64, unpaired_, "depth-dropped", G_TYPE_UINT64, depth_dropped_,
                           "posed", G_TYPE_UINT64, posed_, nullptr);
}

void RgbdMerge::start() {
  const RgbdMergeParams params = parameters_.snapshot();
  calibration_.reset();
  depth_format_.reset();
  trajectory_.reset();
  if (!params.calibration.empty()) calibration_ = read_calibration(params.calibration);
  if (!params.poses.empty()) {
    std::vector<std::string> warnings;
    trajectory_.emplace(params.poses, warnings);
    for (const std::string& warning : warnings)
      post_warning(log_of(element_), Error(ErrorKind::file, warning));
  }
  gst_video_info_init(&color_info_);
  std::lock_guard lock(mutex_);
  merged_ = unpaired_ = depth_dropped_ = posed_ = 0;
  recent_ = recent_unpaired_ = 0;
  told_ = false;
}

void RgbdMerge::stop() {
  drop_depth();
  gst_clear_caps(&color_caps_);
}
void RgbdMerge::flush() { drop_depth(); }

void RgbdMerge::drop_depth() {
  gst_clear_buffer(&held_);
  held_format_.reset();
  held_time_ = GST_CLOCK_TIME_NONE;
}

void RgbdMerge::set_color_caps(const GstCaps* caps) {
  if (!gst_video_info_from_caps(&color_info_, caps))
    throw Error(ErrorKind::unsupported, "rgbdmerge cannot make sense of the pictures' format");
  gst_caps_replace(&color_caps_, const_cast<GstCaps*>(caps));
}

GstCaps* RgbdMerge::color_caps() const { return color_caps_ ? gst_caps_ref(color_caps_) : nullptr; }

void RgbdMerge::set_depth_caps(const GstCaps* caps) {
  auto format = std::make_shared<DepthFormat>();
  if (!gst_video_info_from_caps(&format->info, caps))
    throw Error(ErrorKind::unsupported, "rgbdmerge cannot make sense of the depth's format");
  if (calibration_)
    format->registration.emplace(*calibration_, Extent{static_cast<uint32_t>(format->info.width),
                                                       static_cast<uint32_t>(format->info.height)});
  depth_format_ = std::move(format);
}

GstFlowReturn RgbdMerge::aggregate(GstAggregator* aggregator, bool timeout) {
  GstBuffer* color = gst_aggregator_pad_peek_buffer(color_);
  if (!color) {
    if (gst_aggregator_pad_is_eos(color_)) return GST_FLOW_EOS;
    return GST_AGGREGATOR_FLOW_NEED_DATA;
  }
  const GstClockTime time = running_time(color_, color);
  const RgbdMergeParams params = parameters_.snapshot();
  // The depth image nearest in time: the first that is behind the picture ends the search.
  bool waits = false;
  for (;;) {
    GstBuffer* next = gst_aggregator_pad_peek_buffer(depth_);
    if (!next) {
      const bool behind = held_ && GST_CLOCK_TIME_IS_VALID(held_time_) && held_time_ >= time;
      waits = !behind && !timeout && !gst_aggregator_pad_is_eos(depth_);
      break;
    }
    const GstClockTime next_time = running_time(depth_, next);
    gst_buffer_unref(next);
    if (held_ && apart(next_time, time) > apart(held_time_, time)) break;
    if (held_ && !held_used_) {
      std::lock_guard lock(mutex_);
      ++depth_dropped_;
    }
    drop_depth();
    held_ = gst_aggregator_pad_pop_buffer(depth_);
    held_format_ = depth_format_;
    held_time_ = next_time;
    held_used_ = false;
  }
  if (waits) {
    gst_buffer_unref(color);
    return GST_AGGREGATOR_FLOW_NEED_DATA;
  }
  const auto most = static_cast<GstClockTime>(params.max_difference * GST_MSECOND);
  const bool paired = held_ && apart(held_time_, time) <= most;
  gst_buffer_unref(color);
  color = gst_aggregator_pad_pop_buffer(color_);
  if (!color) return GST_AGGREGATOR_FLOW_NEED_DATA;  // a flush took it
  if (paired) {
    color = gst_buffer_make_writable(color);
    if (!guarded(element_, [&] { attach(color, params); })) {
      gst_buffer_unref(color);
      return GST_FLOW_ERROR;
    }
    held_used_ = true;
  }
  if (!paired && params.unpaired == RgbdMergeParams::Unpaired::drop) {
    gst_buffer_unref(color);
    color = nullptr;
  }
  return push(aggregator, color, paired, held_ ? apart(held_time_, time) : GST_CLOCK_TIME_NONE);
}

GstFlowReturn RgbdMerge::push(GstAggregator* aggregator, GstBuffer* color, bool paired,
                              GstClockTime difference) {
  const std::string nearest = GST_CLOCK_TIME_IS_VALID(difference)
                                  ? std::to_string(difference / GST_MSECOND) + " ms away"
                                  : "there is none";
  bool warns = false, unposed = false;
  guint unpaired = 0;
  {
    std::lock_guard lock(mutex_);
    ++(paired ? merged_ : unpaired_);
    recent_unpaired_ += paired ? 0 : 1;
    if (++recent_ == kPictures) {
      unpaired = std::exchange(recent_unpaired_, 0);
      recent_ = 0;
      const bool many = unpaired > kMaxUnpaired;
      warns = !std::exchange(told_, many) && many;
    }
    unposed = paired && merged_ == kManyUnposed && posed_ == 0 && trajectory_;
  }
  if (warns)
    post_warning(
        log_of(element_), GST_STREAM_ERROR, GST_STREAM_ERROR_FAILED,
        "%u of %u pictures have no depth image within max-difference (the last one's "
        "nearest: %s): the time stamps of color and depth differ; raise max-difference, or "
        "give both the same clock and rate",
        unpaired, kPictures, nearest.c_str());
  if (unposed)
    post_warning(log_of(element_), GST_STREAM_ERROR, GST_STREAM_ERROR_FAILED,
                 "none of %" G_GUINT64_FORMAT
                 " pictures has a pose within max-difference: the poses are %s; set poses-start to "
                 "the time of the first picture among these",
                 kManyUnposed, trajectory_->span().c_str());
  if (!color) return GST_FLOW_OK;
  return gst_aggregator_finish_buffer(aggregator, color);
}

void RgbdMerge::attach(GstBuffer* color, const RgbdMergeParams& params) {
  const double unit = calibration_ ? calibration_->unit.value_or(params.unit) : params.unit;
  const GstVideoInfo& info = held_format_->info;
  const std::optional<Registration>& registration = held_format_->registration;
  GstVideoFrame frame;
  if (!gst_video_frame_map(&frame, &info, held_, GST_MAP_READ))
    throw Error(ErrorKind::internal, "a depth image cannot be read");
  const auto* rows = static_cast<const uint8_t*>(GST_VIDEO_FRAME_PLANE_DATA(&frame, 0));
  const auto stride = static_cast<size_t>(GST_VIDEO_FRAME_PLANE_STRIDE(&frame, 0));
  const auto width = static_cast<uint32_t>(info.width), height = static_cast<uint32_t>(info.height);
  const size_t row = size_t{2} * width, bytes = row * height;
  GstBuffer* image = gst_buffer_new_allocate(nullptr, bytes, nullptr);
  if (!image) {
    gst_video_frame_unmap(&frame);
    throw Error(ErrorKind::out_of_memory, "no memory for a depth image");
  }
  if (registration) {
    registration->run(rows, stride, unit, registered_);
    gst_buffer_fill(image, 0, registered_.data(), bytes);
  } else {
    for (uint32_t y = 0; y < height; ++y) gst_buffer_fill(image, y * row, rows + y * stride, row);
  }
  gst_video_frame_unmap(&frame);
  const CalibratedCamera lens = registration
                                    ? registration->lens()
                                    : typical_camera({static_cast<uint32_t>(color_info_.width),
                                                      static_cast<uint32_t>(color_info_.height)})
                                          .with_lens(params.fx, params.fy, params.cx, params.cy)
                                          .for_size({width, height});
  const std::optional<PoseRows> pose = pose_of(color, params);
  while (GstInverseDepthMeta* other = gst_buffer_get_inverse_depth_meta(color))
    gst_buffer_remove_meta(color, &other->meta);
  GstInverseDepthMeta* meta = add_depth_meta(color, image, unit, lens);
  if (!pose) return;
  meta->posed = TRUE;
  std::ranges::copy(*pose, meta->pose);
  std::lock_guard lock(mutex_);
  ++posed_;
}

/// That of the file, else what the picture brings, else the depth image.
std::optional<PoseRows> RgbdMerge::pose_of(GstBuffer* color, const RgbdMergeParams& params) {
  if (trajectory_) {
    const GstClockTime time =
        gst_segment_to_stream_time(&color_->segment, GST_FORMAT_TIME, GST_BUFFER_PTS(color));
    if (!GST_CLOCK_TIME_IS_VALID(time)) return {};
    return trajectory_->at(params.poses_start + static_cast<double>(time) / GST_SECOND,
                           params.max_difference / 1000);
  }
  for (GstBuffer* buffer : {color, held_}) {
    const GstInverseDepthMeta* meta = gst_buffer_get_inverse_depth_meta(buffer);
    if (!meta || !meta->posed) continue;
    const std::span<const double, 12> brought(meta->pose);
    if (buffer == held_ && calibration_) return color_pose(*calibration_, brought);
    PoseRows rows{};
    std::ranges::copy(brought, rows.begin());
    return rows;
  }
  return {};
}

}  // namespace inverse
