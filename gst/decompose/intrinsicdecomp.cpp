// SPDX-License-Identifier: LGPL-2.1-or-later
// intrinsicdecomp: reflectance and shading of live video, one log-shading unknown a pixel.
#include "decomposer.hpp"
#include "kernels/intrinsic/intrinsic_levels.hpp"
#include "solve_properties.hpp"

namespace inverse {
namespace {

using Params = SolveParams<ScaledIntrinsic::Params>;

const PropertyTable<Params>& table() {
  static const PropertyTable<Params> table =
      decomposer_properties<Params>({kSolveSets}, solve_properties<Params>());
  return table;
}

class IntrinsicMethod final : public DecompositionMethod {
 public:
  DecomposerSettings& settings() override { return settings_; }
  void configure(const std::shared_ptr<gpu::Device>& device, Extent extent, const Log&) override {
    method_.emplace(device, extent);
    prepare_solve(*method_, settings_.properties());
  }
  void release() override { method_.reset(); }
  void reset() override { method_->reset(); }
  uint64_t decompose(FrameContext& frame) override {
    frame.layers = method_->record(frame.commands, frame.layers[Role::input], settings_.params(),
                                   {frame.fresh, frame.changed, frame.repeated});
    frame.drawn = method_->drawn();
    return method_->recorded() - 1;
  }
  bool converged(std::optional<uint64_t> completed) const override {
    return completed && method_->converged(*completed, settings_.params());
  }
  bool typical(uint64_t number) const override { return inverse::typical(method_->stats(number)); }
  Work work(uint64_t number) const override {
    return solve_work(method_->stats(number), method_->findings(number));
  }
  void describe(GstStructure* stats, uint64_t number) const override {
    describe_solve(stats, method_->stats(number), method_->findings(number));
  }

 private:
  MethodSettings<Params, ScaledIntrinsic::Params> settings_{table(), intrinsic_levels()};
  std::optional<ScaledIntrinsic> method_;
};

}  // namespace

extern const ElementInfo kIntrinsicDecomp;
const ElementInfo kIntrinsicDecomp{
    "intrinsicdecomp",
    "GstIntrinsicDecomp",
    "Intrinsic decomposition",
    "Filter/Effect/Video",
    "Decomposes live video into reflectance (color without light) "
    "and shading (light without color)",
    Flow::pixels,
    Flow::pixels_or_layers,
    kIntrinsicLayers,
    nullptr,
    []() -> std::unique_ptr<Filter> {
      return std::make_unique<Decomposer>(std::make_unique<IntrinsicMethod>());
    }};

}  // namespace inverse
