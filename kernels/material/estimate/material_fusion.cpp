// SPDX-License-Identifier: LGPL-2.1-or-later
#include "material_fusion.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace inverse {
namespace {

constexpr size_t kNumbers = 4 + Material::kBins;
using Numbers = std::array<float, kNumbers>;

Numbers numbers_of(const Material& m) {
  Numbers all{m.diffuse[0], m.diffuse[1], m.diffuse[2], m.specular};
  std::copy(m.bins.begin(), m.bins.end(), all.begin() + 4);
  return all;
}

Material material_of(const Numbers& all) {
  Material m;
  std::copy_n(all.begin(), 3, m.diffuse.begin());
  m.specular = all[3];
  std::copy_n(all.begin() + 4, Material::kBins, m.bins.begin());
  return m;
}

float diffuse_distance(const Material& a, const Material& b) {
  float largest = 0;
  for (size_t c = 0; c < 3; ++c)
    largest = std::max(largest, std::fabs(a.diffuse[c] - b.diffuse[c]));
  return largest;
}

float specular_distance(const Material& a, const Material& b) {
  return std::fabs(a.specular - b.specular);
}

/// A sixth of log2 of the shininess: a range of 1.5.
float shininess_distance(const Material& a, const Material& b) {
  return std::fabs(std::log2(a.shininess() / b.shininess())) / 6;
}

/// Specular albedo and shininess are less accurate than the color.
bool is_other(const Material& a, const Material& b, float limit) {
  return diffuse_distance(a, b) > limit || specular_distance(a, b) > 2 * limit ||
         shininess_distance(a, b) > 3 * limit;
}

float distance(const Material& a, const Material& b) {
  return std::max({diffuse_distance(a, b), specular_distance(a, b), shininess_distance(a, b)});
}

/// Element by element; bins are normalized again.
Material median(const std::deque<Material>& window) {
  Numbers result{};
  std::vector<float> column;
  for (size_t n = 0; n < kNumbers; ++n) {
    column.clear();
    for (const Material& m : window) column.push_back(numbers_of(m)[n]);
    std::sort(column.begin(), column.end());
    const size_t half = column.size() / 2;
    result[n] = column.size() % 2 ? column[half] : (column[half - 1] + column[half]) / 2;
  }
  Material m = material_of(result);
  float all = 0;
  for (const float p : m.bins) all += p;
  for (float& p : m.bins) p = all > 0 ? p / all : 1.0F / Material::kBins;
  return m;
}

/// Mixes `share` of one material with the rest of another.
Material mix(const Material& one, float share, const Material& other) {
  const Numbers a = numbers_of(one), b = numbers_of(other);
  Numbers mixed{};
  for (size_t n = 0; n < kNumbers; ++n) mixed[n] = share * a[n] + (1 - share) * b[n];
  return material_of(mixed);
}

/// Whether all values are finite and the bins are probabilities.
bool sound(const Material& m) {
  const Numbers all = numbers_of(m);
  return std::all_of(all.begin(), all.end(), [](float v) { return std::isfinite(v); }) &&
         std::all_of(m.bins.begin(), m.bins.end(), [](float p) { return p >= 0; }) &&
         std::any_of(m.bins.begin(), m.bins.end(), [](float p) { return p > 0; });
}

constexpr float kRecent = 0.1F;  // weight of the last estimate in the running means

}  // namespace

void MaterialFusion::reset() { *this = {}; }

void MaterialFusion::add(const Material& estimate, const Params& params) {
  if (!sound(estimate)) return;
  window_.push_back(estimate);
  if (window_.size() > kWindow) window_.pop_front();
  const Material middle = median(window_);
  others_ = count_ && is_other(middle, mean_, params.new_object_distance) ? others_ + 1 : 0;
  if (others_ >= kWindow) {
    reset();
    window_.push_back(estimate);
  }
  ++count_;
  // Not from count_: increasing the memory must not restore estimates that a shorter one dropped.
  averaged_ = std::min<uint64_t>(averaged_ + 1, std::max(params.memory, uint32_t{1}));
  const float alpha = 1.0F / static_cast<float>(averaged_);
  mean_ = mix(count_ == 1 ? estimate : middle, alpha, mean_);
  recent_ = mix(estimate, count_ == 1 ? 1 : kRecent, recent_);
  const float off = distance(estimate, mean_);
  spread_ = std::sqrt((1 - kRecent) * spread_ * spread_ + kRecent * off * off);
}

float MaterialFusion::drift() const { return count_ ? distance(recent_, mean_) : 0; }

bool MaterialFusion::converged(float limit) const {
  const float drift = this->drift();
  // A running mean of estimates with standard deviation s has standard error s sqrt(kRecent / (2 -
  // kRecent)): twice that is about s / 2.
  const float scatter = std::sqrt(std::max(spread_ * spread_ - drift * drift, 0.0F));
  return count_ >= kMinEstimates && spread_ < limit * std::sqrt(static_cast<float>(averaged_)) &&
         drift < limit + scatter / 2;
}

}  // namespace inverse
