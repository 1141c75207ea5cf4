// SPDX-License-Identifier: LGPL-2.1-or-later
#include "decomposer.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

namespace inverse {

namespace {

constexpr uint64_t kMaxRepeats = 4;  // times that each picture of a video may be shown

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

void Decomposer::configure(const std::shared_ptr<gpu::Device>& device, Extent extent) {
  device_ = device;
  mosaic_.reset();
  palette_.reset();
  planes_.emplace(device, extent);
  past_ = {};
  kept_ = 0;
  rate_controller_.forget();
}

void Decomposer::release() {
  mosaic_.reset();
  palette_.reset();
  light_ = {};
  planes_.reset();
  held_.reset();
  same_.reset();
  device_.reset();
}

void Decomposer::reset() {
  if (palette_) palette_->reset();
  held_.reset();
  same_.reset();
  shown_ = shown_before_ = 0;
}

void Decomposer::draw_clusters(FrameContext& frame, const Plane& target) {
  const Plane& model = *frame.layers[Role::model];
  if (!palette_) palette_.emplace(device_, model.extent);
  palette_->record_update(frame.commands, model);
  palette_->record_paint(frame.commands, model, target);
}

Decomposer::Decision Decomposer::decide(const FrameContext& frame, const Settings& settings) {
  if (!frame.repeated || settings.changed || !same_) {
    same_ = frame.number;
    shown_before_ = std::exchange(shown_, 0);
  }
  ++shown_;
  if (!settings.adaptive) return {false, "adaptive is off"};
  if (frame.changed.empty()) return {false, "it is compared with no frame before"};
  if (!frame.repeated) return {false, "the picture changed"};
  if (settings.changed) return {false, "parameters changed"};
  if (!held_) return {false, "the layers of the frame before are not held"};
  if (*same_ == frame.number) return {false, "it is the first frame of its picture"};
  // Film on a faster screen shows every picture two or three times: once is enough.
  if (shown_ <= std::min(shown_before_, kMaxRepeats))
    return {true, "the video shows each picture several times"};
  // The last frame that is sure to be done: what is kept must not depend on how fast frames are.
  std::optional<uint64_t> done;
  if (frame.number >= past_.size() && frame.number - past_.size() >= *same_)
    done = past(frame.number).method;
  if (!settled(done))
    return {false, done ? "the picture came again, but its layers have not converged"
                        : "no frame of this picture is completed yet"};
  return {true, "the picture came again, and its layers have converged"};
}

void Decomposer::process(FrameContext& frame) {
  const Settings settings = next_settings(rate_controller_);
  const auto [kept, reason] = decide(frame, settings);
  GST_CAT_DEBUG_OBJECT(log().category, log().object, "frame %" G_GUINT64_FORMAT " %s: %s",
                       frame.number, kept ? "skipped, layers reused" : "decomposed", reason);
  if (const size_t level = rate_controller_.level(); level != std::exchange(logged_level_, level))
    GST_CAT_INFO_OBJECT(log().category, log().object, "quality level changed to %zu: %s", level,
                        rate_controller_.report().reason.empty()
                            ? "quality or target was set"
                            : rate_controller_.report().reason.c_str());
  if (kept) {
    frame.layers = *held_;
    ++kept_;
  } else {
    held_.reset();
    last_method_ = decompose(frame);
  }
  if (frame.hold)
    held_ = frame.layers;
  else
    held_.reset();
  past_[frame.number] = {last_method_, kept, rate_controller_.level(), kept_};
  if (!frame.draw) return;
  draw(frame, settings);
  // Clusters follow the last frames, also those that are alike.
  const bool steady = settings.show != Show::clusters && settings.show != Show::mosaic;
  const std::pair drawn{settings.show, settings.layer};
  frame.same_picture = kept && steady && drawn_ == drawn;
  if (!steady || drawn_ != drawn) frame.drawn = nullptr;
  drawn_ = drawn;
}

void Decomposer::took(uint64_t number, double milliseconds) {
  if (!past(number).kept) done(past(number).method);
  // What costs nothing does not predict what other frames cost.
  if (!past(number).kept && typical(past(number).method))
    rate_controller_.frame(seconds_now(), milliseconds, past(number).level);
}

void Decomposer::late(double milliseconds) { rate_controller_.late(seconds_now(), milliseconds); }

void Decomposer::describe(GstStructure* stats, uint64_t number) const {
  const Past& frame = past(number);
  gst_structure_set(stats, "skipped", G_TYPE_STRING, "", nullptr);
  describe_method(stats, frame.method);
  gst_structure_set(stats, "kept", G_TYPE_BOOLEAN, frame.kept, "frames-kept", G_TYPE_UINT64,
                    frame.kept_so_far, nullptr);
  // What its method's number tells of is the picture before.
  if (frame.kept && gst_structure_has_field(stats, "cut"))
    gst_structure_set(stats, "cut", G_TYPE_BOOLEAN, FALSE, nullptr);
  if (frame.kept)
    gst_structure_set(stats, "skipped", G_TYPE_STRING, "method: the picture of the frame before",
                      nullptr);
  gboolean cut = FALSE;
  if (gst_structure_get_boolean(stats, "cut", &cut) && cut)
    GST_CAT_INFO_OBJECT(log().category, log().object, "scene cut at frame %" G_GUINT64_FORMAT,
                        number);
  const RateController::Report& report = rate_controller_.report();
  if (report.budget_ms > 0)
    gst_structure_set(stats, "live-level", G_TYPE_UINT, static_cast<guint>(frame.level),
                      "live-budget-ms", G_TYPE_DOUBLE, report.budget_ms, "live-predicted-ms",
                      G_TYPE_DOUBLE, report.predicted_ms, "live-moves", G_TYPE_UINT64, report.moves,
                      "live-reason", G_TYPE_STRING, report.reason.c_str(), nullptr);
}

void Decomposer::draw(FrameContext& frame, const Settings& settings) {
  const PlanePtr& intrinsic = frame.layers[Role::intrinsic];
  const PlanePtr& input = frame.layers[Role::input];
  const auto light = [&](LightPicture::What what) {
    return light_.draw(frame.commands, frame.layers, what, "a decomposer",
                       static_cast<uint32_t>(settings.layer));
  };
  switch (settings.show) {
    case Show::reflectance:
      frame.picture = {intrinsic};
      break;
    case Show::shading:
      frame.picture = light_.shading(frame.commands, frame.layers);
      break;
    case Show::direct:
      frame.picture = light(LightPicture::What::direct);
      break;
    case Show::indirect:
      frame.picture = light(LightPicture::What::indirect);
      break;
    case Show::layer:
      frame.picture = light(LightPicture::What::layer);
      break;
    case Show::input:
      frame.picture = {input};
      break;
    case Show::clusters:
      frame.picture = {planes_->acquire()};
      draw_clusters(frame, *frame.picture.plane);
      break;
    case Show::mosaic: {
      if (!mosaic_) mosaic_.emplace(device_);
      frame.picture = {planes_->acquire()};
      using Source = Drawing::Source;
      if (frame.layers.global()) {
        const PlanePtr direct = light(LightPicture::What::direct).plane;
        const PlanePtr indirect = light(LightPicture::What::indirect).plane;
        mosaic_->record(frame.commands,
                        {{{input.get()}, {intrinsic.get()}, {direct.get()}, {indirect.get()}}},
                        *frame.picture.plane);
        break;
      }
      const PlanePtr clusters = planes_->acquire();
      draw_clusters(frame, *clusters);
      mosaic_->record(frame.commands,
                      {{{input.get()},
                        {intrinsic.get()},
                        {intrinsic.get(), Source::shading},
                        {clusters.get()}}},
                      *frame.picture.plane);
      break;
    }
  }
}

std::vector<Choice> Decomposer::show_choices(Makes makes) {
  const auto choice = [](Show show, const char* nick, const char* description) {
    return Choice{static_cast<int>(show), nick, description};
  };
  const bool global = makes == Makes::global;
  std::vector<Choice> choices{
      choice(Show::reflectance, "reflectance", "Reflectance: color without light and shadow"),
      choice(Show::shading, "shading",
             global ? "Shading: all light, direct and indirect, in color"
                    : "Shading: light and shadow without color, as gray"),
      choice(Show::input, "input", "The frame as it came in"),
      choice(Show::mosaic, "mosaic",
             global ? "Input, reflectance, direct and indirect light at half size, side by side"
                    : "Input, reflectance, shading and clusters at half size, side by side"),
      choice(Show::clusters, "clusters",
             global ? "Each pixel in the color of its reflectance cluster; of globalintrinsic in "
                      "the base color that it counts as"
                    : "Each pixel in the color of its reflectance cluster")};
  if (global) {
    choices.push_back(choice(Show::direct, "direct", "Light that comes straight from the lamps"));
    choices.push_back(
        choice(Show::indirect, "indirect", "Light that bounced off surfaces, in color"));
    choices.push_back(choice(Show::layer, "layer",
                             "Light that bounced off surfaces of one base color, see layer"));
  }
  return choices;
}

std::vector<Choice> Decomposer::quality_choices(const QualityText& text) {
  return {{static_cast<int>(Quality::low), "low", text.values[0]},
          {static_cast<int>(Quality::medium), "medium", text.values[1]},
          {static_cast<int>(Quality::high), "high", text.values[2]},
          {static_cast<int>(Quality::best), "best", text.values[3]}};
}

}  // namespace inverse
