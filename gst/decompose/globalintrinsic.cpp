// SPDX-License-Identifier: LGPL-2.1-or-later
// globalintrinsic: reflectance, direct light and light that bounced off surfaces, of live video.
#include <algorithm>
#include <iterator>

#include "decomposer.hpp"
#include "gst/base/color.hpp"
#include "kernels/global/global_levels.hpp"
#include "solve_method.hpp"

namespace inverse {
namespace {

using Params = SolveParams<GlobalIntrinsic::Params>;

PropertyTable<Params> light_properties() {
  using P = Params;
  return {
      number<P>("amount", &P::amount, 0.f, 2.f,
                "Indirect light relative to the light that surfaces in view reflect; raise it if a "
                "cast remains, 0 = estimated"),
      tuning(number<P>("typical-amount", &P::typical_amount, 0.05f, 2.f,
                       "Amount assumed for a scene whose colors do not determine it")),
      tuning(number<P>("measurement-weight", &P::measurement_weight, 0.f, 100.f,
                       "Weight of the scene's colors against typical-amount; 0 = not used, "
                       "indirect light is gray")),
      tuning(number<P>(
          "white-balance", &P::white_balance, 0.f, 1.f,
          "Share of the estimated lamp color to remove from reflectance; 0 = lamps are white")),
      tuning(number<P>("base-colors", &P::base_colors, 1, static_cast<int>(kMaxBases),
                       "Maximum number of base colors, each with a layer of indirect light")),
      tuning(number<P>("reach", &P::reach, 0.02f, 2.f,
                       "Standard deviation of the distance over which surfaces light each other, "
                       "in frame widths")),
      tuning(number<P>("near-share", &P::near_share, 0.f, 1.f,
                       "Share of near indirect light; the rest comes from the whole frame")),
      tuning(number<P>("update-rate", &P::update_rate, 0.01f, 1.f,
                       "Share of the newest frame in the estimates of amount and base colors; 1 "
                       "= no averaging")),
      tuning(number<P>("cut-chroma", &P::cut_chroma, 0.f, 1.f,
                       "Mean change of log chroma, divided by 0.5 (0…1), at which a cut is "
                       "detected")),
  };
}

const PropertyTable<Params>& table() {
  static const PropertyTable<Params> table = [] {
    PropertyTable<Params> all = light_properties();
    all.append(solve_properties<Params>());
    all.append(interaction_properties<Params>());
    return decomposer_properties<Params>({kSolveSets}, all, Makes::global);
  }();
  return table;
}

class GlobalMethod final : public SolveMethod<GlobalIntrinsic> {
 public:
  GlobalMethod() : SolveMethod(table(), global_levels()) {}

  uint64_t decompose(FrameContext& frame) override {
    return SolveMethod::solve(frame,
                              {.shares = !frame.draw || settings_.params().show == Show::layer});
  }

  bool typical(uint64_t number) const override {
    const GlobalIntrinsic::Stats& stats = method_->stats(number);
    return inverse::typical(stats.solve) && !stats.light.reused();
  }

  bool draw_clusters(FrameContext& frame, const Plane& target) override {
    method_->draw_labels(frame.commands, *frame.layers[Role::input], target);
    return true;
  }

  Work work(uint64_t number) const override {
    const GlobalIntrinsic::Stats& stats = method_->stats(number);
    Work work = solve_work(stats.solve, method_->findings(number).solve);
    std::ranges::copy(stats.light.skipped, std::back_inserter(work.skipped));
    std::ranges::copy(stats.light.run, std::back_inserter(work.run));
    return work;
  }

  void describe(GstStructure* stats, uint64_t number) const override {
    const auto found = method_->findings(number);
    const GlobalIntrinsic::Stats& method = method_->stats(number);
    describe_solve(stats, method.solve, found.solve);
    describe_interaction(stats, number);
    gst_structure_set(stats, "amount", G_TYPE_DOUBLE, static_cast<double>(found.amount),
                      "confidence", G_TYPE_DOUBLE, static_cast<double>(found.confidence), "colors",
                      G_TYPE_UINT, found.colors, "tint", G_TYPE_DOUBLE,
                      static_cast<double>(found.tint), "chroma", G_TYPE_DOUBLE,
                      static_cast<double>(found.chroma), "cut", G_TYPE_BOOLEAN, found.cut, nullptr);
    std::vector<guint> bases;
    for (const auto& base : found.bases)
      bases.push_back(base[0] + base[1] + base[2] > 0 ? srgb_color(base) : 0);
    set_color_list(stats, "base-colors", bases);
  }
};

}  // namespace

extern const ElementInfo kGlobalIntrinsic;
const ElementInfo kGlobalIntrinsic{
    .factory = "globalintrinsic",
    .type_name = "GstGlobalIntrinsic",
    .long_name = "Global intrinsic decomposition",
    .klass = "Filter/Effect/Video",
    .description =
        "Decomposes live video into reflectance, direct light, and indirect light by base color",
    .sink = Flow::pixels,
    .src = Flow::pixels_or_layers,
    .layers = kGlobalLayers,
    .create = []() -> std::unique_ptr<Filter> {
      return std::make_unique<Decomposer>(std::make_unique<GlobalMethod>());
    },
    .actions = interaction_actions(),
    .navigation = true,
};

}  // namespace inverse
