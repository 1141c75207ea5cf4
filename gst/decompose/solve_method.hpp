// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "solve_properties.hpp"

namespace inverse {

/// What the elements that solve by ScaledIntrinsic share. `Method` is it or has one inside.
template <typename Method>
class SolveMethod : public DecompositionMethod {
 public:
  using Params = SolveParams<typename Method::Params>;
  SolveMethod(const PropertyTable<Params>& table,
              const QualityLevels<typename Method::Params>& levels)
      : settings_(table, levels) {}

  DecomposerSettings& settings() override { return settings_; }
  void configure(const std::shared_ptr<gpu::Device>& device, Extent extent, const Log&) override {
    method_.emplace(device, extent);
    extent_ = extent;
    drawn_ = {};
    const Params params = settings_.properties();
    method_->prepare(params.halvings());
    // Setting one up later would make the frame late that changes to it.
    if (params.target_fps > 0 || params.latency_budget > 0)
      for (const size_t halvings : {0, 1, 2}) method_->prepare(halvings);
  }
  void release() override { method_.reset(); }
  void reset() override { method_->reset(); }
  bool converged(std::optional<uint64_t> completed) const override {
    return completed && method_->converged(*completed, settings_.params());
  }
  bool requested() const override { return strokes_.changed(settings_.params().strokes); }
  StrokeEditor* strokes() override { return &strokes_; }
  void navigate(const Log& log, const MouseEvent& event) override {
    strokes_.mouse(log, event, settings_.properties());
  }
  void flushed() override { strokes_.flush(); }
  void completed(uint64_t number) override {
    if (const StrokesPtr& list = drawn_[number])
      strokes_.check(list, solve_findings(method_->findings(number)).strokes);
  }

 protected:
  /// The strokes for a frame; adds warnings about them to it.
  StrokesPtr take_strokes(FrameContext& frame) {
    const Params& params = settings_.params();
    const StrokesPtr list =
        strokes_.take(params.strokes, extent_, frame.draw && params.show == Show::mosaic);
    for (std::string& warning : strokes_.take_warnings())
      frame.warnings.push_back(std::move(warning));
    return drawn_[method_->recorded()] = list;
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

  Extent extent_{};
  StrokeEditor strokes_;
  gpu::FrameRing<StrokesPtr> drawn_;  // in frames of the method
};

}  // namespace inverse
