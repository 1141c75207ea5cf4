// SPDX-License-Identifier: LGPL-2.1-or-later
// olatrelight: a subject from a light stage, lit by any environment (thesis chapter 7).
#include <gst/gst.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <future>
#include <mutex>
#include <optional>
#include <utility>

#include "common/background.hpp"
#include "gst/base/filter.hpp"
#include "gst/base/models.hpp"
#include "gst/exr/environment_file.hpp"
#include "gst/inverse/inverse_light_stage_meta.h"
#include "gst/lightstage/sync/shared/upstream.hpp"
#include "kernels/image/view/mosaic.hpp"
#include "kernels/lightstage/gray_gradients.hpp"
#include "kernels/lightstage/program/light_program.hpp"
#include "kernels/lightstage/relighting.hpp"
#include "side_by_side.hpp"

namespace inverse {
namespace {

enum class RelightShow { relit, olat, mosaic, normal, full_on };

struct Params : Relighting::Params {
  RelightShow show = RelightShow::relit;
  std::string program = "performance", environment, models;
  std::array<float, 3> light{0.5F, 0.5F, 0.7F};
};

/// light-direction: three numbers, in one text.
std::string text_of_light(const std::array<float, 3>& light) {
  char text[64];
  snprintf(text, sizeof(text), "%g,%g,%g", double{light[0]}, double{light[1]}, double{light[2]});
  return text;
}
void write_light(std::array<float, 3>& light, const char* text) {
  std::array<float, 3> read{};
  char rest = 0;
  if (sscanf(text, " %f , %f , %f %c", &read[0], &read[1], &read[2], &rest) == 3 &&
      std::all_of(read.begin(), read.end(), [](float v) { return std::fabs(v) <= 1e6F; }))
    light = read;
  else
    g_warning("light-direction \"%s\" is not three numbers with commas between; it stays as it was",
              text);
}

const PropertyTable<Params>& table() {
  using P = Params;
  static const PropertyTable<P> table{
      choice<P>(
          "show", &P::show, "GstInverseRelightShow",
          {{static_cast<int>(RelightShow::relit), "relit", "The subject under the environment"},
           {static_cast<int>(RelightShow::olat), "olat",
            "The subject under one light at light-direction, a quarter as bright as the whole "
            "stage"},
           {static_cast<int>(RelightShow::mosaic), "mosaic",
            "All lights on, directions, one light and relit at half size, side by side"},
           {static_cast<int>(RelightShow::normal), "normal",
            "Mean direction of the light that each pixel reflects, as a normal map: RGB = xyz"},
           {static_cast<int>(RelightShow::full_on), "full-on",
            "The subject under all lights: gradient A + gradient B"}},
          "Picture to show"),
      choice<P>("model", &P::model, "GstInverseRelightModel",
                {{static_cast<int>(Relighting::Model::cosine_lobe), "cosine-lobe",
                  "One reflection lobe per pixel, from the gradients: fast, no shadows"},
                 {static_cast<int>(Relighting::Model::network), "network",
                  "A network trained on heads: with shadows and highlights"}},
                "Method that predicts the picture under one light", Mutable::ready),
      text<P>(
          "models", &P::models,
          "Folder with a folder olat of networks; empty = INVERSE_MODELS, else the installed ones",
          Mutable::ready),
      text<P>("program", &P::program,
              "Light program with the positions of the lights: a JSON file, or performance[:N] or "
              "static[:N]",
              Mutable::ready),
      text<P>("environment-location", &P::environment,
              "Radiance (.hdr) or OpenEXR panorama to light the subject with; empty = a neutral "
              "studio"),
      number<P>("environment-rotation", &P::rotation, -360, 360,
                "Rotation of the environment about the vertical in degrees, positive to the right"),
      number<P>("exposure", &P::exposure, -10, 10, "Brightness of all light, in stops"),
      text_for<P, text_of_light, write_light>(
          "light-direction", &P::light,
          "Direction of the light of show=olat: x,y,z (right, up, to the camera); also set by "
          "dragging the mouse"),
      number<P>(
          "light-x", [](P& p) -> float& { return p.light[0]; }, -1e6F, 1e6F,
          "x of light-direction: to the right"),
      number<P>(
          "light-y", [](P& p) -> float& { return p.light[1]; }, -1e6F, 1e6F,
          "y of light-direction: up"),
      number<P>(
          "light-z", [](P& p) -> float& { return p.light[2]; }, -1e6F, 1e6F,
          "z of light-direction: to the camera"),
      tuning(number<P>(
          "noise", [](P& p) -> float& { return p.lobe.noise; }, 1e-6F, 1,
          "Linear light of A + B (1 = full scale) below which directions are not used")),
      tuning(number<P>("max-error", &P::max_error, 0, 1,
                       "Target for the relative error that skipped lights add; 0 = all lights")),
      flag<P>("adaptive", &P::adaptive,
              "Skip lights within max-error and repeated frames; turn off to compare"),
  };
  return table;
}

class RelightElement final : public Filter {
 public:
  PropertyStore& parameters() override { return parameters_; }
  bool compares_frames() const override { return parameters_.snapshot().adaptive; }
  std::span<const char* const> shows_frame() const override {
    static constexpr std::array kFrames{"relit", "olat", "full-on"};
    return kFrames;
  }
  bool takes_view(std::string_view layer) const override { return layer == kGradientsView; }

  void start() override {
    const Params params = parameters_.snapshot();
    if (!stage_ || params.program != program_) {
      const LightProgram program = light_program(params.program);
      std::vector<Direction> lights;
      for (const StageLight& light : program.lights) lights.push_back(light.direction);
      stage_ = std::make_shared<const RelightStage>(std::move(lights));
      gradient_ = program.colors(LightStep{StepKind::gradient_a, 0, {}, {}, {}});
      program_ = params.program;
      GST_CAT_INFO_OBJECT(log().category, log().object, "light program \"%s\": %s",
                          program_.c_str(), program.name.c_str());
    }
    reported_stage_ = reported_gray_ = checked_source_ = false;
    model_ = params.model;
    models_.reset();  // files may be others
    if (model_ == Relighting::Model::network) {
      const std::string folder = models_folder(params.models, "olat");
      models_ = RelightModels::load(folder);
      GST_CAT_INFO_OBJECT(log().category, log().object, "read networks of %s", folder.c_str());
    }
    loading_ = {};
    asked_ = params.environment;
    use(load(asked_));
  }

  void check_plain(const GstVideoInfo& in, const GstVideoInfo& out) const override {
    check_side_by_side("olatrelight", in, out);
  }
  void configure(const std::shared_ptr<gpu::Device>& device, Extent extent) override {
    const bool network = model_ == Relighting::Model::network;
    method_.emplace(device, extent, stage_, network ? &*models_ : nullptr);
    method_->set_environment(map_);
    mosaic_.emplace(device);
    planes_.emplace(device, extent);
    picture_ = nullptr;
    {
      std::lock_guard lock(mouse_mutex_);
      extent_ = extent;
    }
  }
  void release() override {
    picture_ = nullptr;
    last_a_ = last_b_ = nullptr;
    method_.reset();
    mosaic_.reset();
    planes_.reset();
  }
  void reset() override {
    picture_ = nullptr;
    last_a_ = last_b_ = nullptr;
    method_->forget();
  }

  std::vector<Setting> navigate(const MouseEvent& event) override {
    const auto [kind, x, y] = event;
    std::vector<Setting> light;
    std::lock_guard lock(mouse_mutex_);
    if (kind == MouseEvent::Kind::press) held_ = parameters_.snapshot().show == RelightShow::olat;
    if (held_ && extent_.pixels() > 0 && std::isfinite(x) && std::isfinite(y)) {
      // The picture is a sphere's half that faces the camera; beyond its rim lights are beside it.
      const double side = std::min(extent_.width, extent_.height);
      double across = (2 * x - extent_.width) / side, up = (extent_.height - 2 * y) / side;
      const double r = std::hypot(across, up);
      if (r > 1) {
        across /= r;
        up /= r;
      }
      light = {{"light-x", across},
               {"light-y", up},
               {"light-z", std::sqrt(std::max(0.0, 1 - across * across - up * up))}};
    }
    if (kind == MouseEvent::Kind::release) held_ = false;
    return light;
  }

  void process(FrameContext& frame) override {
    Params params = parameters_.snapshot();
    params.model = model_;
    check_colors(frame);
    take_environment(frame, params);
    check_label(frame);
    take_pair(frame, params);
    const bool same = params.adaptive && picture_ && shown_ && alike(*shown_, params) &&
                      method_->version() == version_;
    if (same) {
      frame.same_picture = true;
    } else {
      picture_ = planes_->acquire();
      draw(frame.commands, params, *picture_);
      drawn_ = method_->stats();
    }
    shown_ = params;
    version_ = method_->version();
    Report& report = reports_[frame.number];
    report = {drawn_, same};
    report.stats.fitted = method_->stats().fitted;
    frame.picture = {picture_};
    // Another thread may reuse the planes that came in, once they are released.
    frame.commands.keep(std::make_shared<Layers>(std::move(frame.layers)));
    frame.layers = {picture_->extent, {}};
    frame.layers[Role::input] = picture_;  // for its alpha
  }

  void describe(GstStructure* stats, uint64_t number) const override {
    const auto& [report, repeated] = reports_[number];
    gst_structure_set(stats, "environment", G_TYPE_STRING, environment_name_.c_str(), "lights",
                      G_TYPE_UINT64, report.lights, "lit", G_TYPE_UINT64, report.lit, "evaluated",
                      G_TYPE_UINT64, report.evaluated, "expected-error", G_TYPE_DOUBLE,
                      report.expected_error, "environment-shown", G_TYPE_DOUBLE, report.shown,
                      "fitted", G_TYPE_BOOLEAN, report.fitted, "reused", G_TYPE_BOOLEAN, repeated,
                      "largest-exponent", G_TYPE_DOUBLE, stage_->moments->largest_exponent(),
                      "network-bytes", G_TYPE_UINT64, method_ ? method_->network_bytes() : 0,
                      nullptr);
  }

 private:
  struct Report {
    Relighting::Stats stats;
    bool repeated = false;
  };

  /// Whether two sets of parameters make the same of the same picture.
  static bool alike(const Params& a, const Params& b) {
    return a.show == b.show && a.light == b.light && a.rotation == b.rotation &&
           a.exposure == b.exposure && a.max_error == b.max_error && a.adaptive == b.adaptive;
  }

  /// Light that was read from a file.
  struct Light {
    LightCells::Map map;
    std::string path, warning;
  };
  /// From any thread.
  static Light load(const std::string& path) {
    Light light{{}, path, ""};
    light.map = LightCells::map(path.empty() ? Environment::studio()
                                             : load_environment(path, light.warning));
    return light;
  }
  void use(Light light) {
    map_ = std::move(light.map);
    environment_path_ = light.path;
    environment_name_ = light.path.empty() ? "studio" : light.path;
    GST_CAT_INFO_OBJECT(log().category, log().object, "light: %s", environment_name_.c_str());
    if (!light.warning.empty()) pending_warning_ = light.warning;
    if (method_) method_->set_environment(map_);
  }

  /// Another file while playing, which another thread reads: frames go on under the light before.
  /// One that cannot be read is reported once, and the light stays.
  void take_environment(FrameContext& frame, const Params& params) {
    if (loading_.valid() && loading_.wait_for(std::chrono::seconds(0)) == std::future_status::ready)
      try {
        Light light = loading_.get();
        if (light.path == params.environment) use(std::move(light));
      } catch (const Error& error) {
        frame.warnings.push_back(std::string(error.what()) + "; the light before stays");
      }
    if (!loading_.valid() && params.environment != asked_) {
      asked_ = params.environment;
      if (asked_ != environment_path_)
        loading_ = in_background([path = asked_] { return load(path); });
    }
    if (pending_warning_) frame.warnings.push_back(*std::exchange(pending_warning_, {}));
  }

  /// Layers were checked by the element that made them.
  void check_colors(FrameContext& frame) {
    if (!frame.gray || reported_gray_) return;
    reported_gray_ = true;
    frame.warnings.emplace_back(kGrayGradients);
  }

  /// Checks that the frame's label is that of a pair, from this stage.
  void check_label(FrameContext& frame) {
    const GstLightStageMeta* meta = frame.in ? gst_buffer_get_light_stage_meta(frame.in) : nullptr;
    if (!meta) return check_source(frame);
    if (meta->kind != GST_LIGHT_STAGE_GRADIENTS)
      throw Error(ErrorKind::unsupported,
                  "frames show one step of a light program each, not the two gradients; set "
                  "assemble=pairs on lightstagesync");
    if (reported_stage_ || lit_by_this_stage(*meta)) return;
    reported_stage_ = true;
    frame.warnings.push_back("frames were lit by " + std::to_string(meta->lights) +
                             " lights that are not where the " + std::to_string(gradient_.size()) +
                             " of \"" + program_ +
                             "\" are; set program to the one that lightstagesync has");
  }

  /// Plain frames without a label may be pairs from a file, but not what a stage's camera sends.
  void check_source(FrameContext& frame) {
    if (frame.layers.gradients() || std::exchange(checked_source_, true)) return;
    GstPad* sink = gst_element_get_static_pad(log().object, "sink");
    GstElement* source = upstream_element(sink, sends_single_frames_or_mixes);
    gst_object_unref(sink);
    if (!source) return;
    if (sends_single_frames(source))
      frame.warnings.push_back(
          std::string("frames of ") + GST_OBJECT_NAME(source) +
          " show one pattern of the lights each, and are taken for the two gradients side by "
          "side: put lightstagesync assemble=pairs before this element");
    gst_object_unref(source);
  }
  static bool sends_single_frames(GstElement* element) {
    constexpr std::array kNames{"lightstagetestsrc", "lightstagearavissrc", "lightstagesync"};
    const GstElementFactory* factory = gst_element_get_factory(element);
    return factory && std::ranges::any_of(kNames, [&](const char* name) {
             return g_str_equal(GST_OBJECT_NAME(factory), name);
           });
  }
  /// What mixes several streams may put pictures side by side.
  static bool sends_single_frames_or_mixes(GstElement* element) {
    return element->numsinkpads > 1 || sends_single_frames(element);
  }

  /// Gradients give the directions of lights.
  bool lit_by_this_stage(const GstLightStageMeta& meta) const {
    if (meta.lights != gradient_.size() || !meta.colors) return false;
    gsize size = 0;
    const auto* colors = static_cast<const float*>(g_bytes_get_data(meta.colors, &size));
    if (size != gradient_.size() * sizeof(LightColor)) return false;
    const float* ours = gradient_.front().data();
    for (size_t i = 0; i < 3 * gradient_.size(); ++i)
      if (std::abs(colors[i] - ours[i]) > 1e-3F) return false;
    return true;
  }

  void take_pair(FrameContext& frame, const Params& params) {
    const bool layers = frame.layers.gradients();
    const PlanePtr a = layers ? frame.layers[Role::gradient_a] : frame.layers[Role::input];
    const PlanePtr b = layers ? frame.layers[Role::gradient_b] : a;
    const Extent extent = planes_->extent();
    const uint32_t second = layers ? 0 : extent.width;
    if (!a || a->extent.height != extent.height || a->extent.width != extent.width + second ||
        b->extent != a->extent)
      throw Error(
          ErrorKind::unsupported,
          "the size of the two gradients does not match the caps; fix the element that sent "
          "them");
    // Planes that are held are not written to: the same ones hold the same picture.
    const bool again =
        !frame.fresh && params.adaptive && (layers ? a == last_a_ && b == last_b_ : frame.repeated);
    last_a_ = layers ? a : nullptr;
    last_b_ = layers ? b : nullptr;
    const bool lit = params.show != RelightShow::normal && params.show != RelightShow::full_on;
    method_->record_pair(frame.commands, {*a, *b, second}, params, frame.number, again, lit);
  }

  static Direction light_of(const Params& params) {
    const auto& l = params.light;
    const double length = std::hypot(double{l[0]}, double{l[1]}, double{l[2]});
    if (!(length > 0)) return {0, 0, 1};
    return {l[0] / length, l[1] / length, l[2] / length};
  }

  void draw(gpu::Commands& commands, const Params& params, const Plane& target) {
    const CosineLobe& lobes = method_->lobes();
    switch (params.show) {
      case RelightShow::relit:
        return method_->record_relit(commands, params, target);
      case RelightShow::olat:
        return method_->record_olat(commands, params, light_of(params), target);
      case RelightShow::normal:
        return lobes.record_directions(commands, params.lobe, target);
      case RelightShow::full_on:
        return commands.copy(lobes.full()->buffer, target.buffer, target.buffer->bytes());
      case RelightShow::mosaic: {
        const PlanePtr directions = planes_->acquire(), one = planes_->acquire(),
                       all = planes_->acquire();
        lobes.record_directions(commands, params.lobe, *directions);
        method_->record_relit(commands, params, *all);
        method_->record_olat(commands, params, light_of(params), *one);
        mosaic_->record(commands,
                        {{{lobes.full().get()}, {directions.get()}, {one.get()}, {all.get()}}},
                        target);
        return;
      }
    }
  }

  Parameters<Params> parameters_{table()};
  std::string program_;
  std::vector<LightColor> gradient_;  // of the program's lights
  bool reported_stage_ = false, reported_gray_ = false, checked_source_ = false;
  std::shared_ptr<const RelightStage> stage_;
  Relighting::Model model_{};  // that it was started with, whatever is set since
  std::optional<RelightModels> models_;
  LightCells::Map map_;
  std::string environment_path_, environment_name_ = "studio";
  std::string asked_;  // the environment that was last asked for, and perhaps could not be read
  std::future<Light> loading_;  // valid while a file is read
  std::optional<std::string> pending_warning_;

  std::optional<Relighting> method_;
  std::optional<Mosaic> mosaic_;
  std::optional<PlanePool> planes_;

  // Of the frame before.
  PlanePtr picture_, last_a_, last_b_;
  std::optional<Params> shown_;
  uint64_t version_ = 0;
  Relighting::Stats drawn_;
  gpu::FrameRing<Report> reports_;

  std::mutex mouse_mutex_;
  Extent extent_;
  bool held_ = false;  // the mouse's button is down
};

}  // namespace

extern const ElementInfo kOlatRelight;
const ElementInfo kOlatRelight{
    .factory = "olatrelight",
    .type_name = "GstOlatRelight",
    .long_name = "Light stage relighting",
    .klass = "Filter/Effect/Video",
    .description =
        "Relights a subject lit by two color gradients of a light stage: by "
        "an environment map, or by one light from any direction",
    .sink = Flow::layers_or_pixels,
    .src = Flow::pixels,
    .layers = kGradientLayers,
    .needs = "lightstagesync",
    .create = [] { return std::unique_ptr<Filter>(new RelightElement); },
    .navigation = true,
    .accepts = kGradientLayers,
    .plain_caps = transform_side_by_side,
};

}  // namespace inverse
