// SPDX-License-Identifier: LGPL-2.1-or-later
// intrinsicstylize: draws video as a cartoon.
#include <optional>

#include "gst/base/filter.hpp"
#include "kernels/edit/stylize/stylize.hpp"

namespace inverse {
namespace {

const PropertyTable<StylizeParams>& table() {
  using P = StylizeParams;
  static const PropertyTable<P> table{
      number<P>("scale", &P::scale, P::kMinScale, P::kMaxScale,
                "Size of detail in lines and shading, pixels (sigma of a Gaussian); raise it for "
                "bolder lines and for large frames"),
      number<P>("sensitivity", &P::sensitivity, 0, 100,
                "1 / height of the smallest step of shading that gets a line, 1 / stops; 0 = no "
                "lines"),
      number<P>("sharpness", &P::sharpness, 0, 100,
                "How fast lines become black beyond that height; low = pencil, high = ink"),
      number<P>("levels", &P::levels, 0, P::kMaxLevels,
                "Levels of shading between black and bright light; 0 = shading stays smooth"),
      number<P>("softness", &P::softness, 0, 1,
                "Share of the way between two levels that is gradual; raise it if steps flicker"),
      number<P>("flatten", &P::flatten, 0, 2,
                "Difference of ln reflectance up to which neighbors are averaged; 0 = texture "
                "stays"),
      number<P>("strength", &P::strength, 0, 1,
                "Share of the change; 0 = layers pass through unchanged"),
      flag<P>("use-mask", &P::use_mask,
              "Multiply the change by the mask layer if the frame has one"),
  };
  return table;
}

class StylizeElement final : public Filter {
 public:
  PropertyStore& parameters() override { return parameters_; }
  void configure(const std::shared_ptr<gpu::Device>& device, Extent extent) override {
    stylize_.emplace(device, extent);
  }
  void release() override { stylize_.reset(); }

  void process(FrameContext& frame) override {
    const uint32_t before = frame.commands.dispatches();
    stylize_->record(frame.commands, frame.layers, parameters_.snapshot());
    if (frame.commands.dispatches() > before) frame.commands.stage("stylize");
  }

 private:
  Parameters<StylizeParams> parameters_{table()};
  std::optional<Stylize> stylize_;
};

}  // namespace

extern const ElementInfo kIntrinsicStylize;
const ElementInfo kIntrinsicStylize{
    .factory = "intrinsicstylize",
    .type_name = "GstIntrinsicStylize",
    .long_name = "Intrinsic stylize",
    .klass = "Filter/Video",
    .description = "Draws lines at edges of shading, and shading in levels",
    .sink = Flow::layers_or_pixels,
    .src = Flow::layers,
    .layers = kAnyLayers,
    .needs = "intrinsicdecomp",
    .create = [] { return std::unique_ptr<Filter>(new StylizeElement); },
};

}  // namespace inverse
