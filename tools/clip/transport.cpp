// SPDX-License-Identifier: LGPL-2.1-or-later
#include "transport.hpp"

#include <atomic>
#include <stdexcept>
#include <thread>
#include <utility>

#include "hierarchy.hpp"
#include "sampling.hpp"

namespace inverse::clip {
namespace {

constexpr float kOffset = 2e-4f;  // meters off the surface, against self-shadowing

/// One stream of stratified points for all decisions of a sample.
class Sampler {
 public:
  Sampler(uint32_t pixel_seed, uint32_t index, uint32_t columns, uint32_t rows)
      : seed_(pixel_seed), index_(index), columns_(columns), rows_(rows) {}
  Point2 next() {
    seed_ = seed_ * 747796405u + 2891336453u;
    uint32_t mixed = ((seed_ >> ((seed_ >> 28) + 4)) ^ seed_) * 277803737u;
    return multi_jittered(index_, columns_, rows_, mixed);
  }

 private:
  uint32_t seed_, index_, columns_, rows_;
};

class Transport {
 public:
  explicit Transport(const Scene& scene) : scene_(scene), hierarchy_(scene.primitives) {
    window_normal_ = cross(scene.window.edge_u, scene.window.edge_v);
    window_area_ = length(window_normal_);
    window_normal_ = window_normal_ / window_area_;
  }

  const Hierarchy& hierarchy() const { return hierarchy_; }

  float lamp(const Hit& hit, Point2 p) const {
    const Lamp& lamp = scene_.lamp;
    Frame facing = frame_along_y(normalize(hit.position - lamp.position));
    Point2 disk = to_disk(p);
    Vec3 from = lamp.position + (facing.x * disk.u + facing.z * disk.v) * lamp.radius;
    float cosine, distance;
    if (!reaches(hit, from, cosine, distance)) return 0;
    return lamp.intensity * cosine / (distance * distance);
  }

  float window(const Hit& hit, Point2 p) const {
    const Window& window = scene_.window;
    Vec3 from = window.corner + window.edge_u * p.u + window.edge_v * p.v;
    Vec3 to_surface = hit.position - from;
    float leaving = dot(to_surface, window_normal_);
    if (leaving <= 0) return 0;
    float cosine, distance;
    if (!reaches(hit, from, cosine, distance)) return 0;
    float leaving_cosine = leaving / distance;
    return window.radiance * cosine * leaving_cosine * window_area_ / (kPi * distance * distance);
  }

  /// Light that arrives at `hit` after at least one bounce, as irradiance / π.
  Vec3 indirect(Hit hit, Sampler& sampler, int bounces) const {
    Vec3 throughput{1, 1, 1}, sum;
    for (int bounce = 0; bounce < bounces; ++bounce) {
      Point2 disk = to_disk(sampler.next());  // cosine-weighted: cancels irradiance / π
      Frame frame = frame_along_y(hit.normal);
      float up = std::sqrt(std::max(0.0f, 1 - disk.u * disk.u - disk.v * disk.v));
      Vec3 direction = frame.to_world({disk.u, up, disk.v});
      hit = hierarchy_.closest({hit.position + hit.normal * kOffset, direction});
      if (hit.surface < 0) break;
      throughput = throughput * hit.reflectance;
      Point2 first = sampler.next(), second = sampler.next();
      float direct =
          bounce == 0 ? lamp(hit, first) + window(hit, second) : either(hit, first, second);
      sum += throughput * direct;
    }
    return sum;
  }

 private:
  /// Estimate of lamp + window with one shadow ray.
  float either(const Hit& hit, Point2 choice, Point2 p) const {
    constexpr float kLampShare = 0.75f;  // about its share of the light
    if (choice.u < kLampShare) return lamp(hit, p) / kLampShare;
    return window(hit, p) / (1 - kLampShare);
  }

  bool reaches(const Hit& hit, Vec3 from, float& cosine, float& distance) const {
    Vec3 start = hit.position + hit.normal * kOffset;
    Vec3 to_light = from - start;
    distance = length(to_light);
    Vec3 direction = to_light / distance;
    cosine = dot(direction, hit.normal);
    return cosine > 0 && !hierarchy_.occluded({start, direction}, distance);
  }

  const Scene& scene_;
  Hierarchy hierarchy_;
  Vec3 window_normal_;
  float window_area_;
};

class View {
 public:
  View(const Camera& camera, int width, int height) : origin_(camera.position) {
    forward_ = normalize(camera.target - camera.position);
    right_ = normalize(cross(forward_, {0, 1, 0}));
    up_ = cross(right_, forward_);
    scale_ = 2 * std::tan(camera.vertical_angle / 2) / static_cast<float>(height);
    center_x_ = static_cast<float>(width) / 2, center_y_ = static_cast<float>(height) / 2;
  }
  Ray ray(float x, float y) const {
    return {origin_, normalize(forward_ + right_ * ((x - center_x_) * scale_) +
                               up_ * ((center_y_ - y) * scale_))};
  }

 private:
  Vec3 origin_, forward_, right_, up_;
  float scale_, center_x_, center_y_;
};

Vec3 ratio(Vec3 product, Vec3 weight) {
  auto safe = [](float a, float b) { return b > 0 ? a / b : 0.0f; };
  return {safe(product.x, weight.x), safe(product.y, weight.y), safe(product.z, weight.z)};
}

bool same_surface(const Hit& a, const Hit& b) {
  return a.surface == b.surface && dot(a.normal, b.normal) > 0.9f;
}

void render_pixel(const Transport& transport, const View& view, const Quality& quality, int x,
                  int y, Layers& layers) {
  auto side = static_cast<uint32_t>(std::lround(std::sqrt(quality.samples)));
  auto samples = side * side;
  auto soft_stride = static_cast<uint32_t>(std::max(1, quality.samples / quality.soft_samples));
  auto index = static_cast<size_t>(y) * layers.width + x;
  uint32_t seed = permute(static_cast<uint32_t>(index), 1u << 30, 0x68bc21eb);
  auto hit_at = [&](float u, float v) {
    Hit hit = transport.hierarchy().closest(
        view.ray(static_cast<float>(x) + u, static_cast<float>(y) + v));
    if (hit.surface < 0) throw std::logic_error("the room has a hole");
    return hit;
  };

  Hit center = hit_at(0.5f, 0.5f);
  Vec3 albedo, lamp, indirect;
  float window = 0, soft_sum = 0, soft_squares = 0, soft_count = 0;
  bool mixed = false;
  for (uint32_t s = 0; s < samples; ++s) {
    Sampler sampler(seed, s, side, side);
    Point2 p = sampler.next();
    Hit hit = hit_at(p.u, p.v);
    albedo += hit.reflectance;
    lamp += hit.reflectance * transport.lamp(hit, sampler.next());
    if (!same_surface(hit, center)) mixed = true, hit = center;
    if (s % soft_stride) continue;
    float w = transport.window(hit, sampler.next());
    Vec3 i = transport.indirect(hit, sampler, quality.bounces);
    window += w;
    indirect += i;
    float value = w + luminance(i);
    soft_sum += value, soft_squares += value * value, soft_count += 1;
  }
  layers.reflectance[index] = albedo / static_cast<float>(samples);
  layers.lamp[index] = ratio(lamp, albedo);
  layers.window[index] = window / soft_count;
  layers.indirect[index] = indirect / soft_count;
  float mean = soft_sum / soft_count;
  layers.variance[index] =
      std::max(0.0f, soft_squares / soft_count - mean * mean) / std::max(soft_count - 1, 1.0f);
  layers.normal[index] = center.normal;
  layers.position[index] = center.position;
  layers.mixed[index] = mixed;
}

}  // namespace

Layers render(const Scene& scene, int width, int height, const Quality& quality, int threads) {
  Layers layers;
  layers.width = width, layers.height = height;
  size_t pixels = static_cast<size_t>(width) * height;
  for (auto* plane :
       {&layers.reflectance, &layers.lamp, &layers.indirect, &layers.normal, &layers.position}) {
    plane->resize(pixels);
  }
  layers.window.resize(pixels);
  layers.variance.resize(pixels);
  layers.mixed.resize(pixels);

  Transport transport(scene);
  View view(scene.camera, width, height);
  std::atomic<int> next_row = 0;
  auto work = [&] {
    for (int y; (y = next_row++) < height;) {
      for (int x = 0; x < width; ++x) render_pixel(transport, view, quality, x, y, layers);
    }
  };
  std::vector<std::jthread> pool;
  for (int i = 1; i < threads; ++i) pool.emplace_back(work);
  work();
  pool.clear();  // joins
  return layers;
}

}  // namespace inverse::clip
