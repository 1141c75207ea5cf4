// SPDX-License-Identifier: LGPL-2.1-or-later
// intrinsicrecolor: replaces one reflectance color.
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "gst/base/color.hpp"
#include "gst/base/filter.hpp"
#include "gst/edit/picker.hpp"
#include "kernels/edit/recolor.hpp"

namespace inverse {
namespace {

/// What a click on the picture sets.
enum class Pick { off, key, target };

struct Params : RecolorParams {
  uint32_t key_color = 0;              ///< 0: none
  uint32_t target_color = 0xff2864c8;  ///< 0: none
  Pick pick = Pick::off;
};

const PropertyTable<Params>& table() {
  using P = Params;
  static const PropertyTable<P> table{
      color<P>("key", &P::key_color,
               "Reflectance of the surface to recolor (0xAARRGGBB, sRGB; alpha is ignored); for a "
               "gray also lower value-tolerance; 0 = none: what the mask layer selects"),
      number<P>("tolerance", &P::tolerance, 0, 4.25F,
                "Maximum distance of chromaticity R / mean(R) from the key's; gray is 2.45 from a "
                "pure primary"),
      number<P>("value-tolerance", &P::value_tolerance, 0, P::kAnyValue,
                "Maximum distance of mean reflectance from the key's, |ln ratio|: 0.7 is a factor "
                "of two; 20 = any"),
      number<P>("softness", &P::softness, 0, 3,
                "Distance beyond the tolerances over which the selection falls to 0, in their "
                "units; 0 = hard edges"),
      number<P>(
          "base-color", &P::base, P::kByKey, static_cast<int>(kMaxBases) - 1,
          "Recolor the surfaces of this base color of globalintrinsic; -1 = by cluster or key"),
      number<P>("cluster", &P::cluster, P::kByKey, static_cast<int>(Palette::kMaxClusters) - 1,
                "Recolor the pixels nearest to this reflectance cluster of stats; -1 = by key"),
      number<P>("clusters", &P::clusters, 1, static_cast<int>(Palette::kMaxClusters),
                "Number of clusters to search for, if cluster is not -1"),
      color<P>(
          "target", &P::target_color,
          "Reflectance that replaces the surface's mean (0xAARRGGBB, sRGB; alpha is ignored); 0 = "
          "keep its colors, for hue-shift"),
      number<P>("hue-shift", &P::hue_shift, -180.F, 180.F,
                "Angle by which the new color's hue is turned, degrees"),
      number<P>("texture", &P::texture, 0, 1,
                "Share of the surface's own variation of brightness to keep: 0 = flat paint, 1 = "
                "all of it"),
      number<P>("brightness", &P::brightness, 0, 1,
                "Share of the surface's mean brightness to keep: 1 = target changes hue and "
                "saturation only"),
      number<P>("strength", &P::strength, 0, 1,
                "Share of the change of color; 0 = layers pass through unchanged"),
      flag<P>("use-mask", &P::use_mask,
              "Multiply the selection by the mask layer if the frame has one"),
      flag<P>("write-mask", &P::write_mask,
              "Write the selection to the mask layer, for later editors and show=mask"),
      choice<P>("pick", &P::pick, "GstInverseRecolorPick",
                {{static_cast<int>(Pick::off), "off", "Nothing"},
                 {static_cast<int>(Pick::key), "key", "The color to replace"},
                 {static_cast<int>(Pick::target), "target", "The color that replaces it"}},
                "What a click on the picture sets, to the reflectance there"),
  };
  return table;
}

class RecolorElement final : public Filter {
 public:
  PropertyStore& parameters() override { return parameters_; }

  void configure(const std::shared_ptr<gpu::Device>& device, Extent extent) override {
    recolor_.emplace(device, extent);
    picker_.configure(device);
    for (auto& copy : copies_)
      copy.colors = gpu::Buffer::create(device, gpu::Element::vec4, 2 * Palette::kMaxClusters,
                                        gpu::Memory::readback);
  }
  void release() override {
    recolor_.reset();
    picker_.release();
    copies_ = {};
    reported_ = false;
  }
  void reset() override { recolor_->reset(); }
  std::vector<Setting> navigate(const MouseEvent& event) override {
    picker_.navigate(event);
    return {};
  }
  void flushed() override { picker_.forget(); }

  void process(FrameContext& frame) override {
    Params params = parameters_.snapshot();
    params.by_mask = params.key_color == 0 && params.base < 0 && params.cluster < 0;
    params.own_color = params.target_color == 0;
    params.key = linear_color(params.key_color);
    params.target = linear_color(params.target_color);
    picker_.record(frame, params.pick == Pick::key      ? "key"
                          : params.pick == Pick::target ? "target"
                                                        : nullptr);
    if (params.by_mask && !frame.layers[Role::mask] && params.strength > 0 &&
        !std::exchange(reported_mask_, true))
      frame.warnings.push_back(
          "nothing is selected; set key, cluster or base-color, or put intrinsicselect before it");
    // Frames in black and white have no base colors either, but others of that video may.
    if (params.base >= 0 && !frame.layers[Role::bases] && !frame.layers.global() &&
        !std::exchange(reported_, true))
      frame.warnings.push_back("base-color=" + std::to_string(params.base) +
                               " selects nothing, as this video comes without base colors; put "
                               "globalintrinsic or globalintrinsicthesis in the place of the "
                               "decomposer before it, or recolor by key or cluster");
    if (params.base < 0 && params.cluster >= params.clusters &&
        std::exchange(reported_cluster_, params.cluster) != params.cluster)
      frame.warnings.push_back("cluster=" + std::to_string(params.cluster) +
                               " of clusters=" + std::to_string(params.clusters) +
                               " selects nothing: clusters are counted from 0; raise clusters, or "
                               "choose one that stats list");
    const uint32_t before = frame.commands.dispatches();
    recolor_->record(frame.commands, frame.layers, params);
    const bool worked = frame.commands.dispatches() > before;
    Copy& copy = copies_[frame.number];
    copy.clusters = worked && params.base < 0 && params.cluster >= 0
                        ? recolor_->palette()->params().clusters
                        : 0;
    if (copy.clusters)
      frame.commands.copy(recolor_->palette()->colors(), copy.colors, copy.colors->bytes());
    if (worked) frame.commands.stage("recolor");
  }

  void completed(uint64_t number, double) override { picker_.completed(number, log().object); }

  void describe(GstStructure* stats, uint64_t number) const override {
    const Copy& copy = copies_[number];
    if (!copy.clusters) return;
    GValue list = G_VALUE_INIT;
    gst_value_array_init(&list, Palette::kMaxClusters);
    for (const auto& cluster : Palette::read(copy.colors->map_as<float>(), copy.clusters)) {
      GValue entry = G_VALUE_INIT;
      g_value_init(&entry, G_TYPE_UINT);
      std::array<float, 3> linear{};
      for (size_t c = 0; c < 3; ++c) linear[c] = std::exp(cluster.log_color[c]);
      g_value_set_uint(&entry, cluster.index < 0 ? 0 : srgb_color(linear));
      gst_value_array_append_and_take_value(&list, &entry);
    }
    gst_structure_take_value(stats, "clusters", &list);
  }

 private:
  Parameters<Params> parameters_{table()};
  std::optional<Recolor> recolor_;
  Picker picker_;
  bool reported_mask_ = false;  // that there is no mask
  bool reported_ = false;       // that there are no base colors
  int reported_cluster_ = -1;   // that is beyond the last one
  /// The clusters of a frame, for its stats.
  struct Copy {
    gpu::BufferPtr colors;
    int clusters = 0;
  };
  gpu::FrameRing<Copy> copies_;
};

}  // namespace

extern const ElementInfo kIntrinsicRecolor;
const ElementInfo kIntrinsicRecolor{
    .factory = "intrinsicrecolor",
    .type_name = "GstIntrinsicRecolor",
    .long_name = "Intrinsic recolor",
    .klass = "Filter/Video",
    .description = "Replaces one reflectance color; shading is kept",
    .sink = Flow::layers_or_pixels,
    .src = Flow::layers,
    .layers = kAnyLayers,
    .needs = "intrinsicdecomp",
    .create = [] { return std::unique_ptr<Filter>(new RecolorElement); },
    .navigation = true,
};

}  // namespace inverse
