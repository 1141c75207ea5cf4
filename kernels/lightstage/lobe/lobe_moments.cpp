// SPDX-License-Identifier: LGPL-2.1-or-later
#include "lobe_moments.hpp"

#include <algorithm>
#include <cmath>

#include "kernels/lightstage/lights/light_cells.hpp"

namespace inverse {
namespace {

double length(const Direction& v) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

}  // namespace

LobeMoments::LobeMoments(std::span<const Direction> lights)
    : lights_(lights.begin(), lights.end()) {
  const double spacing = light_spacing(lights);
  largest_exponent_ = std::clamp(4 / (spacing * spacing), 1.0, kLargestExponent);
  for (const Direction& w : lights_)
    for (size_t k = 0; k < 3; ++k) mean_[k] += w[k] / static_cast<double>(lights_.size());
  table_.resize(size_t{kGrid} * kGrid * kGrid);
  for (uint32_t z = 0; z < kGrid; ++z)
    for (uint32_t y = 0; y < kGrid; ++y) {
      Direction before{};  // the point to the left's correction is a good guess
      for (uint32_t x = 0; x < kGrid; ++x) {
        const auto at = [](uint32_t i) { return 2.0 * i / (kGrid - 1) - 1; };
        Direction seen{at(x), at(y), at(z)};
        // Nothing is seen further out than the lights; points there are the borders of cells that
        // reach inside.
        const double size = length(seen);
        if (size > 1)
          for (double& s : seen) s /= size;
        Direction guess;
        for (size_t k = 0; k < 3; ++k) guess[k] = seen[k] + before[k];
        const Direction v = even(seen, guess);
        Vec4& entry = table_[(size_t{z} * kGrid + y) * kGrid + x];
        for (size_t k = 0; k < 3; ++k) {
          before[k] = v[k] - seen[k];
          entry[k] = static_cast<float>(before[k]);
        }
      }
    }
}

Direction LobeMoments::seen(const Direction& v) const {
  const double size = length(v);
  if (size < 1e-9) return mean_;
  const double limit = (largest_exponent_ + 1) / (largest_exponent_ + 2);
  const double narrow = std::clamp(size, 0.5, limit), p = (2 * narrow - 1) / (1 - narrow);
  const double share = std::min(2 * size, 1.0);
  const Direction u{v[0] / size, v[1] / size, v[2] / size};
  Direction moment{};
  double sum = 0;
  for (const Direction& w : lights_) {
    const double cosine = u[0] * w[0] + u[1] * w[1] + u[2] * w[2];
    if (cosine <= 0) continue;
    const double given = std::pow(cosine, p);
    sum += given;
    for (size_t k = 0; k < 3; ++k) moment[k] += given * w[k];
  }
  // Fewer lights than that see the lobe no better than not at all: it is taken for what it would be
  // under even light.
  const double enough = 0.125 * static_cast<double>(lights_.size()) / (p + 1);
  Direction result;
  for (size_t k = 0; k < 3; ++k) {
    const double known = std::min(sum / enough, 1.0);
    const double lobe = known * (sum > 0 ? moment[k] / sum : 0) + (1 - known) * u[k] * narrow;
    result[k] = (1 - share) * mean_[k] + share * lobe;
    // Beyond the narrowest lobe it goes on as it is there.
    result[k] += u[k] * (size - std::min(size, limit));
  }
  return result;
}

Direction LobeMoments::even(const Direction& seen_direction, const Direction& guess) const {
  constexpr int kMaxIterations = 30;
  constexpr double kNear = 1e-4, kFurthest = 1.5;
  Direction v = guess, best = guess;
  double min_error = 1e9;
  for (int i = 0; i < kMaxIterations; ++i) {
    const Direction got = seen(v);
    Direction off;
    for (size_t k = 0; k < 3; ++k) off[k] = seen_direction[k] - got[k];
    const double error = length(off);
    if (error < min_error) {
      min_error = error;
      best = v;
    }
    if (error < kNear) break;
    const double step = i < 8 ? 1.0 : 0.5;  // if it oscillates
    for (size_t k = 0; k < 3; ++k) v[k] += step * off[k];
    if (const double size = length(v); size > kFurthest)
      for (double& x : v) x *= kFurthest / size;
  }
  return best;
}

}  // namespace inverse
