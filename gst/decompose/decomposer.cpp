// SPDX-License-Identifier: LGPL-2.1-or-later
#include "decomposer.hpp"

#include <chrono>
#include <utility>

namespace inverse {
namespace {

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::string joined(const std::vector<std::string>& reasons) {
  std::string text;
  for (const auto& reason : reasons) text += (text.empty() ? "" : "; ") + reason;
  return text;
}

}  // namespace

Decomposer::Decomposer(std::unique_ptr<DecompositionMethod> method)
    : method_(std::move(method)),
      rate_controller_(method_->settings().level_costs()),
      logged_level_(rate_controller_.level()) {}

void Decomposer::configure(const std::shared_ptr<gpu::Device>& device, Extent extent) {
  view_.configure(device, extent);
  past_ = {};
  reused_ = 0;
  rate_controller_.forget();
  method_->configure(device, extent, log());
}

void Decomposer::release() {
  method_->release();
  view_.release();
  kept_.reset();
  repeats_.reset();
}

void Decomposer::reset() {
  view_.reset();
  kept_.reset();
  repeats_.reset();
  method_->reset();
}

RepeatPlanner::Decision Decomposer::decide(const FrameContext& frame,
                                           const FrameSettings& settings) {
  const auto completed = repeats_.completed(frame.number);
  // Layers of base colors are only made if they are shown or sent.
  const bool lacks_layer =
      frame.draw && settings.view.show == Show::layer && !(drawn_ && drawn_->show == Show::layer);
  return repeats_.next(
      {.number = frame.number,
       .adaptive = settings.adaptive,
       .repeated = frame.repeated,
       .params_changed = settings.changed || method_->requested(),
       .layers_available = kept_ && !lacks_layer,
       .converged = frame.repeated &&
                    method_->converged(completed ? std::optional(past_[*completed].method_frame)
                                                 : std::nullopt)});
}

void Decomposer::process(FrameContext& frame) {
  const FrameSettings settings = method_->settings().next(rate_controller_);
  const auto [reused, reason] = decide(frame, settings);
  if (const size_t level = rate_controller_.level(); level != std::exchange(logged_level_, level))
    GST_CAT_INFO_OBJECT(log().category, log().object, "quality level changed to %zu: %s", level,
                        rate_controller_.report().reason.empty()
                            ? "quality or target was set"
                            : rate_controller_.report().reason.c_str());
  if (reused) {
    frame.layers = *kept_;
    ++reused_;
    GST_CAT_DEBUG_OBJECT(log().category, log().object,
                         "frame %" G_GUINT64_FORMAT " skipped, layers reused: %s", frame.number,
                         reason);
  } else {
    kept_.reset();
    method_frame_ = method_->decompose(frame);
  }
  if (frame.keep_planes)
    kept_ = frame.layers;
  else
    kept_.reset();
  past_[frame.number] = {method_frame_, reused, reason, rate_controller_.level(), reused_};
  if (frame.draw) draw(frame, settings, reused);
}

void Decomposer::draw(FrameContext& frame, const FrameSettings& settings, bool reused) {
  view_.draw(frame, settings.view, [&](FrameContext& context, const Plane& target) {
    if (!method_->draw_clusters(context, target)) view_.draw_palette(context, target);
  });
  // Clusters follow the last frames, also if those are alike.
  const bool steady = settings.view.show != Show::clusters && settings.view.show != Show::mosaic;
  frame.same_picture = reused && steady && drawn_ == settings.view;
  drawn_ = settings.view;
}

void Decomposer::completed(uint64_t number, double milliseconds) {
  const Past& frame = past_[number];
  if (frame.reused) return;  // its time does not predict that of others
  method_->completed(frame.method_frame);
  if (method_->typical(frame.method_frame))
    rate_controller_.frame(seconds_now(), milliseconds, frame.level);
}

void Decomposer::late(double milliseconds) { rate_controller_.late(seconds_now(), milliseconds); }

std::vector<Filter::Setting> Decomposer::navigate(const MouseEvent& event) {
  method_->navigate(log(), event);
  return {};
}

void Decomposer::describe(GstStructure* stats, uint64_t number) const {
  const Past& frame = past_[number];
  method_->describe(stats, frame.method_frame);
  const DecompositionMethod::Work work =
      frame.reused ? DecompositionMethod::Work{.skipped = {std::string("method: ") + frame.reason}}
                   : method_->work(frame.method_frame);
  if (!frame.reused)
    GST_CAT_DEBUG_OBJECT(log().category, log().object,
                         "frame %" G_GUINT64_FORMAT " decomposed: %s. Skipped: %s. Run: %s.",
                         number, frame.reason, joined(work.skipped).c_str(),
                         joined(work.run).c_str());
  gst_structure_set(stats, "skipped", G_TYPE_STRING, joined(work.skipped).c_str(), "run",
                    G_TYPE_STRING, joined(work.run).c_str(), nullptr);
  gst_structure_set(stats, "reused", G_TYPE_BOOLEAN, frame.reused, "frames-reused", G_TYPE_UINT64,
                    frame.reused_so_far, nullptr);
  // The method's number is that of the picture before.
  if (frame.reused && gst_structure_has_field(stats, "cut"))
    gst_structure_set(stats, "cut", G_TYPE_BOOLEAN, FALSE, nullptr);
  gboolean cut = FALSE;
  if (gst_structure_get_boolean(stats, "cut", &cut) && cut)
    GST_CAT_INFO_OBJECT(log().category, log().object, "scene cut at frame %" G_GUINT64_FORMAT,
                        number);
  const RateController::Report& report = rate_controller_.report();
  if (report.budget_ms > 0)
    gst_structure_set(stats, "quality-level", G_TYPE_UINT, static_cast<guint>(frame.level),
                      "frame-budget-ms", G_TYPE_DOUBLE, report.budget_ms, "frame-predicted-ms",
                      G_TYPE_DOUBLE, report.predicted_ms, "level-changes", G_TYPE_UINT64,
                      report.moves, "level-reason", G_TYPE_STRING, report.reason.c_str(), nullptr);
}

}  // namespace inverse
