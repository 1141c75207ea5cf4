// SPDX-License-Identifier: LGPL-2.1-or-later
// intrinsiccompose: makes ordinary video again of decomposed video; the end of a chain of editors.
#include <array>
#include <optional>
#include <string>

#include "effects/returns.hpp"
#include "gst/base/pads/missing_layers.hpp"
#include "gst/decompose/light_pictures.hpp"
#include "kernels/edit/compose.hpp"

namespace inverse {
namespace {

enum class Show {
  composed,
  reflectance,
  shading,
  input,
  mask,
  difference,
  direct,
  indirect,
  layer,
  diffuse,
  specular,
  mirror
};

struct Params : ComposeParams {
  bool use_mask = true;
  Show show = Show::composed;
  int layer = 0;               ///< of Show::layer
  float shading_scale = 0.5F;  ///< of all kinds of light
};

const PropertyTable<Params>& table() {
  using P = Params;
  static const PropertyTable<P> table{
      choice<P>(
          "show", &P::show, "GstInverseComposeShow",
          {{static_cast<int>(Show::composed), "composed", "The frame with its edits"},
           {static_cast<int>(Show::reflectance), "reflectance", "Reflectance, edited"},
           {static_cast<int>(Show::shading), "shading",
            "Shading, edited, in color if light has one"},
           {static_cast<int>(Show::input), "input", "The frame as it came in"},
           {static_cast<int>(Show::mask), "mask", "The mask layer, as gray"},
           {static_cast<int>(Show::difference), "difference",
            "Change by the edits, on middle gray"},
           {static_cast<int>(Show::direct), "direct",
            "Light that comes straight from the lamps (globalintrinsic)"},
           {static_cast<int>(Show::indirect), "indirect",
            "Light that bounced off surfaces, in color (globalintrinsic)"},
           {static_cast<int>(Show::layer), "layer",
            "Light that bounced off surfaces of one base color, see layer"},
           {static_cast<int>(Show::diffuse), "diffuse",
            "The frame without its object's highlights (limematerial)"},
           {static_cast<int>(Show::specular), "specular", "The object's highlights (limematerial)"},
           {static_cast<int>(Show::mirror), "mirror",
            "Reflection by a mirror of the object's shape and specular albedo (limematerial)"}},
          "Picture to show"),
      number<P>("layer", &P::layer, 0, static_cast<int>(kMaxBases) - 1,
                "Base color whose layer show=layer shows"),
      number<P>("shading-scale", &P::shading_scale, 0.f, 100.f,
                "Factor on light that is shown, before it is clipped at 1"),
      choice<P>(
          "residual", &P::residual, "GstInverseResidual",
          {{static_cast<int>(Residual::add), "add",
            "input + edited - unedited model: highlights stay as they are"},
           {static_cast<int>(Residual::ratio), "ratio",
            "input x edited / unedited model: noise and fine detail scale with the edit"},
           {static_cast<int>(Residual::none), "none", "The edited model without the residual"}},
          "How to treat the residual, input - reflectance x shading; layers of limematerial have "
          "none"),
      number<P>("strength", &P::strength, 0, 1,
                "Share of the edits to show: 0 = the input, 1 = all of them"),
      flag<P>("use-mask", &P::use_mask,
              "Take what pictures that came back have changed by the mask layer only, if the frame "
              "has one"),
  };
  return table;
}

class ComposeElement final : public ReturningFilter {
 public:
  PropertyStore& parameters() override { return parameters_; }
  std::span<const char* const> shows_frame() const override {
    static constexpr std::array kFrames{"composed", "input"};
    return kFrames;
  }
  void configure(const std::shared_ptr<gpu::Device>& device, Extent extent) override {
    compose_.emplace(device, extent);
  }
  void release() override {
    ReturningFilter::release();
    compose_.reset();
    pictures_ = {};
  }

  void process(FrameContext& frame) override {
    const Params params = parameters_.snapshot();
    apply_returned(frame, {.use_mask = params.use_mask});
    const uint32_t before = frame.commands.dispatches();
    frame.picture = draw(frame, params);
    if (frame.commands.dispatches() > before) frame.commands.stage("compose");
  }

 private:
  Picture draw(FrameContext& frame, const Params& params) {
    switch (params.show) {
      case Show::reflectance:
        return {needed(frame, Role::intrinsic, "reflectance", "intrinsicdecomp")};
      case Show::shading:
        needed(frame, Role::intrinsic, "shading", "intrinsicdecomp");
        return scaled(pictures_.shading(frame.commands, frame.layers), params);
      case Show::input:
        return {frame.layers[Role::input]};
      case Show::mask:
        if (frame.layers.material()) return {frame.layers[Role::diffuse], true};
        if (!frame.layers[Role::mask])
          throw Error(ErrorKind::unsupported,
                      "there is no mask to show; set write-mask=true on an editor before "
                      "intrinsiccompose");
        return {compose_->record_mask(frame.commands, frame.layers)};
      case Show::difference:
        return {compose_->record_difference(frame.commands, frame.layers)};
      case Show::direct:
        return light(frame, LightPicture::What::direct, params);
      case Show::indirect:
        return light(frame, LightPicture::What::indirect, params);
      case Show::layer:
        return light(frame, LightPicture::What::layer, params);
      case Show::diffuse:
        return {needed(frame, Role::diffuse, "diffuse light", "limematerial")};
      case Show::specular:
        return {needed(frame, Role::specular, "highlights", "limematerial")};
      case Show::mirror:
        return {needed(frame, Role::specular, "mirror image", "limematerial"), true};
      case Show::composed:
        break;
    }
    return {compose_->record(frame.commands, frame.layers, params)};
  }

  static PlanePtr needed(const FrameContext& frame, Role role, const char* what,
                         const char* maker) {
    if (!frame.layers[role])
      throw Error(ErrorKind::unsupported, "these layers are " + contents_of(frame.layers) +
                                              " and have no " + what +
                                              " for intrinsiccompose to show; put " + maker +
                                              " in the place of the decomposer before it");
    return frame.layers[role];
  }

  static Picture scaled(Picture picture, const Params& params) {
    picture.gain = params.shading_scale;
    return picture;
  }

  Picture light(FrameContext& frame, LightPicture::What what, const Params& params) {
    return scaled(pictures_.draw(frame.commands, frame.layers, what, "intrinsiccompose",
                                 static_cast<uint32_t>(params.layer)),
                  params);
  }

  Parameters<Params> parameters_{table()};
  std::optional<Compose> compose_;
  LightPictures pictures_;
};

}  // namespace

extern const ElementInfo kIntrinsicCompose;
const ElementInfo kIntrinsicCompose{
    .factory = "intrinsiccompose",
    .type_name = "GstIntrinsicCompose",
    .long_name = "Intrinsic compose",
    .klass = "Filter/Video",
    .description = "Multiplies edited layers into a picture",
    .sink = Flow::layers_or_pixels,
    .src = Flow::pixels,
    .layers = kAllLayers,
    .needs = "intrinsicdecomp",
    .create = [] { return std::unique_ptr<Filter>(new ComposeElement); },
    .accepts = kAllLayers,
    .plain_caps = nullptr,
    .side_sinks = Returns::pad_names(),
};

}  // namespace inverse
