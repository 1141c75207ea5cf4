// SPDX-License-Identifier: LGPL-2.1-or-later
// intrinsicdespill: removes or recolors light reflected by surfaces of one color.
#include <optional>

#include "gst/base/color.hpp"
#include "gst/base/filter.hpp"
#include "kernels/edit/light_edit.hpp"

namespace inverse {
namespace {

struct Params {
  int layer = -1;
  uint32_t key_color = 0xff20c040;
  float tolerance = 0.7F;
  float softness = 0.5F;
  uint32_t tint_color = 0xffffffff;
  float keep = 1;
  float strength = 1;
  bool use_mask = true;
};

const PropertyTable<Params>& table() {
  using P = Params;
  static const PropertyTable<P> table{
      number<P>(
          "layer", &P::layer, -1, static_cast<int>(kMaxBases) - 1,
          "Base color whose light to change, as numbered by show=layer; -1 = those near the key"),
      color<P>("key", &P::key_color,
               "Color of the surfaces whose bounced light to change (0xAARRGGBB, sRGB; alpha and "
               "brightness are ignored)"),
      number<P>("tolerance", &P::tolerance, 0, 4.25F,
                "Maximum distance of a base color's chromaticity b / mean(b) from the key's; gray "
                "is 2.45 from a pure primary"),
      number<P>("softness", &P::softness, 0, 3,
                "Distance beyond tolerance over which the effect falls to 0; 0 = all or none"),
      color<P>("tint", &P::tint_color,
               "New color of the light (0xAARRGGBB, sRGB; alpha and brightness are ignored); white "
               "= no color cast"),
      number<P>(
          "keep", &P::keep, 0, 1,
          "Share of the light's brightness to keep: 1 = only its color changes, 0 = it is removed"),
      number<P>("strength", &P::strength, 0, 1,
                "Share of the change of light; 0 = layers pass through unchanged"),
      flag<P>("use-mask", &P::use_mask,
              "Change light by the mask layer only, if the frame has one"),
  };
  return table;
}

class DespillElement final : public Filter {
 public:
  PropertyStore& parameters() override { return parameters_; }
  void configure(const std::shared_ptr<gpu::Device>& device, Extent extent) override {
    edit_.emplace(device, extent);
  }
  void release() override { edit_.reset(); }

  void process(FrameContext& frame) override {
    const Params params = parameters_.snapshot();
    if (!(params.strength > 0)) return;
    std::array<float, 3> target = linear_color(params.tint_color);
    const float mean = (target[0] + target[1] + target[2]) / 3;
    for (float& channel : target) channel = mean > 0 ? channel * params.keep / mean : params.keep;
    const PlanePtr& mask = frame.layers[Role::mask];
    const Plane* matte = params.use_mask && mask ? mask.get() : nullptr;
    const LightEdit::Key key{linear_color(params.key_color), params.tolerance, params.softness};
    if (params.layer >= 0)
      edit_->change(frame.commands, frame.layers, static_cast<uint32_t>(params.layer), target,
                    params.strength, matte);
    else
      edit_->change(frame.commands, frame.layers, key, target, params.strength, matte);
    frame.commands.stage("despill");
  }

 private:
  Parameters<Params> parameters_{table()};
  std::optional<LightEdit> edit_;
};

}  // namespace

extern const ElementInfo kIntrinsicDespill;
const ElementInfo kIntrinsicDespill{
    .factory = "intrinsicdespill",
    .type_name = "GstIntrinsicDespill",
    .long_name = "Intrinsic despill",
    .klass = "Filter/Video",
    .description = "Removes or recolors light reflected by surfaces of one color",
    .sink = Flow::layers_or_pixels,
    .src = Flow::layers,
    .layers = kGlobalLayers,
    .needs = "globalintrinsic",
    .create = [] { return std::unique_ptr<Filter>(new DespillElement); },
};

}  // namespace inverse
