// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <memory>
#include <optional>

#include "scene_work.hpp"
#include "solve_properties.hpp"
#include "strokes/stroke_work.hpp"

namespace inverse {

/// What the elements that solve by ScaledIntrinsic share. `Method` is it or has one inside.
template <typename Method>
class SolveMethod : public DecompositionMethod {
 public:
  using Params = SolveParams<typename Method::Params>;
  SolveMethod(const PropertyTable<Params>& table,
              const QualityLevels<typename Method::Params>& levels)
      : settings_(table, levels, [this](Params& params) {
          params.prior.network = models_.take(params.prior_source);
        }) {}

  DecomposerSettings& settings() override { return settings_; }
  void configure(const std::shared_ptr<gpu::Device>& device, Extent extent,
                 const Log& log) override {
    log_.emplace(log);
    method_.emplace(device, extent);
    stroke_work_.configure(device, extent);
    scene_work_->configure(device);
    const Params params = settings_.properties();
    models_.start(log);
    const PriorModelPtr network = models_.take(params.prior_source);
    method_->prepare(params.halvings(), network);
    // Setting one up later would make the frame late that changes to it.
    if (params.target_fps > 0 || params.latency_budget > 0)
      for (const size_t halvings : {0, 1, 2}) method_->prepare(halvings, network);
  }
  void release() override {
    method_.reset();
    stroke_work_.release();
    scene_work_->release();
  }
  void reset() override {
    method_->reset();
    stroke_work_.reset();
  }
  bool converged(std::optional<uint64_t> completed) const override {
    return completed && method_->converged(*completed, settings_.params());
  }
  bool requested() const override {
    return stroke_work_.requested(settings_.params()) || scene_work_->requested();
  }
  StrokeEditor* strokes() override { return &strokes_; }
  void navigate(const Log& log, const MouseEvent& event) override {
    strokes_.mouse(log, event, settings_.properties());
  }
  void flushed() override { strokes_.flush(); }
  void ended() override { scene_work_->ended(settings_.properties().scene_location); }
  SceneWork* scene() override { return scene_work_.get(); }
  void completed(uint64_t number) override {
    const auto view = scene_work_->view(number);
    strokes_.add_loaded(*log_, scene_work_->take_loaded());
    stroke_work_.completed(*log_, number, solve_findings(method_->findings(number)).strokes, view);
    strokes_.touch(*log_, scene_work_->touch(number), view, settings_.properties());
  }

 protected:
  /// Decomposes a frame with what the method needs to know of it besides strokes. Returns the
  /// method's number for it.
  uint64_t solve(FrameContext& frame, typename Method::FrameInfo info) {
    const Params& params = settings_.params();
    const uint64_t number = method_->recorded();
    stroke_work_.take(frame, number, params, frame.draw && params.show == Show::mosaic);
    info.reset = frame.fresh;
    info.changed = frame.changed;
    info.repeated = frame.repeated;
    info.strokes = stroke_work_.solved();
    info.tracker = stroke_work_.tracker();
    info.known = scene_work_->recall(frame, number, params, stroke_work_.wanted());
    if (scene_work_->began()) strokes_.forget_scene();
    info.seen = scene_work_->seen();
    stroke_work_.see(number, info.seen);
    frame.layers = method_->record(frame.commands, frame.layers[Role::input], params, info);
    scene_work_->remember(frame);
    frame.drawn = method_->drawn();
    stroke_work_.edit(frame);
    return number;
  }
  void describe_scene(GstStructure* stats, uint64_t number) const {
    scene_work_->describe(stats, number);
  }
  void describe_strokes(GstStructure* stats, uint64_t number) const {
    stroke_work_.describe(stats, number, solve_findings(method_->findings(number)).strokes);
  }

  MethodSettings<Params, typename Method::Params> settings_;
  std::optional<Method> method_;

 private:
  static const auto& solve_findings(const auto& findings) {
    if constexpr (requires { findings.solve; })
      return findings.solve;
    else
      return findings;
  }

  std::optional<Log> log_;
  PriorModels models_;
  StrokeEditor strokes_;
  StrokeWork stroke_work_{strokes_};
  std::unique_ptr<SceneWork> scene_work_ = make_scene_work();
};

}  // namespace inverse
