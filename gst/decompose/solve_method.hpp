// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "interaction.hpp"
#include "solve_properties.hpp"

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
    method_.emplace(device, extent);
    interaction_.configure(device, extent, log);
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
    interaction_.release();
  }
  void reset() override {
    method_->reset();
    interaction_.reset();
  }
  bool converged(std::optional<uint64_t> completed) const override {
    return completed && method_->converged(*completed, settings_.params());
  }
  bool requested() const override { return interaction_.requested(settings_.params()); }
  Interaction* interaction() override { return &interaction_; }
  void navigate(const Log& log, const MouseEvent& event) override {
    interaction_.navigate(log, event, settings_.properties());
  }
  void flushed() override { interaction_.flushed(); }
  void ended() override { interaction_.ended(settings_.properties()); }
  void completed(uint64_t number) override {
    interaction_.completed(number, strokes_found(number), settings_.properties());
  }

 protected:
  /// Decomposes a frame with what the method needs to know of it besides strokes. Returns the
  /// method's number for it.
  uint64_t solve(FrameContext& frame, typename Method::FrameInfo info) {
    const Params& params = settings_.params();
    const uint64_t number = method_->recorded();
    const Interaction::Known known =
        interaction_.before(frame, number, params, frame.draw && params.show == Show::mosaic);
    info.reset = frame.fresh;
    info.repeated = frame.repeated;
    info.strokes = known.strokes;
    info.tracker = known.tracker;
    info.seen = known.seen;
    info.known = known.reflectance;
    frame.layers = method_->record(frame.commands, frame.layers[Role::input], params, info);
    interaction_.after(frame);
    return number;
  }
  void describe_interaction(GstStructure* stats, uint64_t number) const {
    interaction_.describe(stats, number, strokes_found(number));
  }

  MethodSettings<Params, typename Method::Params> settings_;
  std::optional<Method> method_;

 private:
  /// Of each stroke that a completed frame was solved with.
  std::vector<float> strokes_found(uint64_t number) const {
    const auto findings = method_->findings(number);
    if constexpr (requires { findings.solve; })
      return findings.solve.strokes;
    else
      return findings.strokes;
  }

  PriorModels models_;
  Interaction interaction_;
};

}  // namespace inverse
