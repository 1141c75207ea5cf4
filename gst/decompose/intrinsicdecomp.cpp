// intrinsicdecomp: reflectance and shading of live video, one log-shading unknown a pixel.
#include "decomposer.hpp"
#include "intrinsic/intrinsic_decomposition.hpp"

namespace inverse {
namespace {

struct Params : IntrinsicDecomposition::Params {
  Show show = Show::reflectance;
  Quality quality = Quality::medium;
};

Params preset(const Params& set) {
  Params params;
  params.quality = set.quality;
  constexpr uint32_t kSteps[] = {2, 4, 6, 12}, kWarmSteps[] = {1, 2, 4, 12},
                     kCycles[] = {1, 1, 2, 4};
  const auto level = static_cast<size_t>(set.quality);
  params.steps = kSteps[level];
  params.warm_steps = kWarmSteps[level];
  params.cycles = kCycles[level];
  return params;
}

class IntrinsicElement final : public Decomposer {
 public:
  PropertyStore& parameters() override { return parameters_; }

  void configure(const std::shared_ptr<gpu::Device>& device, Extent extent) override {
    Decomposer::configure(device, extent);
    method_.emplace(device, extent);
  }
  void release() override {
    method_.reset();
    Decomposer::release();
  }
  void reset() override { method_->reset(); }

  void describe(GstStructure* stats) const override {
    const auto& method = method_->stats();
    std::string skipped;
    for (const auto& reason : method.skipped) skipped += (skipped.empty() ? "" : "; ") + reason;
    gst_structure_set(stats, "steps", G_TYPE_UINT, method.steps, "cycles", G_TYPE_UINT,
                      method.cycles, "levels", G_TYPE_UINT, method.levels, "warm", G_TYPE_BOOLEAN,
                      method.warm, "skipped", G_TYPE_STRING, skipped.c_str(), nullptr);
  }

 protected:
  Show decompose(FrameWork& frame) override {
    const Params params = parameters_.snapshot();
    frame.layers =
        method_->record(frame.commands, frame.layers[Role::input], params, {frame.fresh});
    frame.commands.stage("decompose");
    return params.show;
  }

 private:
  static const PropertyTable<Params>& table() {
    using P = Params;
    static const PropertyTable<P> table{
        choice<P>("show", &P::show, "GstInverseShow", show_choices(),
                  "What to show where ordinary video goes out; elements that take layers get all "
                  "of them"),
        choice<P>("quality", &P::quality, "GstInverseQuality", quality_choices(),
                  "Sets steps and cycles as a group; what is set explicitly wins"),
    };
    return table;
  }

  Parameters<Params> parameters_{table(), preset};
  std::optional<IntrinsicDecomposition> method_;
};

}  // namespace

extern const ElementInfo kIntrinsicDecomp;
const ElementInfo kIntrinsicDecomp{"intrinsicdecomp",
                                   "GstIntrinsicDecomp",
                                   "Intrinsic decomposition",
                                   "Filter/Effect/Video",
                                   "Takes live video apart into reflectance (color without light) "
                                   "and shading (light without color)",
                                   Flow::pixels,
                                   Flow::pixels_or_layers,
                                   nullptr,
                                   [] { return std::unique_ptr<Filter>(new IntrinsicElement); }};

}  // namespace inverse
