// globalintrinsic: reflectance, direct light and light that bounced off surfaces, of live video.
#include "decomposer.hpp"
#include "global/ladder.hpp"

namespace inverse {
namespace {

struct Params : GlobalIntrinsic::Params, DecomposerParams {
  uint32_t seed = 1;
  /// Rms change of log shading by the last cycle below which a picture that comes again is kept.
  float keep_tolerance = 1e-3F;
};

Params preset(const Params& set) {
  Params params;
  params.quality = set.quality;
  global_ladder().set(params, set.quality);
  return params;
}

class GlobalElement final : public MethodDecomposer<GlobalIntrinsic, Params> {
 public:
  GlobalElement() : MethodDecomposer(table(), global_ladder(), preset) {}

  void configure(const std::shared_ptr<gpu::Device>& device, Extent extent) override {
    MethodDecomposer::configure(device, extent);
    const Params set = parameters_.snapshot();
    method_->prepare(set.halvings());
    // A change of resolution that waits for it would be late itself.
    if (set.target_fps > 0 || set.latency_budget > 0)
      for (const size_t halvings : {0, 1, 2}) method_->prepare(halvings);
  }

 protected:
  bool settled(std::optional<uint64_t> done) const override {
    return done && method_->findings(*done).solve.change < params().keep_tolerance;
  }

  void describe_method(GstStructure* stats, uint64_t number) const override {
    const auto method = method_->stats(number);
    std::string skipped;
    for (const auto& reason : method.solve.skipped)
      skipped += (skipped.empty() ? "" : "; ") + reason;
    const auto found = method_->findings(number);
    gst_structure_set(stats, "amount", G_TYPE_DOUBLE, static_cast<double>(found.amount),
                      "confidence", G_TYPE_DOUBLE, static_cast<double>(found.confidence), "colors",
                      G_TYPE_UINT, found.colors, "tint", G_TYPE_DOUBLE,
                      static_cast<double>(found.tint), "cycles", G_TYPE_UINT, found.solve.cycles,
                      "levels", G_TYPE_UINT, method.solve.levels, "half-resolution", G_TYPE_BOOLEAN,
                      method.solve.halvings > 0, "history", G_TYPE_BOOLEAN, method.solve.history,
                      "cut", G_TYPE_BOOLEAN, found.cut, "mismatch", G_TYPE_DOUBLE,
                      static_cast<double>(found.solve.mismatch), "change", G_TYPE_DOUBLE,
                      static_cast<double>(found.solve.change), "skipped", G_TYPE_STRING,
                      skipped.c_str(), nullptr);
  }

  Settings next_settings(LiveTrade& trade) override {
    const bool had_shares = shows_layer_;
    Settings settings = MethodDecomposer::next_settings(trade);
    shows_layer_ = settings.show == Show::layer;
    settings.changed |= shows_layer_ && !had_shares;  // a kept frame may have none
    return settings;
  }

  uint64_t decompose(FrameWork& frame) override {
    GlobalIntrinsic::Params in_force = params();
    // The sooner a picture that stays has settled, the sooner nothing is left to do.
    if (frame.repeated) in_force.settled = std::min(in_force.settled, params().keep_tolerance);
    frame.layers = method_->record(frame.commands, frame.layers[Role::input], in_force,
                                   {frame.fresh, !frame.draw || shows_layer_});
    return method_->recorded() - 1;
  }

 private:
  bool shows_layer_ = false;

  static const PropertyTable<Params>& table() {
    static const PropertyTable<Params> table = properties<Params>(
        "Sets half-resolution, cycles, warm-cycles, settled and still-tolerance as a group; what "
        "is set explicitly wins",
        own_properties(), Makes::global);
    return table;
  }
  static PropertyTable<Params> own_properties() {
    using P = Params;
    return {
        flag<P>("adaptive", &P::adaptive,
                "Leave out what a frame does not need: tiles where nothing changed keep what was "
                "decided about their edges, cycles end when little changes, and a picture that "
                "comes again keeps its layers once they have settled"),
        number<P>("amount", &P::amount, 0.f, 2.f,
                  "How much light that surfaces send reaches others, as a factor of what the frame "
                  "shows of them; 0 = measured, as stats tell with a confidence"),
        number<P>("typical-amount", &P::typical, 0.05f, 2.f,
                  "The amount of a scene that says nothing of it, as where nothing has color"),
        number<P>("trust", &P::trust, 0.f, 100.f,
                  "How much the scene's colors count beside typical-amount when it is measured"),
        number<P>("base-colors", &P::base_colors, 1, static_cast<int>(kMaxBases),
                  "Base colors at most; as many layers of bounced light are made as there are"),
        number<P>("reach", &P::reach, 0.02f, 2.f,
                  "How far surfaces light each other: standard deviation, of the frame's width"),
        number<P>("near", &P::near, 0.f, 1.f,
                  "Share of that light beside light that comes from all over the frame"),
        number<P>("renew", &P::renew, 0.01f, 1.f,
                  "Share of the newest frame in what is measured of the scene: amount and base "
                  "colors; 1 = follows every frame"),
        number<P>("cut-fraction", &P::cut, 0.f, 1.f,
                  "Mean change of chroma, in halves of a natural log unit, from which on a frame "
                  "counts as a cut of the scene"),
        number<P>("settled", &P::settled, 0.f, 1.f,
                  "Change of log shading by a cycle, rms in natural log units, from which on no "
                  "further one follows; 0 = all run"),
        flag<P>("half-resolution", &P::half_resolution,
                "Solve at half the frame's width and height; where shading steps is then read from "
                "the frame"),
        number<P>("keep-tolerance", &P::keep_tolerance, 0.f, 0.1f,
                  "Change of log shading by the last cycle, rms in natural log units, below which "
                  "the layers of a picture that comes again are kept; 0 = never"),
        number<P>("still-tolerance", &P::still_tolerance, 0.f, 1.f,
                  "Change of intensity or chroma, natural log units, from which on a tile counts "
                  "as changed"),
        number<P>("seed", &P::seed, 0u, G_MAXUINT,
                  "Has no effect, as this method draws nothing at random; for scripts that set it "
                  "on any decomposer"),
        number<P>("cycles", &P::cycles, 1u, 32u,
                  "Multigrid cycles of a frame without history (the first, after a seek, a gap or "
                  "new caps)"),
        number<P>("warm-cycles", &P::warm_cycles, 1u, 32u,
                  "Multigrid cycles of a frame that continues the one before, and so starts near "
                  "its solution"),
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
    "Takes live video apart into reflectance, direct light, and light that bounced off surfaces of "
    "each base color",
    Flow::pixels,
    Flow::pixels_or_layers,
    kGlobalLayers,
    nullptr,
    [] { return std::unique_ptr<Filter>(new GlobalElement); }};

}  // namespace inverse
