// SPDX-License-Identifier: LGPL-2.1-or-later
// intrinsickey: separates a foreground from a screen of one color.
#include <optional>
#include <utility>

#include "gst/base/color.hpp"
#include "gst/base/filter.hpp"
#include "gst/base/json/json_list.hpp"
#include "gst/edit/picker.hpp"
#include "kernels/edit/key/key.hpp"

namespace inverse {
namespace {

enum class Show { keyed, mask };

struct Params : KeyParams {
  uint32_t key_color = 0xff20c040;  ///< 0: of the border
  bool pick = false;
  Show show = Show::keyed;
};

const PropertyTable<Params>& table() {
  using P = Params;
  static const PropertyTable<P> table{
      color<P>("key", &P::key_color,
               "Color of the screen (0xAARRGGBB, sRGB; only its hue counts, within 60 degrees: the "
               "rest is measured); 0 = the hue that prevails at the frame's border"),
      flag<P>("pick", &P::pick, "A click on the picture sets key to the reflectance there"),
      number<P>("tolerance", &P::tolerance, 0.01F, 2,
                "Maximum distance of chromaticity R / mean(R) from the screen's of pixels that "
                "surely show it; raise it for a screen of uneven paint"),
      number<P>("black", &P::black, 0, 1, "Alpha that becomes 0; raise it if the screen shimmers"),
      number<P>("white", &P::white, 0, 1,
                "Alpha that becomes 1; lower it if the foreground has holes"),
      number<P>("shrink", &P::shrink, -P::kMaxShrink, P::kMaxShrink,
                "Distance by which the foreground's edge moves inward, pixels; negative = outward"),
      number<P>("despill", &P::despill, 0, 1,
                "Share of the screen's hue in the foreground that becomes gray, in pictures with "
                "alpha; lower it for a foreground of that hue"),
      number<P>("strength", &P::strength, 0, 1,
                "Share of the screen that is removed; 0 = layers pass through unchanged"),
      flag<P>("invert", &P::invert, "The mask is that of the screen, instead of the foreground"),
      flag<P>("use-mask", &P::use_mask,
              "Remove the screen only where the mask layer selects, if the frame has one"),
      choice<P>(
          "show", &P::show, "GstInverseKeyShow",
          {{static_cast<int>(Show::keyed), "keyed",
            "The foreground without the screen's light, with straight alpha; over black if the "
            "format has no alpha"},
           {static_cast<int>(Show::mask), "mask", "The mask, as gray"}},
          "Picture to show, if pictures go out instead of layers"),
  };
  return table;
}

class KeyElement final : public Filter {
 public:
  PropertyStore& parameters() override { return parameters_; }
  std::span<const char* const> shows_frame() const override {
    static constexpr std::array kFrames{"keyed"};
    return kFrames;
  }
  void configure(const std::shared_ptr<gpu::Device>& device, Extent extent) override {
    key_.emplace(device, extent);
    compose_.emplace(device, extent);
    picker_.configure(device);
    for (auto& copy : copies_)
      copy = {gpu::Buffer::create(device, gpu::Element::vec4, 1, gpu::Memory::readback), false};
  }
  void release() override {
    key_.reset();
    compose_.reset();
    picker_.release();
    copies_ = {};
    missing_.reset();
    reported_.reset();
  }
  void reset() override { key_->reset(); }
  std::vector<Setting> navigate(const MouseEvent& event) override {
    picker_.navigate(event);
    return {};
  }
  void flushed() override { picker_.forget(); }

  void process(FrameContext& frame) override {
    Params params = parameters_.snapshot();
    params.of_border = params.key_color == 0;
    params.key = linear_color(params.key_color);
    if (missing_ == params.key_color && std::exchange(reported_, missing_) != missing_)
      frame.warnings.push_back(
          "no screen of " +
          (params.of_border ? "the hue of the frame's border"
                            : "the hue of " + json_list::color_text(params.key_color)) +
          " was found, so that all of the picture is foreground; set key to the screen's color, or "
          "pick=true and click on it, or raise tolerance if its paint is uneven");
    const uint32_t before = frame.commands.dispatches();
    picker_.record(frame, params.pick ? "key" : nullptr);
    key_->record(frame.commands, frame.layers, params);
    Copy& copy = copies_[frame.number];
    copy.measured = params.strength > 0;
    copy.key = params.key_color;
    if (copy.measured) frame.commands.copy(key_->screen(), copy.screen, copy.screen->bytes());
    if (frame.draw) frame.picture = draw(frame, params);
    if (frame.commands.dispatches() > before) frame.commands.stage("key");
  }

  void completed(uint64_t number, double) override {
    picker_.completed(number, log().object);
    const Copy& copy = copies_[number];
    if (copy.measured && !(copy.screen->map_as<float>()[3] > 0)) missing_ = copy.key;
  }

  void describe(GstStructure* stats, uint64_t number) const override {
    const Copy& copy = copies_[number];
    const float* screen = copy.measured ? copy.screen->map_as<float>() : nullptr;
    if (screen && screen[3] > 0)
      gst_structure_set(stats, "screen", G_TYPE_UINT, srgb_color({screen[0], screen[1], screen[2]}),
                        nullptr);
  }

 private:
  Picture draw(FrameContext& frame, const Params& params) {
    if (params.show == Show::keyed) {
      // The base takes alpha from the input layer, which goes no further here.
      PlanePtr& alpha = frame.layers[Role::input];
      PlanePtr picture = key_->draw(frame.commands, frame.layers, params, !frame.alpha);
      frame.commands.keep(std::exchange(alpha, picture));
      return {picture};
    }
    if (!frame.layers[Role::mask])
      throw Error(ErrorKind::unsupported,
                  "there is no mask to show, as strength is 0; set strength above 0");
    return {compose_->record_mask(frame.commands, frame.layers)};
  }

  Parameters<Params> parameters_{table()};
  std::optional<Key> key_;
  std::optional<Compose> compose_;
  Picker picker_;
  /// The screen of a frame, for its stats.
  struct Copy {
    gpu::BufferPtr screen;
    bool measured = false;
    guint key = 0;
  };
  gpu::FrameRing<Copy> copies_;
  // Of the last frame without a screen: the key's color; and that of the last warning about one.
  std::optional<guint> missing_, reported_;
};

}  // namespace

extern const ElementInfo kIntrinsicKey;
const ElementInfo kIntrinsicKey{
    .factory = "intrinsickey",
    .type_name = "GstIntrinsicKey",
    .long_name = "Intrinsic key",
    .klass = "Filter/Video",
    .description = "Separates a foreground from a screen of one color",
    .sink = Flow::layers_or_pixels,
    .src = Flow::layers_or_pixels,
    .layers = kAnyLayers,
    .needs = "intrinsicdecomp",
    .create = [] { return std::unique_ptr<Filter>(new KeyElement); },
    .navigation = true,
};

}  // namespace inverse
