// SPDX-License-Identifier: LGPL-2.1-or-later
// Accuracy of limematerial's light: light-bench [--scenes N] [--models FOLDER]. Round
// objects with known normals, in rooms of training/lime, through LimeMaterial: light from true
// layers and from the networks', with true normals and with normals inflated from the outline.
// Needs a Vulkan device.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <string>
#include <vector>

#include "common/error.hpp"
#include "kernels/environment/environment_fit.hpp"
#include "kernels/environment/lit_sphere.hpp"
#include "kernels/gpu/commands.hpp"
#include "kernels/material/lime_material.hpp"
#include "tests/bench/support/command_line.hpp"
#include "tests/srgb.hpp"
#include "training/lime/corpus/background.hpp"
#include "training/lime/corpus/blinn_phong.hpp"
#include "training/lime/corpus/room.hpp"

namespace {

using namespace inverse;
using lime::Vec;

constexpr uint32_t kSide = 256;
constexpr float kRadius = 84;

/// A body of revolution about the image's y axis, by the half width of its outline.
enum class Shape { sphere, flat_ellipsoid, capsule };

/// The normal at a position of the image, in radii from the center, y up; z = 0: background.
Vec normal_at(Shape shape, float x, float y) {
  const float stretch = shape == Shape::flat_ellipsoid ? 0.6F : 1;  // along y
  if (shape == Shape::capsule) {
    // A cylinder of half the radius with round ends.
    constexpr float kHalf = 0.5F;
    const float above = std::max(std::fabs(y) - kHalf, 0.0F) * (y < 0 ? -1.0F : 1.0F);
    const float z2 = kHalf * kHalf - x * x - above * above;
    return z2 > 0 ? lime::normalize({x, above, std::sqrt(z2)}) : Vec{};
  }
  const float z2 = 1 - x * x - y * y / (stretch * stretch);
  return z2 > 0 ? lime::normalize({x, y / (stretch * stretch), std::sqrt(z2)}) : Vec{};
}

struct Scene {
  Material material;
  float shininess = 0, gain = 0;  // of the specular layer: alpha times the lobe's
  lime::Environment room;         // exposed: radiance / pi is what a mirror shows
  std::vector<Vec> normals, image, specular, mirror;
  std::vector<uint8_t> mask;
};

/// Conversion of a pixel to 8-bit sRGB and back.
float through_camera(float linear) {
  return srgb_light(std::round(255 * srgb_code(std::clamp(linear, 0.0F, 1.0F))) / 255);
}

Scene make_scene(Shape shape, uint64_t number) {
  lime::Random random(77, number, 0);
  Scene scene;
  scene.room = lime::make_room(random);
  for (float& m : scene.material.diffuse) m = random.uniform(0.08F, 0.8F);
  scene.material.specular = random.uniform(0.15F, 0.8F);
  scene.shininess = std::exp2(random.uniform(3.0F, 9.5F));
  scene.gain = scene.material.specular * Surface::lobe_gain(scene.shininess);
  const lime::Lights wide(shrink(scene.room, 24)), narrow(shrink(scene.room, 48));
  scene.normals.resize(size_t{kSide} * kSide);
  scene.mask.resize(scene.normals.size());
  std::vector<Vec> diffuse(scene.normals.size());
  scene.specular.resize(scene.normals.size());
  scene.mirror.resize(scene.normals.size());
  double mean = 0, peak = 0;
  size_t count = 0;
  const Vec view{0, 0, 1};
  for (size_t i = 0; i < scene.normals.size(); ++i) {
    const float x = (static_cast<float>(i % kSide) + 0.5F - kSide / 2.0F) / kRadius;
    const float y = -(static_cast<float>(i / kSide) + 0.5F - kSide / 2.0F) / kRadius;
    const Vec n = scene.normals[i] = normal_at(shape, x, y);
    if (!(n.z > 0)) continue;
    scene.mask[i] = 1;
    diffuse[i] = wide.diffuse(n);
    scene.specular[i] = scene.gain * narrow.specular(n, view, scene.shininess);
    scene.mirror[i] = scene.room.look(2 * n.z * n - view);
    mean += static_cast<double>(diffuse[i].x + diffuse[i].y + diffuse[i].z) / 3;
    peak += static_cast<double>(diffuse[i].y * scene.material.diffuse[1] + scene.specular[i].y);
    ++count;
  }
  // The mean of D is 0.6, or less to keep the mean of highlights below white.
  const auto exposure = static_cast<float>(std::min(0.6 / (mean / static_cast<double>(count)),
                                                    0.45 / (peak / static_cast<double>(count))));
  lime::Random other(78, number, 0);
  scene.image = lime::make_background(other, kSide, scene.room);
  for (size_t i = 0; i < scene.image.size(); ++i) {
    scene.specular[i] = exposure * scene.specular[i];
    scene.mirror[i] = exposure * scene.mirror[i];
    if (!scene.mask[i]) continue;
    const auto& m = scene.material.diffuse;
    scene.image[i] = exposure * (Vec{m[0], m[1], m[2]} * diffuse[i]) + scene.specular[i];
  }
  for (Vec& v : scene.room.radiance) v = std::numbers::pi_v<float> * exposure * v;
  return scene;
}

std::vector<Vec> directions() {
  std::vector<Vec> all;
  for (int i = 0; i < 400; ++i) {
    const float z = 1 - 2 * (static_cast<float>(i) + 0.5F) / 400, r = std::sqrt(1 - z * z);
    all.push_back({r * std::cos(2.399963F * static_cast<float>(i)),
                   r * std::sin(2.399963F * static_cast<float>(i)), z});
  }
  return all;
}

lime::Environment as_corpus(const Environment& light) {
  lime::Environment map;
  map.rows = static_cast<int>(light.extent().height);
  for (size_t i = 0; i < light.extent().pixels(); ++i)
    map.radiance.push_back({light.rgb()[3 * i], light.rgb()[3 * i + 1], light.rgb()[3 * i + 2]});
  return map;
}

/// Correlation of the three bands above order 2: the gray map minus its low frequencies.
std::vector<double> high_frequencies(const lime::Environment& map) {
  std::vector<double> value(map.radiance.size());
  EnvironmentFit::Terms terms{};
  const auto at = [&](size_t i) {
    const Vec d =
        lime::texel_direction(static_cast<int>(i) / map.columns(),
                              static_cast<int>(i) % map.columns(), map.rows, map.columns());
    return EnvironmentFit::harmonics(d.x, d.y, d.z);
  };
  for (size_t i = 0; i < value.size(); ++i) {
    const Vec& v = map.radiance[i];
    value[i] = static_cast<double>(v.x + v.y + v.z) / 3;
    const double area =
        lime::texel_solid_angle(static_cast<int>(i) / map.columns(), map.rows, map.columns());
    for (size_t k = 0; k < terms.size(); ++k) terms[k] += area * value[i] * at(i)[k];
  }
  for (size_t i = 0; i < value.size(); ++i)
    for (size_t k = 0; k < terms.size(); ++k) value[i] -= terms[k] * at(i)[k];
  return value;
}

struct Score {
  double front = 0, back = 0, front_constant = 0, back_constant = 0, correlation = 0, level = 0;
  int count = 0, missing = 0;

  /// Errors of D are rms over its true mean over all normals.
  void add(const Scene& scene, const Environment* light) {
    if (!light) {
      ++missing;
      return;
    }
    const lime::Environment got = as_corpus(*light);
    const lime::Environment truth = shrink(scene.room, 32);
    const lime::Lights true_lights(shrink(scene.room, 24)), lights(got);
    double sums[2] = {}, constants[2] = {}, mean = 0, mean_got = 0, seen = 0;
    std::vector<std::pair<Vec, Vec>> values;
    int fronts = 0;
    for (const Vec& n : directions()) {
      values.emplace_back(true_lights.diffuse(n), lights.diffuse(n));
      const auto& [t, g] = values.back();
      mean += static_cast<double>(t.x + t.y + t.z) / 3;
      mean_got += static_cast<double>(g.x + g.y + g.z) / 3;
      if (n.z > 0) seen += static_cast<double>(t.x + t.y + t.z) / 3, ++fronts;
    }
    mean /= 400, mean_got /= 400, seen /= fronts;
    size_t i = 0;
    for (const Vec& n : directions()) {
      const auto& [t, g] = values[i++];
      for (const auto& [a, b] : {std::pair{t.x, g.x}, {t.y, g.y}, {t.z, g.z}}) {
        sums[n.z > 0] += std::pow(static_cast<double>(a - b), 2);
        constants[n.z > 0] += std::pow(static_cast<double>(a) - seen, 2);
      }
    }
    front += std::sqrt(sums[1] / 600) / mean, back += std::sqrt(sums[0] / 600) / mean;
    front_constant += std::sqrt(constants[1] / 600) / mean;
    back_constant += std::sqrt(constants[0] / 600) / mean;
    level += std::fabs(std::log2(mean_got / mean));
    const auto a = high_frequencies(truth), b = high_frequencies(got);
    double ab = 0, aa = 0, bb = 0;
    for (size_t k = 0; k < a.size(); ++k) {
      const double area = lime::texel_solid_angle(static_cast<int>(k) / truth.columns(), truth.rows,
                                                  truth.columns());
      ab += area * a[k] * b[k], aa += area * a[k] * a[k], bb += area * b[k] * b[k];
    }
    correlation += ab / std::sqrt(aa * bb + 1e-30);
    ++count;
  }
  void print(const char* layers, const char* normals) const {
    const double n = std::max(count, 1);
    std::printf("| %s | %s | %.1f %% | %.1f %% | %.1f %% | %.1f %% | %.2f | %.2f | %d |\n", layers,
                normals, 100 * front / n, 100 * front_constant / n, 100 * back / n,
                100 * back_constant / n, level / n, correlation / n, missing);
  }
};

/// The true layers at every second pixel, as many points as the networks use.
std::shared_ptr<const Environment> from_truth(const Scene& scene, bool inflate) {
  std::vector<EnvironmentFit::Point> points;
  std::vector<uint8_t> mask;
  for (uint32_t row = 0; row < kSide; row += 2)
    for (uint32_t column = 0; column < kSide; column += 2)
      mask.push_back(scene.mask[size_t{row} * kSide + column]);
  const auto inflated = inflated_normals(mask, kSide / 2, {0, 0, kSide / 2, kSide / 2});
  for (size_t k = 0; k < mask.size(); ++k) {
    if (!mask[k]) continue;
    const size_t i = 2 * (k / (kSide / 2)) * kSide + 2 * (k % (kSide / 2));
    const Vec &n = scene.normals[i], seen = scene.image[i], s = scene.specular[i],
              &m = scene.mirror[i];
    EnvironmentFit::Point point{{n.x, n.y, n.z},
                                {seen.x - s.x, seen.y - s.y, seen.z - s.z},
                                std::max({seen.x, seen.y, seen.z}) > 0.97F,
                                scene.material.specular * (m.x + m.y + m.z) / 3};
    if (inflate) point.normal = inflated[k];
    points.push_back(point);
  }
  EnvironmentFit fit;
  const EnvironmentFit::Params params;
  fit.add(points, params);
  auto light = fit.light(scene.material.diffuse, scene.material.specular, params);
  return light ? std::make_shared<const Environment>(std::move(*light)) : nullptr;
}

/// A video of one repeated frame with sensor noise.
class Video {
 public:
  Video(const std::shared_ptr<gpu::Device>& device, const Scene& scene)
      : scene_(scene),
        commands_(device),
        host_(gpu::Buffer::create(device, gpu::Element::vec4, scene.image.size(),
                                  gpu::Memory::upload)),
        plane_{{kSide, kSide},
               gpu::Buffer::create(device, gpu::Element::vec4, scene.image.size())} {}

  void play(LimeMaterial& lime, const LimeMaterial::Params& params, float noise, uint64_t number) {
    lime::Random random(5, number, 1);
    float* pixels = host_->map_as<float>();
    for (size_t i = 0; i < scene_.image.size(); ++i) {
      const Vec& v = scene_.image[i];
      const float light[3] = {v.x, v.y, v.z};
      // Photons and electronics: variance grows with the light.
      for (size_t c = 0; c < 3; ++c)
        pixels[4 * i + c] = through_camera(
            light[c] + noise * std::sqrt(0.02F + std::max(light[c], 0.0F)) * random.normal());
      pixels[4 * i + 3] = 1;
    }
    commands_.begin();
    commands_.copy(host_, plane_.buffer, host_->bytes());
    lime.record(commands_, plane_, params, false);
    commands_.submit();
    commands_.wait();
    lime.done(lime.recorded() - 1);
  }

 private:
  const Scene& scene_;
  gpu::Commands commands_;
  gpu::BufferPtr host_;
  Plane plane_;
};

std::shared_ptr<const NormalMap> normal_map(const Scene& scene) {
  std::vector<Normal> normals;
  for (const Vec& n : scene.normals) normals.push_back({n.x, n.y, n.z});
  return std::make_shared<const NormalMap>(NormalMap({kSide, kSide}, std::move(normals)));
}

void light_table(const std::shared_ptr<gpu::Device>& device, const LimeModels& models, int scenes) {
  std::printf(
      "Errors of D: root mean square over its mean. Constant: the mean of D over the normals that\n"
      "are seen. Level: |log2| of the ratio of mean light. Correlation: of what is above order "
      "2.\n\n"
      "| layers | normals | front | constant | back | constant | level | correlation | none |\n"
      "|---|---|---|---|---|---|---|---|---|\n");
  for (const auto& [shape, name] : {std::pair{Shape::sphere, "sphere"},
                                    {Shape::flat_ellipsoid, "ellipsoid"},
                                    {Shape::capsule, "capsule"}}) {
    Score truth, truth_inflated, networks, networks_inflated;
    for (int i = 0; i < scenes; ++i) {
      const Scene scene = make_scene(shape, static_cast<uint64_t>(i));
      truth.add(scene, from_truth(scene, false).get());
      truth_inflated.add(scene, from_truth(scene, true).get());
      for (const bool inflate : {false, true}) {
        LimeMaterial lime(device, {kSide, kSide}, models);
        if (!inflate) lime.set_normal_map(normal_map(scene));
        LimeMaterial::Params params;
        params.light_asked = true;
        params.adaptive = false;
        Video video(device, scene);
        for (uint64_t frame = 0; frame < 10; ++frame) video.play(lime, params, 0.01F, frame);
        (inflate ? networks_inflated : networks)
            .add(scene, lime.object().known() ? lime.light().get() : nullptr);
      }
    }
    truth.print("true", (std::string(name) + ", true").c_str());
    truth_inflated.print("true", (std::string(name) + ", outline").c_str());
    networks.print("networks", (std::string(name) + ", true").c_str());
    networks_inflated.print("networks", (std::string(name) + ", outline").c_str());
  }
}

}  // namespace

int main(int count, char** words) {
  int scenes = 12;
  const char* folder = std::getenv("INVERSE_MODELS");
  std::string models = folder ? folder : "build/models";
  if (!bench::read({{"--scenes", bench::integer(scenes)}, {"--models", bench::text(models)}}, count,
                   words, "light_bench.cpp"))
    return 2;
  scenes = std::max(1, scenes);
  try {
    const auto device = gpu::Device::open();
    const LimeModels networks = LimeModels::load(models + "/lime");
    light_table(device, networks, scenes);
  } catch (const inverse::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
