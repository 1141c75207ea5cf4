// SPDX-License-Identifier: LGPL-2.1-or-later
// globalintrinsic: reflectance, direct light and light that bounced off surfaces, of live video.
#include "gst/base/color.hpp"
#include "kernels/global/quality_levels.hpp"
#include "solve_properties.hpp"

namespace inverse {
namespace {

using Params = SolveElementParams<GlobalIntrinsic::Params>;

class GlobalElement final : public SolvingDecomposer<GlobalIntrinsic, Params> {
 public:
  GlobalElement() : SolvingDecomposer(table(), global_levels()) {}

 protected:
  bool settled(std::optional<uint64_t> done) const override {
    return done && !method_->fading() &&
           method_->findings(*done).solve.change < params().keep_tolerance;
  }

  void describe_method(GstStructure* stats, uint64_t number) const override {
    const auto found = method_->findings(number);
    describe_solve(stats, method_->stats(number).solve, found.solve);
    gst_structure_set(stats, "amount", G_TYPE_DOUBLE, static_cast<double>(found.amount),
                      "confidence", G_TYPE_DOUBLE, static_cast<double>(found.confidence), "colors",
                      G_TYPE_UINT, found.colors, "tint", G_TYPE_DOUBLE,
                      static_cast<double>(found.tint), "chroma", G_TYPE_DOUBLE,
                      static_cast<double>(found.chroma), "cut", G_TYPE_BOOLEAN, found.cut, nullptr);
    GValue list = G_VALUE_INIT;
    gst_value_array_init(&list, kMaxBases);
    for (const auto& base : found.bases) {
      GValue entry = G_VALUE_INIT;
      g_value_init(&entry, G_TYPE_UINT);
      g_value_set_uint(&entry, base[0] + base[1] + base[2] > 0 ? srgb_color(base) : 0);
      gst_value_array_append_and_take_value(&list, &entry);
    }
    gst_structure_take_value(stats, "base-colors", &list);
  }

  const ScaledIntrinsic::Stats& solve_stats(uint64_t number) const override {
    return method_->stats(number).solve;
  }

  Settings next_settings(RateController& controller) override {
    const bool had_shares = shows_layer_;
    Settings settings = SolvingDecomposer::next_settings(controller);
    shows_layer_ = settings.show == Show::layer;
    settings.changed |= shows_layer_ && !had_shares;  // a kept frame may have none
    return settings;
  }

  uint64_t decompose(FrameContext& frame) override {
    Params params = in_force(frame);
    // As intrinsicdecomp: a picture that rests settles everywhere.
    if (frame.repeated && repeated_) params.tile_tolerance = 0;
    repeated_ = frame.repeated;
    frame.layers = method_->record(frame.commands, frame.layers[Role::input], params,
                                   {frame.fresh, !frame.draw || shows_layer_, frame.changed});
    frame.drawn = method_->drawn();
    return method_->recorded() - 1;
  }

  void draw_clusters(FrameContext& frame, const Plane& target) override {
    method_->draw_labels(frame.commands, *frame.layers[Role::input], target);
  }

  // A frame whose light was found before is not typical.
  bool typical(uint64_t number) const override {
    return SolvingDecomposer::typical(number) && !method_->stats(number).held;
  }

 private:
  bool repeated_ = false;  // the last frame that was decomposed
  bool shows_layer_ = false;

  static const PropertyTable<Params>& table() {
    static const PropertyTable<Params> table = [] {
      PropertyTable<Params> all = light_properties();
      const auto solve = solve_properties<Params>();
      all.insert(all.end(), solve.begin(), solve.end());
      all.push_back(tile_tolerance_property<Params>());
      return properties<Params>({kSolveSets}, all, Makes::global);
    }();
    return table;
  }
  static PropertyTable<Params> light_properties() {
    using P = Params;
    return {
        number<P>("amount", &P::amount, 0.f, 2.f,
                  "Indirect light as a factor of what surfaces in view emit; 0 = estimated, raise "
                  "it if a cast remains"),
        tuning(number<P>("typical-amount", &P::typical, 0.05f, 2.f,
                         "Amount assumed for a scene whose colors do not determine it")),
        tuning(number<P>("trust", &P::trust, 0.f, 100.f,
                         "Weight of the scene's colors against typical-amount; 0 = not used, "
                         "indirect light is gray")),
        number<P>(
            "white-balance", &P::white_balance, 0.f, 1.f,
            "Share of the estimated lamp color to remove from reflectance; 0 = lamps are white"),
        number<P>("base-colors", &P::base_colors, 1, static_cast<int>(kMaxBases),
                  "Maximum number of base colors, each with a layer of indirect light"),
        tuning(number<P>("reach", &P::reach, 0.02f, 2.f,
                         "Standard deviation of the distance over which surfaces light each other, "
                         "in frame widths")),
        tuning(number<P>("near", &P::near, 0.f, 1.f,
                         "Share of near indirect light; the rest comes from the whole frame")),
        tuning(number<P>("renew", &P::renew, 0.01f, 1.f,
                         "Share of the newest frame in the estimates of amount and base colors; 1 "
                         "= no averaging")),
        tuning(number<P>("cut-chroma", &P::cut, 0.f, 1.f,
                         "Mean change of chroma that counts as a scene cut for these estimates, "
                         "half natural log units")),
    };
  }
};

}  // namespace

extern const ElementInfo kGlobalIntrinsic;
const ElementInfo kGlobalIntrinsic{
    "globalintrinsic",
    "GstGlobalIntrinsic",
    "Global intrinsic decomposition",
    "Filter/Effect/Video",
    "Decomposes live video into reflectance, direct light, and light that bounced off surfaces of "
    "each base color",
    Flow::pixels,
    Flow::pixels_or_layers,
    kGlobalLayers,
    nullptr,
    [] { return std::unique_ptr<Filter>(new GlobalElement); }};

}  // namespace inverse
