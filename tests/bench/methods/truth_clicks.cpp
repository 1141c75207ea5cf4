// SPDX-License-Identifier: LGPL-2.1-or-later
#include "truth_clicks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

namespace inverse::bench {

std::array<double, 3> chromaticity(double r, double g, double b) {
  const double mean = std::max((r + g + b) / 3, 1e-12);
  return {r / mean, g / mean, b / mean};
}

TrueSlots::TrueSlots(const Image& reflectance, const Image& mask,
                     std::span<const BaseColors::Color> colors)
    : nearest_(reflectance.data.size() / 3, -1), distances_(nearest_.size()) {
  constexpr float kBlack = 1e-4F, kFloor = 3e-3F;  // as GlobalThesisParams::chroma_floor
  for (std::size_t n = 0; n < nearest_.size(); ++n) {
    const float* r = &reflectance.data[3 * n];
    if (std::max({r[0], r[1], r[2]}) < kBlack) continue;
    if (!mask.empty() && mask.data[n] <= 0.5F) continue;
    const float mean = (r[0] + r[1] + r[2]) / 3 + kFloor;
    float nearest = std::numeric_limits<float>::infinity();
    for (const BaseColors::Color& color : colors) {
      float squares = 0;
      for (std::size_t c = 0; c < 3; ++c) {
        const float d = std::log((r[c] + kFloor) / mean) - color.center[c];
        squares += d * d;
      }
      const float distance = std::sqrt(squares);
      distances_[n].at(std::size_t(color.slot)) = distance;
      if (distance < nearest) nearest = distance, nearest_[n] = color.slot;
    }
  }
}

std::vector<std::uint8_t> TrueSlots::wrong(const std::vector<int>& slots) const {
  std::vector<std::uint8_t> result(slots.size());
  for (std::size_t n = 0; n < slots.size(); ++n) {
    const int is = slots[n], should = nearest_[n];
    result[n] = is >= 0 && should >= 0 && is != should &&
                distances_[n].at(std::size_t(is)) > distances_[n][std::size_t(should)] + kMargin;
  }
  return result;
}

std::vector<Component> components(const std::vector<int>& slots,
                                  const std::vector<std::uint8_t>& wrong,
                                  const std::vector<int>& truth, int width, int height) {
  std::vector<std::uint8_t> seen(slots.size());
  std::vector<Component> result;
  for (int first = 0; first < width * height; ++first) {
    if (seen[std::size_t(first)]) continue;
    Component component;
    component.cluster = slots[std::size_t(first)];
    component.pixels = {first};
    seen[std::size_t(first)] = 1;
    std::map<int, std::size_t> votes;
    for (std::size_t i = 0; i < component.pixels.size(); ++i) {
      const int n = component.pixels[i], x = n % width, y = n / width;
      if (wrong[std::size_t(n)]) {
        ++component.wrong;
        ++votes[truth[std::size_t(n)]];
      }
      const std::array<std::pair<bool, int>, 4> neighbors{{{x > 0, n - 1},
                                                           {x + 1 < width, n + 1},
                                                           {y > 0, n - width},
                                                           {y + 1 < height, n + width}}};
      for (const auto& [inside, m] : neighbors) {
        if (!inside || seen[std::size_t(m)] || slots[std::size_t(m)] != component.cluster) continue;
        seen[std::size_t(m)] = 1;
        component.pixels.push_back(m);
      }
    }
    std::size_t max = 0;
    for (const auto& [slot, count] : votes)
      if (count > max) max = count, component.right = slot;
    result.push_back(std::move(component));
  }
  return result;
}

std::vector<Component> wrong_components(const std::vector<int>& slots,
                                        const std::vector<std::uint8_t>& wrong,
                                        const std::vector<int>& truth, int width, int height,
                                        double min_share) {
  std::vector<Component> result = components(slots, wrong, truth, width, height);
  std::erase_if(result, [&](const Component& c) {
    return c.cluster < 0 || !c.mostly_wrong() ||
           double(c.pixels.size()) < min_share * width * height;
  });
  std::stable_sort(result.begin(), result.end(), [](const Component& a, const Component& b) {
    return a.pixels.size() > b.pixels.size();
  });
  return result;
}

std::vector<double> base_color_errors(const Image& reflectance, const std::vector<int>& slots,
                                      std::span<const BaseColors::Color> colors, bool initial,
                                      std::size_t min_pixels) {
  std::vector<double> errors;
  for (const BaseColors::Color& color : colors) {
    if (color.layer < 0) continue;
    std::array<double, 3> sum{};
    std::size_t count = 0;
    for (std::size_t n = 0; n < slots.size(); ++n) {
      const float* r = &reflectance.data[3 * n];
      if (slots[n] != color.slot || r[0] + r[1] + r[2] <= 0) continue;
      const auto c = chromaticity(r[0], r[1], r[2]);
      for (std::size_t k = 0; k < 3; ++k) sum[k] += c[k];
      ++count;
    }
    if (count < std::max<std::size_t>(min_pixels, 1)) {
      errors.push_back(std::numeric_limits<double>::quiet_NaN());
      continue;
    }
    const BaseColors::Rgb& b = initial ? color.initial : color.color;
    const auto found = chromaticity(b[0], b[1], b[2]);
    double squares = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double d = found[k] - sum[k] / double(count);
      squares += d * d;
    }
    errors.push_back(std::sqrt(squares));
  }
  return errors;
}

}  // namespace inverse::bench
