// SPDX-License-Identifier: LGPL-2.1-or-later
#include "lit_sphere.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include "common/error.hpp"

namespace inverse {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr uint32_t kSamples = 128;
// Lobes of smaller exponents are much wider than the cells of the light, even where half vectors
// change fast, for light from behind.
constexpr float kBroad = 40;
// Filter radius of a sample, in distances between samples: a smaller one shows single samples of a
// small bright lamp, a larger one blurs.
constexpr double kOverlap = 1.2;

float bounded(float value, float low, float high) {
  return value >= low ? std::min(value, high) : low;  // NaN: low
}

Surface bounded(Surface s) {
  for (float& albedo : s.diffuse) albedo = bounded(albedo, 0, 16);
  s.specular = bounded(s.specular, 0, 16);
  s.shininess = bounded(s.shininess, 1, 1024);
  return s;
}

/// Identity if it is no rotation.
std::array<float, 4> unit(const std::array<float, 4>& q) {
  const float length = std::hypot(std::hypot(q[0], q[1]), std::hypot(q[2], q[3]));
  if (!std::isfinite(length) || length < 1e-6F) return {0, 0, 0, 1};
  return {q[0] / length, q[1] / length, q[2] / length, q[3] / length};
}

/// From the table's axes to those of the map, which is rotated.
std::array<float, 4> to_map(const LitSphere::View& view) {
  const float w = std::cos(view.rotation / 2), y = -std::sin(view.rotation / 2);  // about y, first
  const auto& [i, j, k, l] = view.viewer;
  return {w * i + y * k, w * j + y * l, w * k - y * i, w * l - y * j};
}

/// Half vectors around +z, distributed as (s+1)/(2 pi) cos^s, and the filter level of each for v·h
/// = 1.
std::vector<PrefilteredLight::Vec4> lobe(double shininess, uint32_t rows) {
  std::vector<PrefilteredLight::Vec4> samples(kSamples);
  const double texel = kPi / rows, golden = kPi * (3 - std::sqrt(5.0));
  for (uint32_t i = 0; i < kSamples; ++i) {
    const double u = (i + 0.5) / kSamples, z = std::pow(1 - u, 1 / (shininess + 1));
    const double radius = std::sqrt(1 - z * z);
    const double density = (shininess + 1) / (2 * kPi) * std::pow(z, shininess);
    const double area = 4 / (kSamples * density);  // in w
    samples[i] = {static_cast<float>(radius * std::cos(i * golden)),
                  static_cast<float>(radius * std::sin(i * golden)), static_cast<float>(z),
                  static_cast<float>(std::log2(kOverlap * std::sqrt(area) / texel))};
  }
  return samples;
}

}  // namespace

bool alike(const Surface& a, const Surface& b) {
  constexpr float kRatio = 1.01F;
  // Relative, because exposure and lobe gain may amplify small differences; for dark values, less
  // than half a code value.
  const auto near = [](float p, float q) {
    return std::fabs(p - q) <= 1e-4F + 0.005F * std::max(p, q);
  };
  for (size_t c = 0; c < 3; ++c)
    if (!near(a.diffuse[c], b.diffuse[c])) return false;
  return near(a.specular, b.specular) && a.shininess <= kRatio * b.shininess &&
         b.shininess <= kRatio * a.shininess;
}

bool alike(const Environment& a, const Environment& b) {
  if (a.extent() != b.extent()) return false;
  double difference = 0, sum = 0;
  for (size_t i = 0; i < a.rgb().size(); ++i) {
    difference += std::fabs(double{a.rgb()[i]} - b.rgb()[i]);
    sum += a.rgb()[i];
  }
  return difference <= 0.01 * sum;
}

struct LitSphere::Light {
  gpu::BufferPtr cells, texels;
  uint32_t cell_count, rows, levels;
};

LitSphere::LitSphere(const std::shared_ptr<gpu::Device>& device, uint32_t side)
    : table_{{side, side}, gpu::Buffer::create(device, gpu::Element::vec4, uint64_t{side} * side)},
      kernel_(device) {}

void LitSphere::set_light(const PrefilteredLight& light) {
  const auto& device = table_.buffer->device();
  light_ = std::make_shared<const Light>(
      Light{gpu::make_table(device, gpu::Element::vec4, light.cells),
            gpu::make_table(device, gpu::Element::vec4, light.texels),
            static_cast<uint32_t>(light.cells.size() / 2), light.rows, light.levels});
  cells_ = light.cells;
  ++lights_;
  recorded_.reset();
}

void LitSphere::record(gpu::Commands& commands, const Surface& surface, const View& view) {
  if (!light_) throw Error(ErrorKind::internal, "a lit sphere without light");
  const State state{bounded(surface),
                    {bounded(view.intensity, 0, 1e6F),
                     std::isfinite(view.rotation) ? view.rotation : 0, unit(view.viewer)}};
  if (recorded_ == state) return;
  recorded_.reset();  // until it is
  ++version_;
  const Surface& s = state.surface;
  const float gain = Surface::lobe_gain(s.shininess) * s.specular * state.view.intensity;
  const uint32_t side = table_.extent.width;
  const bool broad = s.shininess < kBroad;
  commands.write_table(samples_, gpu::Element::vec4, lobe(double{s.shininess}, light_->rows));
  commands.dispatch(
      kernel_,
      {.cells = light_->cells,
       .light = light_->texels,
       .samples = samples_,
       .table = table_.buffer},
      {.diffuse = {s.diffuse[0] * state.view.intensity, s.diffuse[1] * state.view.intensity,
                   s.diffuse[2] * state.view.intensity, 0},
       .turn = to_map(state.view),
       .gloss = gain,
       .shininess = s.shininess,
       .spread = static_cast<float>(std::sqrt(kPi) / light_->rows),
       .side = side,
       .cells = light_->cell_count,
       .broad = gain > 0 && broad ? light_->cell_count : 0,
       .samples = gain > 0 && !broad ? kSamples : 0,
       .rows = light_->rows,
       .levels = light_->levels},
      {side * side});
  recorded_ = state;
}

}  // namespace inverse
