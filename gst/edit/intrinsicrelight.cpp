// SPDX-License-Identifier: LGPL-2.1-or-later
// intrinsicrelight: adds lamps to a scene.
#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "gst/base/filter.hpp"
#include "kernels/edit/relight/relight.hpp"
#include "lamp_editor.hpp"

namespace inverse {
namespace {

/// RelightParams but for its lamps, and what else is a property.
struct Params : LampParams {
  RelightParams light;
  std::string location;
};

const PropertyTable<Params>& table() {
  using P = Params;
  using Surface = RelightParams::Surface;
  using Kind = Lamp::Kind;
  const auto of_light = [](auto member) {
    return [member](P & params) -> auto& { return params.light.*member; };
  };
  using R = RelightParams;
  Property<P> lamps = text<P>(
      "lamps", &P::lamps,
      "JSON list of up to 8 lamps, x and y in pixels, z above the picture; with room, in meters in "
      "the axes of the remembered scene: "
      "[{\"kind\":\"point|spot|directional\",\"position\":[x,y,z],\"direction\":[x,y,z],"
      "\"color\":\"#rrggbb\",\"power\":0.1,\"angle\":30,\"softness\":0.3,\"radius\":0.02,"
      "\"room\":false}]");
  lamps.wrong = wrong_lamps;
  static const PropertyTable<P> table{
      lamps,
      number<P>("ambient", of_light(&R::ambient), 0, 1,
                "Share of the light of the frame that stays: 1 = lamps are added to it, 0 = only "
                "lamps light"),
      number<P>("strength", of_light(&R::strength), 0, 1000,
                "Factor on the power of all lamps; 0 = off"),
      choice<P>("geometry", of_light(&R::surface), "GstInverseRelightGeometry",
                {{static_cast<int>(Surface::automatic), "auto",
                  "The file of location; without one, as shading"},
                 {static_cast<int>(Surface::shading), "shading",
                  "Normals that are estimated from shading: approximate"},
                 {static_cast<int>(Surface::flat), "flat", "All surfaces face the viewer"},
                 {static_cast<int>(Surface::scene), "scene",
                  "The remembered scene of the decomposer, with shadows; without one, as auto"}},
                "Source of the shape of the scene, but for lamps in the room, which light the "
                "remembered one"),
      text<P>("location", &P::location,
              "PNG file of the geometry of a still scene: gray = depth along the optical axis (0 = "
              "unknown), RGB = normals from -1 to 1 (x right, y up, z to the camera)",
              Mutable::ready),
      number<P>("relief", of_light(&R::relief), -10, 10,
                "Factor on slopes that are estimated from shading: 0 = flat, negative = dark is "
                "near"),
      number<P>("depth-units", of_light(&R::depth_units), 0.001F, 1e6F,
                "Codes per meter of depth in location: 1000 = millimeters"),
      number<P>("field-of-view", of_light(&R::field_of_view), 1, 170,
                "Horizontal field of view of the camera, degrees, for depth"),
      number<P>("plane-depth", of_light(&R::plane_depth), 0, 10000,
                "Distance of the plane from which the z of lamps is measured from the camera, "
                "meters, for depth; 0 = median depth, with geometry=scene 2"),
      flag<P>("shadows", of_light(&R::shadows), "Lamps in the remembered scene cast shadows"),
      choice<P>(
          "lamp-mode", &P::lamp_mode, "GstInverseLampMode",
          {{static_cast<int>(LampMode::off), "off", "Navigation events do nothing"},
           {static_cast<int>(LampMode::move), "move", "Drags move lamps"},
           {static_cast<int>(LampMode::add), "add", "Drags move lamps; a press on none adds one"},
           {static_cast<int>(LampMode::remove), "remove", "Presses remove lamps"}},
          "What the mouse does on the picture"),
      choice<P>("lamp-kind", &P::lamp_kind, "GstInverseLampKind",
                {{static_cast<int>(Kind::point), "point", "Shines in all directions"},
                 {static_cast<int>(Kind::spot), "spot", "Shines into a cone"},
                 {static_cast<int>(Kind::directional), "directional",
                  "Shines everywhere alike, as the sun"}},
                "Kind of lamps that the mouse adds"),
      number<P>("lamp-color", &P::lamp_color, 0U, 0xffffffffU,
                "Color of lamps that the mouse adds (0xAARRGGBB, sRGB; alpha is ignored)"),
      number<P>("lamp-power", &P::lamp_power, 0.F, 1e6F,
                "Power of lamps that the mouse adds: shading that they add at a distance of 1"),
      number<P>("lamp-height", &P::lamp_height, -1000.F, 1000.F,
                "Height above the picture of lamps that the mouse adds: widths of the frame, or "
                "meters if depth is known; in a remembered scene, before the surface under the "
                "mouse"),
      flag<P>("show-lamps", of_light(&R::markers), "Draw where lamps are"),
      flag<P>("use-mask", of_light(&R::use_mask),
              "Multiply the change by the mask layer if the frame has one"),
  };
  return table;
}

class RelightElement final : public Filter {
 public:
  PropertyStore& parameters() override { return parameters_; }

  void start() override {
    file_ = nullptr;
    told_ = false;
    const std::string location = parameters_.snapshot().location;
    if (location.empty()) return;
    std::string warning;
    file_ = std::make_shared<const SurfaceFile>(SurfaceFile::load(location, warning));
    if (!warning.empty()) warnings_.push_back(warning);
    GST_CAT_INFO_OBJECT(log().category, log().object, "read %s of %s",
                        file_->has_depth() ? "depth" : "normals", location.c_str());
  }
  void configure(const std::shared_ptr<gpu::Device>& device, Extent extent) override {
    extent_ = extent;
    relight_.emplace(device, extent);
    views_.emplace(device);
    relight_->set_surface(file_);
  }
  void release() override {
    editor_.stop();
    relight_.reset();
    views_.reset();
  }
  void reset() override { relight_->reset(); }
  void flushed() override { editor_.flush(); }

  std::vector<Setting> navigate(const MouseEvent& event) override {
    editor_.mouse(log(), event, parameters_.snapshot());
    return {};
  }

  void process(FrameContext& frame) override {
    Params params = parameters_.snapshot();
    params.light.lamps = editor_.take(params.lamps, extent_);
    frame.warnings = std::exchange(warnings_, {});
    for (std::string& warning : editor_.take_warnings())
      frame.warnings.push_back(std::move(warning));
    warn_without_scene(frame, params);
    using Surface = RelightParams::Surface;
    const bool adds =
        params.lamp_mode == LampMode::add &&
        (params.light.surface == Surface::automatic || params.light.surface == Surface::scene);
    const bool reads = params.lamp_mode != LampMode::off && frame.layers.scene &&
                       (adds || std::ranges::any_of(params.light.lamps, &Lamp::room));
    views_->record(frame.commands, frame.number, reads ? frame.layers.scene.get() : nullptr, adds);
    adds_in_room_[frame.number] = adds;
    const uint32_t before = frame.commands.dispatches();
    relight_->record(frame.commands, frame.layers, params.light);
    if (frame.commands.dispatches() > before) frame.commands.stage("relight");
    plane_depths_[frame.number] = relight_->plane_depth();
  }

  void completed(uint64_t number, double) override {
    editor_.see(views_->view(number), adds_in_room_[number]);
  }

  void describe(GstStructure* stats, uint64_t number) const override {
    if (plane_depths_[number] > 0)
      gst_structure_set(stats, "plane-depth", G_TYPE_DOUBLE,
                        static_cast<double>(plane_depths_[number]), nullptr);
  }

  LampEditor& editor() { return editor_; }

 private:
  void warn_without_scene(FrameContext& frame, const Params& params) {
    if (frame.layers.scene || told_ || !std::ranges::any_of(params.light.lamps, &Lamp::room))
      return;
    told_ = true;
    frame.warnings.emplace_back(
        "lamps with \"room\":true stand in a remembered scene, but frames come without one: these "
        "lamps give no light; use a source with depth, and a decomposer with scene::remember=true");
  }

  Parameters<Params> parameters_{table()};
  LampEditor editor_;
  Extent extent_{};
  std::shared_ptr<const SurfaceFile> file_;
  std::vector<std::string> warnings_;
  bool told_ = false;  // that a scene is missing
  std::optional<Relight> relight_;
  std::optional<LampViews> views_;
  gpu::FrameRing<bool> adds_in_room_{};
  gpu::FrameRing<float> plane_depths_{};
};

LampEditor& editor_of(Filter& filter) { return static_cast<RelightElement&>(filter).editor(); }

std::vector<Action> lamp_actions() {
  return {edit_action<editor_of, &LampEditor::add>("add-lamp"),
          edit_action<editor_of, &LampEditor::remove>("remove-lamp"),
          edit_action<editor_of, &LampEditor::clear>("clear-lamps")};
}

}  // namespace

extern const ElementInfo kIntrinsicRelight;
const ElementInfo kIntrinsicRelight{
    .factory = "intrinsicrelight",
    .type_name = "GstIntrinsicRelight",
    .long_name = "Intrinsic relight",
    .klass = "Filter/Video",
    .description = "Adds lamps to a scene: point, spot and directional",
    .sink = Flow::layers_or_pixels,
    .src = Flow::layers,
    .layers = kAnyLayers,
    .needs = "intrinsicdecomp",
    .create = [] { return std::unique_ptr<Filter>(new RelightElement); },
    .actions = lamp_actions(),
    .navigation = true,
};

}  // namespace inverse
