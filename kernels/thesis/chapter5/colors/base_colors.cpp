// SPDX-License-Identifier: LGPL-2.1-or-later
#include "base_colors.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "common/error.hpp"

namespace inverse {
namespace {

/// The largest channel becomes 1; black, which has no chromaticity, white.
BaseColors::Rgb scaled(const BaseColors::Rgb& color) {
  constexpr float kBlack = 1e-6f;
  const float largest = std::max({color[0], color[1], color[2], 0.0f});
  BaseColors::Rgb result{};
  for (size_t c = 0; c < 3; ++c) {
    result[c] = std::clamp((color[c] + kBlack) / (largest + kBlack), BaseColors::kDarkest, 1.0f);
  }
  return result;
}

float mean(const BaseColors::Rgb& color) { return (color[0] + color[1] + color[2]) / 3; }

/// Distance of two chromaticities, mean 1.
float distance(const BaseColors::Rgb& a, const BaseColors::Rgb& b) {
  float sum = 0;
  for (size_t c = 0; c < 3; ++c) {
    const float d = a[c] / mean(a) - b[c] / mean(b);
    sum += d * d;
  }
  return std::sqrt(sum);
}

/// A palette's slot that moves further than this in chromaticity stands for another color.
constexpr float kSameColor = 0.3f;

}  // namespace

void BaseColors::update(std::span<const Palette::Cluster> clusters, float tau_neutral) {
  if (given_) return;
  const std::vector<Color> before = std::move(colors_);
  colors_.clear();
  for (size_t k = 0; k < clusters.size(); ++k) {
    const Palette::Cluster& cluster = clusters[k];
    if (cluster.index != static_cast<int>(k)) continue;  // empty or merged into another
    const Rgb color = scaled({std::exp(cluster.log_color[0]), std::exp(cluster.log_color[1]),
                              std::exp(cluster.log_color[2])});
    Color now{static_cast<int>(k), cluster.log_color, color, color, false, -1};
    for (const Color& old : before) {
      if (old.slot != now.slot || !old.fixed) continue;
      if (distance(old.initial, now.color) > kSameColor) continue;
      now.color = old.color;
      now.initial = old.initial;
      now.fixed = true;
    }
    colors_.push_back(now);
  }
  assign_layers(tau_neutral);
  const auto placed = [](const Color& a, const Color& b) {
    return a.slot == b.slot && a.layer == b.layer;
  };
  const auto same = [&](const Color& a, const Color& b) {
    return placed(a, b) && a.color == b.color;
  };
  const auto equal = [&](auto compare) {
    return std::equal(colors_.begin(), colors_.end(), before.begin(), before.end(), compare);
  };
  if (!equal(placed)) ++order_;
  if (!equal(same)) ++version_;
}

void BaseColors::set(std::span<const Rgb> colors) {
  if (colors.size() > static_cast<size_t>(kMaxColors))
    throw Error(ErrorKind::internal, "at most 16 base colors can be set");
  colors_.clear();
  for (const Rgb& given : colors) {
    const Rgb color = scaled(given);
    Color now{static_cast<int>(colors_.size()), {}, color, color, false, -1};
    for (size_t c = 0; c < 3; ++c) now.center[c] = std::log(color[c] / mean(color));
    colors_.push_back(now);
  }
  given_ = true;
  assign_layers(0);
  ++version_;
  ++order_;
}

void BaseColors::assign_layers(float tau_neutral) {
  layers_ = 0;
  for (Color& color : colors_)
    color.layer = distance(color.initial, {1, 1, 1}) < tau_neutral ? -1 : layers_++;
}

void BaseColors::fix() {
  for (Color& color : colors_) color.fixed = true;
}

void BaseColors::loosen() {
  for (Color& color : colors_) color.fixed = false;
}

float BaseColors::refine(std::span<const Rgb> delta) {
  float largest = 0;
  for (Color& color : colors_) {
    if (color.layer < 0 || static_cast<size_t>(color.layer) >= delta.size()) continue;
    const Rgb& change = delta[static_cast<size_t>(color.layer)];
    for (size_t c = 0; c < 3; ++c) {
      const float before = color.color[c];
      if (!std::isfinite(change[c])) {
        largest = 1;
        continue;
      }
      color.color[c] = std::clamp(before + change[c], kDarkest, 1.0f);
      largest = std::max(largest, std::abs(color.color[c] - before));
    }
    color.fixed = true;
  }
  ++version_;
  return largest;
}

void BaseColors::reset() {
  colors_.clear();
  layers_ = 0;
  given_ = false;
  ++version_;
  ++order_;
}

std::vector<BaseColors::Rgb> BaseColors::layer_colors(bool initial) const {
  std::vector<Rgb> result;
  for (const Color& color : colors_)
    if (color.layer >= 0) result.push_back(initial ? color.initial : color.color);
  return result;
}

void BaseColors::write_table(float* table) const {
  std::memset(table, 0, kTableEntries * 4 * sizeof(float));
  for (const Color& color : colors_) {
    float* center = table + 4 * color.slot;
    float* target = table + 4 * (kMaxColors + color.slot);
    float* layer = table + 4 * (2 * kMaxColors + std::max(color.layer, 0));
    for (size_t c = 0; c < 3; ++c) {
      center[c] = color.center[c];
      target[c] = std::log(color.initial[c]);
      if (color.layer >= 0) layer[c] = color.color[c];
    }
    center[3] = 1;
    if (color.layer >= 0) layer[3] = 1;
  }
}

}  // namespace inverse
