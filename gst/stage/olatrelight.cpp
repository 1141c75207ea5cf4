// olatrelight: a subject from a light stage, lit by any environment (thesis chapter 7).
#include <gst/gst.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <mutex>
#include <numbers>
#include <optional>
#include <utility>

#include "base/filter.hpp"
#include "environment_file.hpp"
#include "image/mosaic.hpp"
#include "light_stage/light_program.hpp"
#include "reflectance_field/cosine_lobe.hpp"

namespace inverse {
namespace {

enum class RelightShow { relit, olat, mosaic, normal, albedo };

struct Params {
  RelightShow show = RelightShow::relit;
  std::string program = "performance", environment;
  float rotation = 0, exposure = 0;
  std::array<float, 3> light{0.5F, 0.5F, 0.7F};
  bool adaptive = true;
  CosineLobe::Params lobe;
};

/// light-direction: three numbers, in one text.
Property<Params> direction_property() {
  using property_detail::named;
  Property<Params> property = named<Params>("light-direction", &Params::light);
  property.make_spec = [](const Params& defaults) {
    char text[64];
    snprintf(text, sizeof(text), "%g,%g,%g", double{defaults.light[0]}, double{defaults.light[1]},
             double{defaults.light[2]});
    return g_param_spec_string(
        "light-direction", "light direction",
        "Where the light of show=olat is, from the subject: x,y,z (x right, y up, z to the "
        "camera), of any length but 0. light-x, light-y and light-z are the same, one by one, for "
        "controllers; the mouse moves it while its first button is down",
        g_intern_string(text),
        static_cast<GParamFlags>(G_PARAM_READWRITE | G_PARAM_STATIC_STRINGS |
                                 GST_PARAM_MUTABLE_PLAYING));
  };
  property.read = [](const Params& from, GValue* to) {
    char text[64];
    snprintf(text, sizeof(text), "%g,%g,%g", double{from.light[0]}, double{from.light[1]},
             double{from.light[2]});
    g_value_set_string(to, text);
  };
  property.write = [](Params& to, const GValue* from) {
    const char* text = g_value_get_string(from);
    std::array<float, 3> light{};
    char rest = 0;
    if (text && sscanf(text, " %f , %f , %f %c", &light[0], &light[1], &light[2], &rest) == 3 &&
        std::all_of(light.begin(), light.end(), [](float v) { return std::fabs(v) <= 1e6F; }))
      to.light = light;
    else
      g_warning(
          "light-direction \"%s\" is not three numbers with commas between; it stays as it was",
          text ? text : "");
  };
  return property;
}

const PropertyTable<Params>& table() {
  using P = Params;
  static const PropertyTable<P> table{
      choice<P>(
          "show", &P::show, "GstInverseRelightShow",
          {{static_cast<int>(RelightShow::relit), "relit", "The subject under the environment"},
           {static_cast<int>(RelightShow::olat), "olat",
            "The subject under one light at light-direction, as bright as a quarter of the stage's "
            "lights together"},
           {static_cast<int>(RelightShow::mosaic), "mosaic",
            "All lights on, directions, one light and relit at half size, side by side"},
           {static_cast<int>(RelightShow::normal), "normal",
            "Mean direction of the light that each pixel gives back, as a normal map: RGB = xyz"},
           {static_cast<int>(RelightShow::albedo), "albedo",
            "The subject under all lights: gradient A + gradient B"}},
          "What to show"),
      text<P>("program", &P::program,
              "Light program of the stage, for where its lights are: a JSON file, or "
              "performance[:N] or static[:N] for N lights (331) of a geodesic dome",
              Mutable::ready),
      text<P>("environment", &P::environment,
              "Latitude-longitude map of the light to show the subject in: a Radiance (.hdr) or "
              "OpenEXR file, a panorama as seen from the subject, its middle towards the camera; "
              "empty = a neutral studio. Radiance 1 from everywhere is the stage with all lights "
              "on"),
      number<P>("rotation", &P::rotation, -360, 360,
                "Turn of the environment about the vertical in degrees; positive: what comes from "
                "the camera comes from the right"),
      number<P>("exposure", &P::exposure, -10, 10, "Brightness of all light, in stops"),
      direction_property(),
      number<P>(
          "light-x", [](P& p) -> float& { return p.light[0]; }, -1e6F, 1e6F,
          "x of light-direction: to the right"),
      number<P>(
          "light-y", [](P& p) -> float& { return p.light[1]; }, -1e6F, 1e6F,
          "y of light-direction: up"),
      number<P>(
          "light-z", [](P& p) -> float& { return p.light[2]; }, -1e6F, 1e6F,
          "z of light-direction: to the camera"),
      number<P>(
          "noise", [](P& p) -> float& { return p.lobe.noise; }, 1e-6F, 1,
          "Linear light of A + B, 1 = full scale, that is as good as noise: where there is no "
          "more, "
          "directions are not trusted and light is taken to be given back from everywhere"),
      flag<P>("adaptive", &P::adaptive,
              "Leave out what cannot be seen; false sums over all lights of the stage at every "
              "pixel"),
  };
  return table;
}

constexpr float kDegree = std::numbers::pi_v<float> / 180;

class RelightElement final : public Filter {
 public:
  PropertyStore& parameters() override { return parameters_; }
  bool looks_for_repeats() const override { return parameters_.snapshot().adaptive; }

  void start() override {
    const Params params = parameters_.snapshot();
    if (!stage_ || params.program != program_) {
      const LightProgram program = light_program(params.program);
      std::vector<Direction> lights;
      for (const StageLight& light : program.lights) lights.push_back(light.direction);
      moments_ = std::make_shared<const LobeMoments>(lights);
      stage_.emplace(std::move(lights));
      program_ = params.program;
    }
    load(params.environment);
  }

  void configure(const std::shared_ptr<gpu::Device>& device, Extent extent) override {
    lobe_.emplace(device, extent, moments_, stage_->lights());
    mosaic_.emplace(device);
    planes_.emplace(device, extent);
    forget();
    {
      std::lock_guard lock(mouse_mutex_);
      extent_ = extent;
    }
    if (device->first_warm_up("olatrelight")) warm_up(device);
  }
  void release() override {
    forget();
    lobe_.reset();
    mosaic_.reset();
    planes_.reset();
  }
  void reset() override { forget(); }

  void point(Mouse mouse, double x, double y) override {
    std::lock_guard lock(mouse_mutex_);
    if (mouse == Mouse::press) held_ = parameters_.snapshot().show == RelightShow::olat;
    if (held_ && extent_.pixels() > 0 && std::isfinite(x) && std::isfinite(y)) {
      // The picture is a sphere's half that faces the camera; beyond its rim lights are beside it.
      const double side = std::min(extent_.width, extent_.height);
      double across = (2 * x - extent_.width) / side, up = (extent_.height - 2 * y) / side;
      const double r = std::hypot(across, up);
      if (r > 1) {
        across /= r;
        up /= r;
      }
      set("light-x", across);
      set("light-y", up);
      set("light-z", std::sqrt(std::max(0.0, 1 - across * across - up * up)));
    }
    if (mouse == Mouse::release) held_ = false;
  }

  void process(FrameWork& frame) override {
    const Params params = parameters_.snapshot();
    Report& report = reports_[frame.number % reports_.size()] = {};
    take_environment(frame, params);
    const bool same_pair = take_pair(frame, params);
    report.fitted = !same_pair;

    const bool same_light = take_light(params);
    const bool same = same_pair && same_light && picture_ && shown_ &&
                      shown_->show == params.show && shown_->light == params.light &&
                      shown_->adaptive == params.adaptive;
    if (same) {
      frame.same_picture = true;
    } else {
      picture_ = planes_->acquire();
      draw(frame.commands, params, *picture_);
      frame.commands.stage("relight");
    }
    shown_ = params;
    report.lights = stage_->lights().size();
    report.evaluated = evaluated_;
    report.shown = shown_light_;
    frame.picture = {picture_};
    frame.layers = {picture_->extent, {}};
    frame.layers[Role::input] = picture_;  // for its alpha
  }

  void describe(GstStructure* stats, uint64_t number) const override {
    const Report& report = reports_[number % reports_.size()];
    gst_structure_set(stats, "model", G_TYPE_STRING, "cosine-lobe", "environment", G_TYPE_STRING,
                      environment_name_.c_str(), "lights", G_TYPE_UINT64, report.lights,
                      "evaluated", G_TYPE_UINT64, report.evaluated, "environment-shown",
                      G_TYPE_DOUBLE, report.shown, "fitted", G_TYPE_BOOLEAN, report.fitted,
                      "largest-exponent", G_TYPE_DOUBLE,
                      moments_ ? moments_->largest_exponent() : 0.0, nullptr);
  }

 private:
  struct Report {
    uint64_t lights = 0, evaluated = 0;
    double shown = 1;
    bool fitted = false;
  };

  void load(const std::string& path) {
    std::string warning;
    const Environment environment =
        path.empty() ? Environment::studio() : load_environment(path, warning);
    map_ = LightCells::map(environment);
    environment_path_ = path;
    environment_name_ = path.empty() ? "studio" : path;
    if (!warning.empty()) pending_warning_ = warning;
    lit_.reset();
  }

  /// Another file while playing: one that cannot be read is told once, and the light stays.
  void take_environment(FrameWork& frame, const Params& params) {
    if (params.environment != environment_path_ && params.environment != refused_) try {
        load(params.environment);
        refused_.reset();
      } catch (const Error& error) {
        refused_ = params.environment;
        frame.warnings.push_back(std::string(error.what()) + "; the light before stays");
      }
    if (pending_warning_) frame.warnings.push_back(*std::exchange(pending_warning_, {}));
  }

  /// Finds the lobes of the frame; false where they are those of the frame before.
  bool take_pair(FrameWork& frame, const Params& params) {
    const bool layers = frame.layers.gradients();
    const PlanePtr a = layers ? frame.layers[Role::gradient_a] : frame.layers[Role::input];
    const PlanePtr b = layers ? frame.layers[Role::gradient_b] : a;
    const bool came_again =
        !frame.fresh && fitted_ && (layers ? a == last_a_ && b == last_b_ : frame.repeated);
    if (came_again && fitted_->noise == params.lobe.noise) return true;
    const Extent extent = planes_->extent();
    const uint32_t second = layers ? 0 : extent.width;
    if (a->extent.height != extent.height || a->extent.width != extent.width + second ||
        b->extent != a->extent)
      throw Error(ErrorKind::unsupported,
                  "gradients A and B are not of one size: " + std::to_string(a->extent.width) +
                      "x" + std::to_string(a->extent.height) + " and " +
                      std::to_string(b->extent.width) + "x" + std::to_string(b->extent.height));
    lobe_->record_lobes(frame.commands, {*a, *b, second}, params.lobe);
    frame.commands.stage("lobes");
    fitted_ = params.lobe;
    last_a_ = layers ? a : nullptr;
    last_b_ = layers ? b : nullptr;
    return false;
  }

  /// Chooses the lights for the environment; true where they are those of the frame before.
  bool take_light(const Params& params) {
    if (lit_ && lit_->rotation == params.rotation && lit_->exposure == params.exposure) return true;
    const std::vector<Rgb> weights = stage_->weights(map_, double{params.rotation * kDegree});
    shown_light_ = LightCells::shown(map_, weights, stage_->covered());
    const float gain = std::exp2(params.exposure);
    lights_.clear();
    for (size_t i = 0; i < weights.size(); ++i) {
      const Rgb& w = weights[i];
      if (w[0] + w[1] + w[2] > 0)
        lights_.push_back({stage_->lights()[i], {gain * w[0], gain * w[1], gain * w[2]}});
    }
    lit_ = params;
    table_is_old_ = true;
    return false;
  }

  WeightedLight one_light(const Params& params) const {
    const auto& l = params.light;
    const double length = std::hypot(double{l[0]}, double{l[1]}, double{l[2]});
    const float weight =
        0.25F * static_cast<float>(stage_->lights().size()) * std::exp2(params.exposure);
    const Direction w =
        length > 0 ? Direction{l[0] / length, l[1] / length, l[2] / length} : Direction{0, 0, 1};
    return {w, {weight, weight, weight}};
  }

  void relit(gpu::Commands& commands, const Params& params, const Plane& target) {
    evaluated_ = lights_.size();
    if (!params.adaptive) {
      lobe_->record_sum(commands, lights_, target);
      return;
    }
    if (std::exchange(table_is_old_, false)) lobe_->record_lights(commands, lights_);
    lobe_->record_relit(commands, target);
  }
  void olat(gpu::Commands& commands, const Params& params, const Plane& target) {
    const WeightedLight light = one_light(params);
    evaluated_ = 1;
    lobe_->record_sum(commands, std::span(&light, 1), target);
  }

  void draw(gpu::Commands& commands, const Params& params, const Plane& target) {
    evaluated_ = 0;
    switch (params.show) {
      case RelightShow::relit:
        return relit(commands, params, target);
      case RelightShow::olat:
        return olat(commands, params, target);
      case RelightShow::normal:
        return lobe_->record_directions(commands, params.lobe, target);
      case RelightShow::albedo:
        return commands.copy(lobe_->full()->buffer, target.buffer, target.buffer->bytes());
      case RelightShow::mosaic: {
        const PlanePtr directions = planes_->acquire(), one = planes_->acquire(),
                       all = planes_->acquire();
        lobe_->record_directions(commands, params.lobe, *directions);
        olat(commands, params, *one);
        relit(commands, params, *all);
        mosaic_->record(commands,
                        {{{lobe_->full().get()}, {directions.get()}, {one.get()}, {all.get()}}},
                        target);
        return;
      }
    }
  }

  void forget() {
    picture_ = nullptr;
    last_a_ = last_b_ = nullptr;
    fitted_.reset();
    shown_.reset();
    lit_.reset();
  }

  /// Sets a property as if from outside.
  void set(const char* name, double value) {
    for (size_t i = 0; i < table().size(); ++i) {
      if (table()[i].name != name) continue;
      GValue to = G_VALUE_INIT;
      g_value_init(&to, G_TYPE_FLOAT);
      g_value_set_float(&to, static_cast<float>(value));
      parameters_.set(i, &to);
      g_value_unset(&to);
    }
  }

  /// Has the device build all kernels.
  void warm_up(const std::shared_ptr<gpu::Device>& device) {
    gpu::Commands commands(device);
    const PlanePtr black = planes_->acquire(), target = planes_->acquire();
    Params params;
    commands.begin();
    commands.fill(black->buffer);
    lobe_->record_lobes(commands, {*black, *black}, params.lobe);
    take_light(params);
    params.show = RelightShow::mosaic;
    draw(commands, params, *target);
    commands.submit();
    commands.wait();
    forget();
  }

  Parameters<Params> parameters_{table()};
  std::string program_;
  std::optional<LightCells> stage_;
  std::shared_ptr<const LobeMoments> moments_;
  LightCells::Map map_;
  std::string environment_path_, environment_name_ = "studio";
  std::optional<std::string> refused_, pending_warning_;

  std::optional<CosineLobe> lobe_;
  std::optional<Mosaic> mosaic_;
  std::optional<PlanePool> planes_;
  std::vector<WeightedLight> lights_;  // that stand for the environment
  bool table_is_old_ = true;
  double shown_light_ = 1;  // share of the environment's light that the stage can show
  uint64_t evaluated_ = 0;

  // Of the frame before.
  PlanePtr picture_, last_a_, last_b_;
  std::optional<CosineLobe::Params> fitted_;
  std::optional<Params> lit_, shown_;
  std::array<Report, 8> reports_{};

  std::mutex mouse_mutex_;
  Extent extent_;
  bool held_ = false;  // the mouse's button is down
};

}  // namespace

extern const ElementInfo kOlatRelight;
const ElementInfo kOlatRelight{
    "olatrelight",
    "GstOlatRelight",
    "Light stage relighting",
    "Filter/Effect/Video",
    "Shows a subject that a light stage lit by two color gradients under any light: an environment "
    "map, or one light from any direction",
    Flow::layers_or_pixels,
    Flow::pixels,
    kGradientLayers,
    "lightstagesync",
    [] { return std::unique_ptr<Filter>(new RelightElement); },
    false,
    false,
    true,
    2};

}  // namespace inverse
