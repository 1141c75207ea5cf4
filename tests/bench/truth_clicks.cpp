#include "tests/bench/truth_clicks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace inverse::bench {

std::array<double, 3> chromaticity(double r, double g, double b) {
  const double mean = std::max((r + g + b) / 3, 1e-12);
  return {r / mean, g / mean, b / mean};
}

std::vector<int> true_slots(const Image& reflectance, std::span<const BaseColors::Color> colors) {
  constexpr double kBlack = 1e-4, kLeast = 1e-3;
  std::vector<int> slots(reflectance.data.size() / 3, -1);
  for (std::size_t n = 0; n < slots.size(); ++n) {
    const float* r = &reflectance.data[3 * n];
    if (std::max({r[0], r[1], r[2]}) < kBlack) continue;
    const auto c = chromaticity(r[0], r[1], r[2]);
    double best = std::numeric_limits<double>::infinity();
    for (const BaseColors::Color& color : colors) {
      double distance = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const double d = std::log(std::max(c[k], kLeast)) - double(color.center[k]);
        distance += d * d;
      }
      if (distance < best) best = distance, slots[n] = color.slot;
    }
  }
  return slots;
}

namespace {

/// The pixels of the connected region of equal slots around `start`, which it marks as seen.
std::vector<int> region_around(int start, const std::vector<int>& slots, int width, int height,
                               std::vector<bool>& seen) {
  std::vector<int> found{start};
  seen[std::size_t(start)] = true;
  const auto visit = [&](int n, int slot) {
    if (seen[std::size_t(n)] || slots[std::size_t(n)] != slot) return;
    seen[std::size_t(n)] = true;
    found.push_back(n);
  };
  for (std::size_t k = 0; k < found.size(); ++k) {
    const int n = found[k], x = n % width, y = n / width, slot = slots[std::size_t(n)];
    if (x > 0) visit(n - 1, slot);
    if (x + 1 < width) visit(n + 1, slot);
    if (y > 0) visit(n - width, slot);
    if (y + 1 < height) visit(n + width, slot);
  }
  return found;
}

}  // namespace

std::vector<TruthClick> clicks_of_truth(const std::vector<int>& slots,
                                        const std::vector<int>& truth, int width, int height,
                                        std::size_t least, std::size_t most) {
  std::vector<TruthClick> clicks;
  std::vector<bool> seen(slots.size());
  for (int start = 0; start < width * height; ++start) {
    if (seen[std::size_t(start)] || slots[std::size_t(start)] < 0) continue;
    const std::vector<int> region = region_around(start, slots, width, height, seen);
    if (region.size() < least) continue;
    std::vector<int> wrong;
    std::map<int, std::size_t> votes;
    double middle_x = 0, middle_y = 0;
    for (const int n : region) {
      const int is = truth[std::size_t(n)];
      if (is < 0 || is == slots[std::size_t(n)]) continue;
      wrong.push_back(n);
      ++votes[is];
      middle_x += n % width, middle_y += n / width;
    }
    if (2 * wrong.size() <= region.size()) continue;
    middle_x /= double(wrong.size()), middle_y /= double(wrong.size());
    const auto far = [&](int n) { return std::hypot(n % width - middle_x, n / width - middle_y); };
    const int at = *std::min_element(wrong.begin(), wrong.end(),
                                     [&](int a, int b) { return far(a) < far(b); });
    const int slot = std::max_element(votes.begin(), votes.end(), [](const auto& a, const auto& b) {
                       return a.second < b.second;
                     })->first;
    clicks.push_back({at % width, at / width, slot, region.size()});
  }
  std::stable_sort(clicks.begin(), clicks.end(),
                   [](const TruthClick& a, const TruthClick& b) { return a.pixels > b.pixels; });
  if (clicks.size() > most) clicks.resize(most);
  return clicks;
}

std::vector<double> base_color_errors(const Image& reflectance, const std::vector<int>& slots,
                                      std::span<const BaseColors::Color> colors, bool initial,
                                      std::size_t least) {
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
    if (count < std::max<std::size_t>(least, 1)) {
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
