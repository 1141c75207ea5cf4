// SPDX-License-Identifier: LGPL-2.1-or-later
// intrinsicdecomp: reflectance and shading of live video, one log-shading unknown a pixel.
#include "kernels/intrinsic/quality_levels.hpp"
#include "solve_properties.hpp"

namespace inverse {
namespace {

using Params = SolveElementParams<ScaledIntrinsic::Params>;

class IntrinsicElement final : public SolvingDecomposer<ScaledIntrinsic, Params> {
 public:
  IntrinsicElement() : SolvingDecomposer(table(), intrinsic_levels()) {}

 protected:
  bool settled(std::optional<uint64_t> done) const override {
    return done && !method_->fading() && method_->findings(*done).change < params().keep_tolerance;
  }

  void describe_method(GstStructure* stats, uint64_t number) const override {
    describe_solve(stats, method_->stats(number), method_->findings(number));
  }
  const ScaledIntrinsic::Stats& solve_stats(uint64_t number) const override {
    return method_->stats(number);
  }

  uint64_t decompose(FrameContext& frame) override {
    Params params = in_force(frame);
    // One that rests settles everywhere: a tile that was left out may lack what time would have
    // given.
    if (frame.repeated && repeated_) params.tile_tolerance = 0;
    repeated_ = frame.repeated;
    frame.layers = method_->record(frame.commands, frame.layers[Role::input], params,
                                   {frame.fresh, frame.changed});
    frame.drawn = method_->drawn();
    return method_->recorded() - 1;
  }

 private:
  bool repeated_ = false;  // the last frame that was decomposed

  static const PropertyTable<Params>& table() {
    static const PropertyTable<Params> table = [] {
      PropertyTable<Params> all = solve_properties<Params>();
      all.push_back(tile_tolerance_property<Params>());
      return properties<Params>({kSolveSets}, all);
    }();
    return table;
  }
};

}  // namespace

extern const ElementInfo kIntrinsicDecomp;
const ElementInfo kIntrinsicDecomp{"intrinsicdecomp",
                                   "GstIntrinsicDecomp",
                                   "Intrinsic decomposition",
                                   "Filter/Effect/Video",
                                   "Decomposes live video into reflectance (color without light) "
                                   "and shading (light without color)",
                                   Flow::pixels,
                                   Flow::pixels_or_layers,
                                   kIntrinsicLayers,
                                   nullptr,
                                   [] { return std::unique_ptr<Filter>(new IntrinsicElement); }};

}  // namespace inverse
