// SPDX-License-Identifier: LGPL-2.1-or-later
// intrinsictone: changes shading by a tone curve, as another material would.
#include <array>
#include <optional>
#include <string>

#include "common/error.hpp"
#include "gst/base/filter.hpp"
#include "kernels/edit/tone/tone.hpp"

namespace inverse {
namespace {

enum class Look { custom, velvet, shiny, metal, matte };

struct Params {
  Look look = Look::custom;
  std::string curve;  ///< of Look::custom
  float middle = 0;
  float strength = 1;
  bool use_mask = true;
};

/// Curves of the looks, by Look. Plaster and cloth vary by some two stops about their middle.
constexpr std::array<const char*, 5> kCurves{
    "",
    // Fibers scatter light sideways: what faces the light is dark and soft, rims are bright.
    "-5,-4.2 -2.5,-1.8 -1.2,-0.6 -0.6,-0.7 0,-1.3 0.4,-1 0.9,0.1 1.5,0.8 2.5,1.2",
    // Highlights far above a body that is a little darker.
    "-5,-5.4 -2,-2.5 -0.5,-0.9 0.2,-0.1 0.7,0.9 1.3,2.1 2,2.6",
    // No diffuse light: dark, with bands of the surroundings and hard highlights.
    "-5,-6.5 -2.5,-4 -1.2,-1.5 -0.6,-2.6 0,-1.6 0.5,0.6 0.8,0 1.3,2 2,2.4",
    // Less contrast, and no highlights.
    "-5,-3.2 -2,-1.2 -0.7,-0.4 0,0 0.6,0.25 1.2,0.35 2,0.4",
};

/// What is wrong with a text of the property `curve`, in words.
std::string wrong_curve(const GValue* value) {
  const char* text = g_value_get_string(value);
  try {
    parse_curve(text ? text : "");
    return {};
  } catch (const Error& error) {
    return error.what();
  }
}

const PropertyTable<Params>& table() {
  using P = Params;
  Property<P> curve = text<P>(
      "curve", &P::curve,
      "Control points of look=custom as x,y x,y or x:y/x:y: shading before and after, in stops "
      "above middle shading; empty = no change");
  curve.wrong = wrong_curve;
  static const PropertyTable<P> table{
      choice<P>("look", &P::look, "GstInverseToneLook",
                {{static_cast<int>(Look::custom), "custom", "The curve of the property curve"},
                 {static_cast<int>(Look::velvet), "velvet", "Soft, with bright rims"},
                 {static_cast<int>(Look::shiny), "shiny", "Strong highlights"},
                 {static_cast<int>(Look::metal), "metal", "Dark, with bands and hard highlights"},
                 {static_cast<int>(Look::matte), "matte", "Low contrast, without highlights"}},
                "Material that shading is changed to"),
      curve,
      number<P>("middle", &P::middle, 0, 1000,
                "Shading at 0 stops of the curve; 0 = mean of what is edited, measured"),
      number<P>("strength", &P::strength, 0, 1,
                "Share of the change, in stops; 0 = layers pass through unchanged"),
      flag<P>("use-mask", &P::use_mask,
              "Multiply the change by the mask layer if the frame has one"),
  };
  return table;
}

class ToneElement final : public Filter {
 public:
  PropertyStore& parameters() override { return parameters_; }
  void configure(const std::shared_ptr<gpu::Device>& device, Extent extent) override {
    tone_.emplace(device, extent);
  }
  void release() override { tone_.reset(); }
  void reset() override { tone_->reset(); }

  void process(FrameContext& frame) override {
    const Params params = parameters_.snapshot();
    const char* curve = kCurves[static_cast<size_t>(params.look)];
    const uint32_t before = frame.commands.dispatches();
    tone_->record(frame.commands, frame.layers,
                  {.curve = parse_curve(params.look == Look::custom ? params.curve : curve),
                   .middle = params.middle,
                   .strength = params.strength,
                   .use_mask = params.use_mask});
    if (frame.commands.dispatches() > before) frame.commands.stage("tone");
  }

 private:
  Parameters<Params> parameters_{table()};
  std::optional<Tone> tone_;
};

}  // namespace

extern const ElementInfo kIntrinsicTone;
const ElementInfo kIntrinsicTone{
    .factory = "intrinsictone",
    .type_name = "GstIntrinsicTone",
    .long_name = "Intrinsic tone",
    .klass = "Filter/Video",
    .description = "Changes shading by a tone curve, as another material would",
    .sink = Flow::layers_or_pixels,
    .src = Flow::layers,
    .layers = kAnyLayers,
    .needs = "intrinsicdecomp",
    .create = [] { return std::unique_ptr<Filter>(new ToneElement); },
};

}  // namespace inverse
