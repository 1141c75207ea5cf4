// SPDX-License-Identifier: LGPL-2.1-or-later
// limematerial: the material of the object in front of the camera (thesis chapter 6).
#include <gst/gst.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <optional>
#include <utility>

#include "gst/base/filter.hpp"
#include "gst/base/models.hpp"
#include "gst/material/meta/material_meta.hpp"
#include "kernels/image/view/mosaic.hpp"
#include "kernels/material/lime_material.hpp"
#include "kernels/material/preview/material_preview.hpp"
#include "material_properties.hpp"

namespace inverse {
namespace {

enum class LimeShow { input, mask, specular, diffuse, mirror, mosaic, preview };
/// Where the light's normals come from when there is no normal map.
enum class LightNormals { none, silhouette };

struct Params : LimeMaterial::Params {
  LimeShow show = LimeShow::diffuse;
  std::string models;
  bool measure_light = false;
  LightNormals normals = LightNormals::silhouette;
  std::string normal_map, environment_location;
  float preview_size = 0.3F;

  bool asks_for_light() const {
    return measure_light || show == LimeShow::preview || !environment_location.empty();
  }
};

const PropertyTable<Params>& table() {
  using P = Params;
  static const PropertyTable<P> table{
      choice<P>("show", &P::show, "GstInverseLimeShow",
                {{static_cast<int>(LimeShow::input), "input", "The frame as it came in"},
                 {static_cast<int>(LimeShow::mask), "mask", "Mask of the object, as gray"},
                 {static_cast<int>(LimeShow::specular), "specular",
                  "Highlights of the object, as gray; tinted where the input is clipped"},
                 {static_cast<int>(LimeShow::diffuse), "diffuse",
                  "The frame without the object's highlights"},
                 {static_cast<int>(LimeShow::mirror), "mirror",
                  "Reflection by a mirror of the object's shape and specular albedo, as gray"},
                 {static_cast<int>(LimeShow::mosaic), "mosaic",
                  "Input, diffuse, specular and mirror at half size, side by side"},
                 {static_cast<int>(LimeShow::preview), "preview",
                  "The frame, with a sphere of the object's material in the bottom right corner"}},
                "Layer to show as ordinary video; elements that take layers get all of them"),
      number<P>("preview-size", &P::preview_size, 0.02F, 1,
                "Diameter of the sphere of show=preview, relative to the frame's shorter side"),
      text<P>(
          "models", &P::models,
          "Folder with a folder lime of networks; empty = INVERSE_MODELS, else the installed ones",
          Mutable::ready),
      number<P>(
          "memory", [](P& p) -> uint32_t& { return p.fusion.memory; }, 1, 100000,
          "Maximum number of frames to average the material over; lower it if the camera turns"),
      tuning(number<P>(
          "new-object-distance", [](P& p) -> float& { return p.fusion.new_object_distance; }, 0, 1,
          "Albedo difference (linear) over five frames that restarts averaging")),
      flag<P>("adaptive", &P::adaptive,
              "Skip networks and drawing if object or picture stay the same"),
      tuning(number<P>("estimate-interval", &P::estimate_interval, 1, 1000,
                       "Frames between new estimates for an object at rest")),
      flag<P>("estimate-light", &P::measure_light,
              "Estimate the light around the object, for materialclone and save-environment"),
      choice<P>(
          "normals", &P::normals, "GstInverseLightNormals",
          {{static_cast<int>(LightNormals::none), "none", "None: light needs normal-map"},
           {static_cast<int>(LightNormals::silhouette), "silhouette",
            "Inflated from the object's outline: exact for spheres, approximate for other round "
            "objects"}},
          "Source of the surface normals for the light if there is no normal-map"),
      text<P>("normal-map", &P::normal_map,
              "PNG file of the normals in the frame: RGB = xyz from -1 to 1, z to the camera",
              Mutable::ready),
      text<P>("save-environment-location", &P::environment_location,
              "Radiance file (.hdr) to write the estimated light to at the end; empty = none",
              Mutable::ready),
      tuning(number<P>("converged-error", &P::converged_error, 0, 1,
                       "Standard error of a material below which estimates pause")),
  };
  return table;
}

class LimeElement final : public Filter {
 public:
  PropertyStore& parameters() override { return parameters_; }
  bool compares_frames() const override { return parameters_.snapshot().adaptive; }
  bool needs_square_pixels() const override { return true; }
  std::span<const char* const> shows_frame() const override {
    static constexpr std::array kFrames{"input", "preview"};
    return kFrames;
  }
  bool takes_view(std::string_view) const override { return false; }

  void start() override {
    const Params params = parameters_.snapshot();
    const std::string folder = models_folder(params.models, "lime");
    models_ = LimeModels::load(folder);  // files may be others
    GST_CAT_INFO_OBJECT(log().category, log().object, "read networks of %s", folder.c_str());
    if (!params.environment_location.empty())
      Environment::check_target(params.environment_location);
    {
      std::lock_guard lock(light_mutex_);
      light_ = nullptr;
      at_start_ = params;
    }
    warnings_.clear();
    bare_ = false;
    normal_map_ = nullptr;
    if (!params.normal_map.empty()) {
      std::string warning;
      normal_map_ = std::make_shared<const NormalMap>(NormalMap::load(params.normal_map, warning));
      if (!warning.empty()) warnings_.push_back(warning);
      GST_CAT_INFO_OBJECT(log().category, log().object, "read normals of %s",
                          params.normal_map.c_str());
    }
    reported_.reset();
    written_ = true;  // until there is a frame
  }

  void configure(const std::shared_ptr<gpu::Device>& device, Extent extent) override {
    extent_ = extent;
    device_ = device;
    method_.emplace(device, extent, *models_);
    method_->set_normal_map(normal_map_);
    mosaic_.emplace(device);
    planes_.emplace(device, extent);
    const MaterialPreview preview(device);  // its kernels stay with the device, for a later frame
    publish();
  }
  void release() override {
    held_.reset();
    method_.reset();
    mosaic_.reset();
    preview_.reset();
    published_light_ = nullptr;
    light_bytes_.reset();
    planes_.reset();
    device_.reset();
    parameters_.publish(std::nullopt);
  }
  void reset() override {
    held_.reset();
    method_->reset();
    preview_.reset();  // what was recorded of it may not have been computed
    publish();
  }
  void ended() override {
    const Params params = this->params();
    if (params.environment_location.empty() || written_) return;
    written_ = true;
    save_environment(params.environment_location);
  }
  /// Writes the light found last; throws Error(output) if there is none. From any thread.
  void save_environment(const std::string& path) {
    std::shared_ptr<const Environment> light;
    {
      std::lock_guard lock(light_mutex_);
      light = light_;
    }
    if (path.empty()) throw Error(ErrorKind::output, "no file to write the light to was named");
    if (!light) {
      const Params params = this->params();
      throw Error(
          ErrorKind::output,
          path +
              " was not written, as there is no light yet: it takes an object whose material is "
              "known and normals " +
              (params.normal_map.empty() ? "(normals=silhouette or normal-map)"
                                         : "where it is in normal-map=" + params.normal_map) +
              (params.asks_for_light() ? "" : ", and estimate-light=true"));
    }
    light->save(path);
  }

  void process(FrameContext& frame) override {
    Params params = this->params();
    params.light_asked = params.asks_for_light();
    params.layers_asked =
        !frame.draw || (params.show != LimeShow::input && params.show != LimeShow::preview);
    params.light.inflate = params.normals == LightNormals::silhouette;
    params.light.fit.memory = params.fusion.memory;
    written_ = false;
    const PlanePtr input = frame.layers[Role::input];
    report_material(frame);
    warn(frame, params);
    const uint64_t number = method_->recorded();
    method_->record(frame.commands, *input, params, frame.repeated);
    frame.decorate = [object = method_->object(),
                      light = method_->light() ? light_bytes_ : nullptr](GstBuffer* buffer) {
      attach(buffer, object, light.get());
    };
    const State state{method_->message_count(), params.show, params.preview_size};
    const bool again = frame.repeated && held_ && held_->state == state;
    past_[frame.number] = {number, again};
    if (!again) {
      held_.reset();  // its planes may serve again
      held_ = {state, frame.draw ? picture(frame, params, input) : Picture{},
               frame.draw ? Layers{} : layers(frame, input)};
    }
    frame.picture = held_->picture;
    if (!frame.draw) frame.layers = held_->layers;
    frame.same_picture = again;
    if (!frame.keep_planes) held_.reset();
  }

  void completed(uint64_t number, double) override {
    method_->done(past(number).method);
    publish();
  }

  void describe(GstStructure* stats, uint64_t number) const override {
    const LimeMaterial::Report& report = method_->report(past(number).method);
    const bool asked = params().asks_for_light();
    gst_structure_set(stats, "skipped", G_TYPE_STRING, report.skipped, "reused", G_TYPE_BOOLEAN,
                      past(number).kept, "segmentations", G_TYPE_UINT64, report.segmentations,
                      "estimates", G_TYPE_UINT64, report.estimates, "light-views", G_TYPE_UINT64,
                      asked ? method_->light_views() : 0, "network-bytes", G_TYPE_UINT64,
                      method_->network_bytes(), nullptr);
    describe_object(stats, method_->object());
  }

 private:
  /// What the output depends on beside the frame: if a repeated frame has the same state, its
  /// output is reused.
  struct State {
    uint64_t message_count;
    LimeShow show;
    float preview_size;
    bool operator==(const State&) const = default;
  };
  /// What went out: a picture, or layers.
  struct Held {
    State state;
    Picture picture;
    Layers layers;
  };
  /// A frame that may be in flight: the method's number of it, and whether its output was reused.
  struct Past {
    uint64_t method = 0;
    bool kept = false;
  };
  const Past& past(uint64_t number) const { return past_[number]; }

  /// As they are now, but for files: as at the start.
  Params params() const {
    Params params = parameters_.snapshot();
    std::lock_guard lock(light_mutex_);
    if (!at_start_) return params;
    params.environment_location = at_start_->environment_location;
    params.normal_map = at_start_->normal_map;
    return params;
  }

  Layers layers(FrameContext& frame, const PlanePtr& input) {
    const LimeMaterial::Layers found = method_->record_layers(frame.commands, *input);
    return material_layers(input, found.diffuse, found.gloss);
  }

  Picture picture(FrameContext& frame, const Params& params, const PlanePtr& input) {
    if (params.show == LimeShow::preview) return preview(frame, params, input);
    if (params.show == LimeShow::input) return {input};
    const LimeMaterial::Layers layers = method_->record_layers(frame.commands, *input);
    switch (params.show) {
      case LimeShow::input:
      case LimeShow::preview:
      case LimeShow::diffuse:
        break;
      case LimeShow::mask:
        return {layers.diffuse, true};
      case LimeShow::specular:
        return {layers.gloss};
      case LimeShow::mirror:
        return {layers.gloss, true};
      case LimeShow::mosaic: {
        const PlanePtr tiles = planes_->acquire();
        mosaic_->record(frame.commands, quarters(*input, *layers.diffuse, *layers.gloss), *tiles);
        return {tiles};
      }
    }
    return {layers.diffuse};
  }

  Picture preview(FrameContext& frame, const Params& params, const PlanePtr& input) {
    if (!method_->object().known()) return {input};
    if (!preview_) preview_.emplace(device_);
    const PlanePtr with_sphere = planes_->acquire();
    preview_->record(frame.commands, *input, method_->object().material, method_->light(),
                     params.preview_size, *with_sphere);
    return {with_sphere};
  }

  /// The mosaic: what comes in, the light under the highlights, the highlights, the mirror image.
  static std::array<Mosaic::Tile, 4> quarters(const Plane& input, const Plane& diffuse,
                                              const Plane& gloss) {
    return {{{&input}, {&diffuse}, {&gloss}, {&gloss, Drawing::Source::shading}}};
  }

  static void describe_object(GstStructure* s, const LimeMaterial::Object& object) {
    gst_structure_set(s, "found", G_TYPE_BOOLEAN, object.found, nullptr);
    if (!object.found) return;
    const auto real = [](float v) { return static_cast<gdouble>(v); };
    const Material& m = object.material;
    gst_structure_set(
        s, "diffuse-red", G_TYPE_DOUBLE, real(m.diffuse[0]), "diffuse-green", G_TYPE_DOUBLE,
        real(m.diffuse[1]), "diffuse-blue", G_TYPE_DOUBLE, real(m.diffuse[2]), "specular",
        G_TYPE_DOUBLE, real(m.specular), "shininess", G_TYPE_DOUBLE, real(m.shininess()), "bin",
        G_TYPE_UINT, static_cast<guint>(m.bin()), "averaged", G_TYPE_UINT64, object.averaged,
        "spread", G_TYPE_DOUBLE, real(object.spread), "left", G_TYPE_DOUBLE, real(object.box.left),
        "top", G_TYPE_DOUBLE, real(object.box.top), "right", G_TYPE_DOUBLE, real(object.box.right),
        "bottom", G_TYPE_DOUBLE, real(object.box.bottom), nullptr);
  }

  static void attach(GstBuffer* buffer, const LimeMaterial::Object& object, GBytes* light) {
    if (GstMaterialMeta* old = gst_buffer_get_material_meta(buffer))
      gst_buffer_remove_meta(buffer, &old->meta);  // of a limematerial before this one
    GstMaterialMeta* meta = add_material_meta(buffer);
    meta->found = object.found;
    if (light) {
      meta->environment = g_bytes_ref(light);
      meta->environment_width = EnvironmentFit::kWidth;
      meta->environment_height = EnvironmentFit::kHeight;
    }
    if (!object.found) return;
    std::copy(object.material.diffuse.begin(), object.material.diffuse.end(), meta->diffuse);
    std::copy(object.material.bins.begin(), object.material.bins.end(), meta->bins);
    meta->specular = object.material.specular;
    meta->shininess = object.material.shininess();
    meta->averaged = object.averaged;
    meta->left = object.box.left;
    meta->top = object.box.top;
    meta->right = object.box.right;
    meta->bottom = object.box.bottom;
  }

  /// For the properties, which any thread may ask for.
  void publish() {
    const LimeMaterial::Object& object = method_->object();
    parameters_.publish(object.known() ? std::optional(object.material) : std::nullopt);
    const std::shared_ptr<const Environment>& light = method_->light();
    if (light == published_light_) return;
    published_light_ = light;
    light_bytes_.reset();
    if (!light) return;
    light_bytes_.reset(g_bytes_new(light->rgb().data(), light->rgb().size() * sizeof(float)),
                       g_bytes_unref);
    std::lock_guard lock(light_mutex_);
    light_ = light;
  }

  /// A message when an object comes or goes, and when its material differs from the reported one.
  void report_material(FrameContext& frame) {
    const LimeMaterial::Object& object = method_->object();
    const bool known = object.known();
    if (known == reported_.has_value() && (!known || near(object.material, *reported_))) return;
    if (known)
      reported_ = object.material;
    else
      reported_.reset();
    StructurePtr message(gst_structure_new_empty("material"));
    describe_object(message.get(), known ? object : LimeMaterial::Object{});
    frame.messages.push_back(std::move(message));
    frame.notify.insert(frame.notify.end(), kMaterialResults.begin(), kMaterialResults.end());
  }
  void warn(FrameContext& frame, const Params& params) {
    for (std::string& warning : std::exchange(warnings_, {}))
      frame.warnings.push_back(std::move(warning));
    if (!normal_map_ || !method_->lacks_normals() || std::exchange(bare_, true)) return;
    frame.warnings.push_back(
        params.normal_map +
        " has no normals where the object is, so that no light can be estimated; is it of this "
        "camera and this object?");
  }

  static bool near(const Material& a, const Material& b) {
    constexpr float kAlbedo = 0.02F, kOctaves = 0.25F;
    for (size_t c = 0; c < 3; ++c)
      if (std::fabs(a.diffuse[c] - b.diffuse[c]) > kAlbedo) return false;
    return std::fabs(a.specular - b.specular) <= kAlbedo &&
           std::fabs(std::log2(a.shininess() / b.shininess())) <= kOctaves;
  }

  MaterialProperties<Params> parameters_{table()};
  std::optional<LimeModels> models_;
  std::shared_ptr<const NormalMap> normal_map_;
  Extent extent_;
  std::optional<LimeMaterial> method_;
  std::optional<Mosaic> mosaic_;
  std::optional<MaterialPreview> preview_;
  std::optional<PlanePool> planes_;
  std::optional<Held> held_;  // of the frame before
  gpu::FrameRing<Past> past_;
  std::optional<Material> reported_;

  std::shared_ptr<gpu::Device> device_;
  std::shared_ptr<const Environment> published_light_;  // what the next two are of
  std::shared_ptr<GBytes> light_bytes_;                 // for metas
  std::vector<std::string> warnings_;                   // of the files, posted with the first frame
  bool bare_ = false;                                   // warned that the object has no normals
  mutable std::mutex light_mutex_;            // of what follows, up to the next blank line
  std::shared_ptr<const Environment> light_;  // the last one since the start, for files
  std::optional<Params> at_start_;

  bool written_ = true;  // nothing came since
};

}  // namespace

extern const ElementInfo kLimeMaterial;
const ElementInfo kLimeMaterial{
    .factory = "limematerial",
    .type_name = "GstLimeMaterial",
    .long_name = "Live material estimation",
    .klass = "Filter/Analyzer/Video",
    .description =
        "Estimates an object's material: diffuse and specular albedo, shininess, mask, highlights "
        "and "
        "mirror image",
    .sink = Flow::pixels,
    .src = Flow::pixels_or_layers,
    .layers = kMaterialLayers,
    .create = [] { return std::unique_ptr<Filter>(new LimeElement); },
    .actions = {{"save-environment",
                 {G_TYPE_STRING},
                 [](Filter& filter, const GValue* path) {
                   const char* name = g_value_get_string(path);
                   static_cast<LimeElement&>(filter).save_environment(name ? name : "");
                 },
                 true}},
};

}  // namespace inverse
