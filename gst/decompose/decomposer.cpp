#include "decomposer.hpp"

#include <chrono>

namespace inverse {

namespace {

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
  trade_.forget();
}

void Decomposer::release() {
  mosaic_.reset();
  palette_.reset();
  planes_.reset();
  held_.reset();
  same_.reset();
  device_.reset();
}

void Decomposer::reset() {
  if (palette_) palette_->reset();
  held_.reset();
  same_.reset();
}

PlanePtr Decomposer::draw_clusters(FrameWork& frame) {
  const Plane& model = *frame.layers[Role::model];
  if (!palette_) palette_.emplace(device_, model.extent);
  palette_->record_update(frame.commands, model);
  PlanePtr painted = planes_->acquire();
  palette_->record_paint(frame.commands, model, *painted);
  return painted;
}

bool Decomposer::keeps(const FrameWork& frame, const Settings& settings) {
  if (!frame.repeated || settings.changed || !same_) same_ = frame.number;
  if (!settings.adaptive || !held_ || *same_ == frame.number) return false;
  // The last frame that is sure to be done: what is kept must not depend on how fast frames are.
  std::optional<uint64_t> done;
  if (frame.number >= past_.size() && frame.number - past_.size() >= *same_)
    done = past(frame.number).method;
  return settled(done);
}

void Decomposer::process(FrameWork& frame) {
  const Settings settings = next_settings(trade_);
  const bool kept = keeps(frame, settings);
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
  past_[frame.number % past_.size()] = {last_method_, kept, trade_.level(), kept_};
  if (!frame.draw) return;
  draw(frame, settings.show);
  // Clusters follow the last frames, also those that are alike.
  const bool steady = settings.show != Show::clusters && settings.show != Show::mosaic;
  frame.same_picture = kept && steady && drawn_ == settings.show;
  if (!steady || drawn_ != settings.show) frame.drawn = nullptr;
  drawn_ = settings.show;
}

void Decomposer::took(uint64_t number, double milliseconds) {
  // What costs nothing says nothing of what other frames will cost.
  if (!past(number).kept) trade_.frame(seconds_now(), milliseconds, past(number).level);
}

void Decomposer::late(double milliseconds) { trade_.late(seconds_now(), milliseconds); }

void Decomposer::describe(GstStructure* stats, uint64_t number) const {
  const Past& frame = past(number);
  gst_structure_set(stats, "skipped", G_TYPE_STRING, "", nullptr);
  describe_method(stats, frame.method);
  gst_structure_set(stats, "kept", G_TYPE_BOOLEAN, frame.kept, "frames-kept", G_TYPE_UINT64,
                    frame.kept_so_far, nullptr);
  if (frame.kept)
    gst_structure_set(stats, "skipped", G_TYPE_STRING, "method: the picture of the frame before",
                      nullptr);
  const LiveTrade::Report& trade = trade_.report();
  if (trade.budget_ms > 0)
    gst_structure_set(stats, "live-level", G_TYPE_UINT, static_cast<guint>(frame.level),
                      "live-budget-ms", G_TYPE_DOUBLE, trade.budget_ms, "live-predicted-ms",
                      G_TYPE_DOUBLE, trade.predicted_ms, "live-moves", G_TYPE_UINT64, trade.moves,
                      "live-reason", G_TYPE_STRING, trade.reason.c_str(), nullptr);
}

void Decomposer::draw(FrameWork& frame, Show show) {
  const PlanePtr& intrinsic = frame.layers[Role::intrinsic];
  const PlanePtr& input = frame.layers[Role::input];
  switch (show) {
    case Show::reflectance:
      frame.picture = {intrinsic};
      break;
    case Show::shading:
      frame.picture = {intrinsic, true};
      break;
    case Show::input:
      frame.picture = {input};
      break;
    case Show::clusters:
      frame.picture = {draw_clusters(frame)};
      break;
    case Show::mosaic: {
      if (!mosaic_) mosaic_.emplace(device_);
      frame.picture = {planes_->acquire()};
      using Source = Drawing::Source;
      const PlanePtr clusters = draw_clusters(frame);
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

std::vector<Choice> Decomposer::show_choices() {
  const auto choice = [](Show show, const char* nick, const char* description) {
    return Choice{static_cast<int>(show), nick, description};
  };
  return {choice(Show::reflectance, "reflectance", "Reflectance: color without light and shadow"),
          choice(Show::shading, "shading", "Shading: light and shadow without color, as gray"),
          choice(Show::input, "input", "The frame as it came in"),
          choice(Show::mosaic, "mosaic",
                 "Input, reflectance, shading and clusters at half size, side by side"),
          choice(Show::clusters, "clusters", "Each pixel in the color of its reflectance cluster")};
}

std::vector<Choice> Decomposer::quality_choices() {
  return {
      {static_cast<int>(Quality::low), "low", "The least work without visible loss on most video"},
      {static_cast<int>(Quality::medium), "medium",
       "Live video: sharp shadows, small objects and steady colors as well"},
      {static_cast<int>(Quality::high), "high", "More iterations, for files"},
      {static_cast<int>(Quality::best), "best", "Many iterations, for reference"}};
}

}  // namespace inverse
