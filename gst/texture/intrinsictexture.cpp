// SPDX-License-Identifier: LGPL-2.1-or-later
// intrinsictexture: hangs a picture on a plane of the scene; the light on it stays (thesis 3.7.3).
#include <gst/base/gstbasetransform.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <mutex>
#include <optional>
#include <utility>

#include "corners_text.hpp"
#include "gst/base/filter.hpp"
#include "gst/base/pictures/file_loader.hpp"
#include "gst/base/pictures/picture_file.hpp"
#include "kernels/texture/plane_luminance.hpp"
#include "kernels/texture/texture_edit.hpp"
#include "picture_source.hpp"
#include "plane_tracker.hpp"

namespace inverse {
namespace {

struct CornersSetting {
  std::optional<Corners> value;
  uint64_t version = 0;  ///< counts how often it was set
};

struct Params : TextureParams {
  std::string location, poster;
  CornersSetting corners;
  bool track = true, drag = true;
};

std::string text_of_corners(const CornersSetting& corners) {
  return corners.value ? text_of(*corners.value) : std::string();
}
void write_corners(CornersSetting& corners, const char* text) {
  corners.value = read_corners(text);
  ++corners.version;
}
std::string corners_fault(const GValue* value) {
  const char* text = g_value_get_string(value);
  try {
    read_corners(text ? text : "");
    return {};
  } catch (const Error& error) {
    return std::string("corners") + error.what();
  }
}

const PropertyTable<Params>& table() {
  using P = Params;
  static const PropertyTable<P> table{
      text<P>("location", &P::location,
              "Picture to hang: a PNG or JPEG file; empty = frames of the pad texture"),
      text_for<P, text_of_corners, write_corners>(
          "corners", &P::corners,
          "Where the picture hangs in the frame in which this is set: x,y of top left, top right, "
          "bottom right and bottom left in pixels; empty = found by poster",
          corners_fault),
      text<P>("poster", &P::poster,
              "Picture file of what hangs there now: the plane is found by it if corners is empty"),
      flag<P>("track", &P::track,
              "Follow the plane; turn off to save time if neither the camera nor the plane moves"),
      flag<P>("drag", &P::drag,
              "Move corners with the mouse; without corners, a drag draws a rectangle"),
      number<P>("white", &P::white, 0, 10,
                "Reflectance of white in the picture; lower it if the picture looks too bright"),
      number<P>("opacity", &P::opacity, 0, 1,
                "Share of the picture's color; 0 = layers pass through unchanged"),
      flag<P>("use-mask", &P::use_mask,
              "Multiply the picture's opacity by the mask layer if the frame has one"),
      flag<P>("occlusion", &P::occlusion, "Hide the picture behind what comes before the plane"),
      number<P>("tolerance", &P::tolerance, 0, 10,
                "Change of reflectance (rms of natural logarithms) up to which a spot still shows "
                "the plane; raise it if the picture has holes"),
      number<P>("softness", &P::softness, 0, 10,
                "Change beyond tolerance over which the picture disappears; 0 = a hard edge"),
  };
  return table;
}

const char* name_of(PlaneTracker::State state) {
  switch (state) {
    case PlaneTracker::State::found:
      return "found";
    case PlaneTracker::State::lost:
      return "lost";
    case PlaneTracker::State::fixed:
      return "fixed";
    case PlaneTracker::State::none:
      break;
  }
  return "none";
}

/// Corners in pixels that are `factor` times as small.
Corners scaled(Corners corners, double factor) {
  for (Point& p : corners)
    for (double& v : p) v *= factor;
  return corners;
}

class TextureElement final : public Filter {
  using State = PlaneTracker::State;

 public:
  PropertyStore& parameters() override { return parameters_; }

  void start() override {
    const Params params = parameters_.snapshot();
    picture_.start(params.location);
    source_.forget_frames();
    source_.set_file(picture_.file());
    poster_.start(params.poster);
    tracker_.forget();
    tracker_.set_poster(poster_view(poster_.file()));
    version_.reset();
    pending_.reset();
    place_.reset();
    placed_ = false;
    reported_stays_ = reported_nothing_ = false;
    waited_ = 0;
  }
  void configure(const std::shared_ptr<gpu::Device>& device, Extent extent) override {
    edit_.emplace(device, extent);
    luminance_.emplace(device, extent);
    probe_.emplace(device);
    source_.configure(device, extent);
    tracker_.cut();
    // Pixels are others. A plane that is followed is found in them.
    if (extent != extent_ && tracker_.result().state != State::lost) version_.reset();
    const std::lock_guard lock(mouse_mutex_);
    extent_ = extent;
  }
  void release() override {
    edit_.reset();
    luminance_.reset();
    probe_.reset();
    source_.drop();
  }
  void reset() override { tracker_.cut(); }

  SidePads* side_pads() override { return &source_; }

  void process(FrameContext& frame) override {
    const Params params = parameters_.snapshot();
    take_files(frame, params);
    Report& report = reports_[frame.number];
    report = {};
    take_corners(frame, params);
    const bool shows = source_.take(running_time(frame)) && params.opacity > 0;
    const bool known =
        pending_ || place_ || tracker_.searches() || tracker_.result().state == State::found;
    warn_of_nothing(frame, params);
    if (known && (shows || pending_) && (params.track || !place_)) follow(frame, report);
    report.state = tracker_.result().state;
    if (pending_ && !params.track) report.state = State::fixed;
    report.place = place_;
    {
      const std::lock_guard lock(mouse_mutex_);
      seen_ = place_;
      may_draw_ = source_.has_picture() && !tracker_.has_poster();
    }
    if (!shows || !place_) return;
    edit_->record(frame.commands, frame.layers, source_.pyramid(frame.commands, frame.number),
                  *place_, params);
    frame.commands.stage("texture");
    frame.decorate = [place = *place_](GstBuffer* out) { write_place(out, place); };
  }

  std::vector<Setting> navigate(const MouseEvent& event) override {
    using Kind = MouseEvent::Kind;
    if (!std::isfinite(event.x) || !std::isfinite(event.y)) return {};
    std::optional<Corners> moved;
    {
      const bool drags = parameters_.snapshot().drag;
      const std::lock_guard lock(mouse_mutex_);
      if (event.kind == Kind::press) held_ = drags ? taken_hold(event) : std::nullopt;
      if (!held_) return {};
      const Point to{std::clamp(event.x, -kFarthest, kFarthest),
                     std::clamp(event.y, -kFarthest, kFarthest)};
      moved = held_->start;
      if (held_->draws) {
        const auto [x0, x1] = std::minmax(moved->at(0)[0], to[0]);
        const auto [y0, y1] = std::minmax(moved->at(0)[1], to[1]);
        *moved = {{{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}};
      } else {
        (*moved)[held_->corner] = to;
      }
      if (event.kind == Kind::release) held_.reset();
      // On the way a corner may pass through the others.
      if (event.kind == Kind::press || !wrong_corners(*moved).empty()) return {};
    }
    g_object_set(log().object, "corners", text_of(*moved).c_str(), nullptr);
    return {};
  }

  void describe(GstStructure* stats, uint64_t number) const override {
    const Report& report = reports_[number];
    gst_structure_set(stats, "plane", G_TYPE_STRING, name_of(report.state), "corners",
                      G_TYPE_STRING, report.place ? text_of(*report.place).c_str() : "", "features",
                      G_TYPE_UINT, report.features, "inliers", G_TYPE_UINT, report.inliers,
                      "alignment-error", G_TYPE_DOUBLE, report.error, "tracking-ms", G_TYPE_DOUBLE,
                      report.tracking_ms, "device-wait-ms", G_TYPE_DOUBLE, report.wait_ms, nullptr);
  }

 private:
  /// A warning, once, if there is a place without a picture, or a picture whose poster is not
  /// found.
  void warn_of_nothing(FrameContext& frame, const Params& params) {
    constexpr unsigned kEnough = 100;  // frames
    const bool place = pending_ || place_, searches = !place && tracker_.has_poster();
    if (reported_nothing_ || !(params.opacity > 0) || !(place || searches)) return;
    std::string warning;
    if (!source_.has_picture() && !source_.has_pad()) {
      if (params.location.empty())
        warning = "there is no picture to hang; set location, or link a video to the pad texture";
    } else if (++waited_ < kEnough) {
      return;
    } else if (!source_.has_picture()) {
      warning = "no frame has come on the pad texture; link a video that plays, or set location";
    } else if (searches) {
      warning =
          "the picture of poster is not found in the video; show more of the poster, larger and "
          "from the front, or set corners";
    }
    reported_nothing_ = true;
    if (!warning.empty()) frame.warnings.push_back(warning);
  }

  struct Report {
    State state = State::none;
    std::optional<Corners> place;
    unsigned features = 0, inliers = 0;
    double error = 0, tracking_ms = 0, wait_ms = 0;
  };
  /// What the mouse has hold of: a corner of these, or one end of a rectangle's diagonal.
  struct Held {
    Corners start;
    size_t corner;
    bool draws;
  };

  /// Each frame says where the plane is: a region of the type "plane", with its corners.
  static void write_place(GstBuffer* out, const Corners& place) {
    const auto range = [&](size_t k) {
      const auto [low, high] = std::minmax({place[0][k], place[1][k], place[2][k], place[3][k]});
      const double first = std::max(low, 0.0);
      return std::pair(static_cast<guint>(first), static_cast<guint>(std::max(high - first, 0.0)));
    };
    const auto [x, width] = range(0);
    const auto [y, height] = range(1);
    GstVideoRegionOfInterestMeta* region =
        gst_buffer_add_video_region_of_interest_meta(out, "plane", x, y, width, height);
    gst_video_region_of_interest_meta_add_param(
        region,
        gst_structure_new("plane", "corners", G_TYPE_STRING, text_of(place).c_str(), nullptr));
  }

  static cv::Mat poster_view(const std::optional<Picture8>& poster) {
    if (!poster) return {};
    constexpr uint32_t kSide = 640;
    const LinearPicture linear = linear_picture(*poster, kSide);
    cv::Mat view(static_cast<int>(linear.extent.height), static_cast<int>(linear.extent.width),
                 CV_32F);
    for (int n = 0; n < view.rows * view.cols; ++n) {
      const float* p = &linear.rgba[4 * static_cast<size_t>(n)];
      view.at<float>(n / view.cols, n % view.cols) =
          std::pow(0.2126F * p[0] + 0.7152F * p[1] + 0.0722F * p[2], 1 / 2.2F);
    }
    return view;
  }

  /// Other files while playing, which other threads read. One that cannot be read is reported once,
  /// and the picture before stays.
  void take_files(FrameContext& frame, const Params& params) {
    if (picture_.take(params.location, frame.warnings)) source_.set_file(picture_.file());
    if (poster_.take(params.poster, frame.warnings)) {
      tracker_.set_poster(poster_view(poster_.file()));
      if (!params.corners.value) forget_plane();
    }
  }

  void forget_plane() {
    tracker_.forget();
    place_.reset();
    pending_.reset();
    edit_->forget();
  }

  /// Corners that were set since the last frame.
  void take_corners(FrameContext& frame, const Params& params) {
    if (version_ == params.corners.version) return;
    const bool first = !std::exchange(version_, params.corners.version);
    if (!params.corners.value) {
      if (!first) forget_plane();
      return;
    }
    const Corners& corners = *params.corners.value;
    std::string wrong = wrong_corners(corners);
    if (wrong.empty() && !touches_frame(corners)) wrong = "are outside of the picture";
    if (!wrong.empty()) {
      frame.warnings.push_back("corners=\"" + text_of(corners) + "\" " + wrong +
                               ", so no picture is hung there; give x,y of top left, top right, "
                               "bottom right and bottom left in pixels of the frame");
      return;
    }
    forget_plane();
    pending_ = place_ = corners;
    reported_stays_ = false;
  }

  bool touches_frame(const Corners& corners) const {
    const auto range = [&](size_t k) {
      return std::minmax({corners[0][k], corners[1][k], corners[2][k], corners[3][k]});
    };
    const auto [left, right] = range(0);
    const auto [top, bottom] = range(1);
    return right > 0 && bottom > 0 && left < extent_.width && top < extent_.height;
  }

  /// Finds the plane in this frame, for which it waits until the device has made it.
  void follow(FrameContext& frame, Report& report) {
    using Clock = std::chrono::steady_clock;
    const auto ms = [](Clock::time_point from, Clock::time_point to) {
      return std::chrono::duration<double, std::milli>(to - from).count();
    };
    const auto begin = Clock::now();
    probe_->begin();
    luminance_->record(*probe_, *frame.layers[Role::input]);
    probe_->submit();
    frame.wait(*probe_);
    const auto seen = Clock::now();
    const Extent size = luminance_->size();
    const cv::Mat view(static_cast<int>(size.height), static_cast<int>(size.width), CV_32F,
                       const_cast<float*>(luminance_->values().data()));
    const double factor = luminance_->factor();
    if (pending_) {
      tracker_.set(view, scaled(*pending_, 1 / factor));
      pending_.reset();
    } else {
      tracker_.next(view);
    }
    const PlaneTracker::Result& result = tracker_.result();
    const bool placed = result.state == State::found || result.state == State::fixed;
    place_ = placed ? std::optional(scaled(result.corners, factor)) : std::nullopt;
    if (result.state == State::fixed && !std::exchange(reported_stays_, true))
      frame.warnings.push_back(
          "the plane at corners=\"" + text_of(*place_) + "\" has " +
          std::to_string(result.features) +
          " features that could be followed, which are too few: the picture stays where it is in "
          "the frame; if the camera moves, choose a plane with texture, or set track=false");
    report.features = result.features;
    report.inliers = result.inliers;
    report.error = result.error * factor;
    report.wait_ms = ms(begin, seen);
    report.tracking_ms = ms(seen, Clock::now());
    if (placed != std::exchange(placed_, placed))
      frame.messages.emplace_back(
          gst_structure_new(placed ? "inverse-plane-found" : "inverse-plane-lost", "corners",
                            G_TYPE_STRING, placed ? text_of(*place_).c_str() : "", nullptr));
  }

  GstClockTime running_time(const FrameContext& frame) const {
    const GstSegment& segment = GST_BASE_TRANSFORM(log().object)->segment;
    if (segment.format != GST_FORMAT_TIME || !frame.in) return GST_CLOCK_TIME_NONE;
    return gst_segment_to_running_time(&segment, GST_FORMAT_TIME, GST_BUFFER_PTS(frame.in));
  }

  /// The corner that is near the mouse. mouse_mutex_ held.
  std::optional<Held> taken_hold(const MouseEvent& event) const {
    if (!seen_) {
      if (!may_draw_) return {};
      const Point at{event.x, event.y};
      return Held{{at, at, at, at}, 0, true};
    }
    const double reach = std::max(12.0, std::hypot(extent_.width, extent_.height) / 40);
    const auto away = [&](const Point& p) { return std::hypot(p[0] - event.x, p[1] - event.y); };
    const auto nearest =
        std::min_element(seen_->begin(), seen_->end(),
                         [&](const Point& a, const Point& b) { return away(a) < away(b); });
    if (away(*nearest) > reach) return {};
    return Held{*seen_, static_cast<size_t>(nearest - seen_->begin()), false};
  }

  Parameters<Params> parameters_{table()};
  std::optional<TextureEdit> edit_;
  std::optional<PlaneLuminance> luminance_;
  std::optional<gpu::Commands> probe_;  // reads frames that the device has not completed
  FileLoader picture_, poster_;
  PictureSource source_;
  PlaneTracker tracker_;
  std::optional<uint64_t> version_;  // of the corners that were taken
  std::optional<Corners> pending_;   // of which the tracker has not seen the frame
  std::optional<Corners> place_;     // in this frame
  bool placed_ = false, reported_stays_ = false, reported_nothing_ = false;
  unsigned waited_ = 0;  // frames for a picture or its poster
  gpu::FrameRing<Report> reports_;

  mutable std::mutex mouse_mutex_;
  Extent extent_;                // under it; read without by the thread that writes it
  std::optional<Corners> seen_;  // place_, for the mouse
  bool may_draw_ = false;
  std::optional<Held> held_;
};

}  // namespace

extern const ElementInfo kIntrinsicTexture;
const ElementInfo kIntrinsicTexture{
    .factory = "intrinsictexture",
    .type_name = "GstIntrinsicTexture",
    .long_name = "Intrinsic texture",
    .klass = "Filter/Video",
    .description = "Hangs a picture on a plane of the scene; the light on it stays",
    .sink = Flow::layers_or_pixels,
    .src = Flow::layers,
    .layers = kAnyLayers,
    .needs = "intrinsicdecomp",
    .create = [] { return std::unique_ptr<Filter>(new TextureElement); },
    .navigation = true,
    .side_sinks = {"texture"}};

}  // namespace inverse
