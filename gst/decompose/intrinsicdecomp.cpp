// SPDX-License-Identifier: LGPL-2.1-or-later
// intrinsicdecomp: reflectance and shading of live video, one log-shading unknown a pixel.

#include "decomposer.hpp"
#include "kernels/intrinsic/intrinsic_levels.hpp"
#include "solve_method.hpp"

namespace inverse {
namespace {

using Params = SolveParams<ScaledIntrinsic::Params>;

const PropertyTable<Params>& table() {
  static const PropertyTable<Params> table = [] {
    PropertyTable<Params> all = solve_properties<Params>();
    all.append(interaction_properties<Params>());
    return decomposer_properties<Params>({kSolveSets}, all);
  }();
  return table;
}

class IntrinsicMethod final : public SolveMethod<ScaledIntrinsic> {
 public:
  IntrinsicMethod() : SolveMethod(table(), intrinsic_levels()) {}
  uint64_t decompose(FrameContext& frame) override { return SolveMethod::solve(frame, {}); }
  bool typical(uint64_t number) const override { return inverse::typical(method_->stats(number)); }
  Work work(uint64_t number) const override {
    return solve_work(method_->stats(number), method_->findings(number));
  }
  void describe(GstStructure* stats, uint64_t number) const override {
    describe_solve(stats, method_->stats(number), method_->findings(number));
    describe_interaction(stats, number);
  }
};

}  // namespace

extern const ElementInfo kIntrinsicDecomp;
const ElementInfo kIntrinsicDecomp{
    .factory = "intrinsicdecomp",
    .type_name = "GstIntrinsicDecomp",
    .long_name = "Intrinsic decomposition",
    .klass = "Filter/Effect/Video",
    .description =
        "Decomposes live video into reflectance (color without light) "
        "and shading (light without color)",
    .sink = Flow::pixels,
    .src = Flow::pixels_or_layers,
    .layers = kIntrinsicLayers,
    .create = []() -> std::unique_ptr<Filter> {
      return std::make_unique<Decomposer>(std::make_unique<IntrinsicMethod>());
    },
    .actions = interaction_actions(),
    .navigation = true,
};

}  // namespace inverse
