// SPDX-License-Identifier: LGPL-2.1-or-later
#include "light_edit.hpp"

#include <algorithm>
#include <cmath>

namespace inverse::reference {
namespace {

constexpr double kLightFloor = 1e-6;
constexpr double kLargest = 65504;

double mean(const Rgb& v) { return (v[0] + v[1] + v[2]) / 3; }

double chroma_distance(const Rgb& a, const Rgb& b) {
  double sum = 0;
  for (size_t c = 0; c < 3; ++c) {
    const double off = (a[c] + 1e-3) / (mean(a) + 1e-3) - (b[c] + 1e-3) / (mean(b) + 1e-3);
    sum += off * off;
  }
  return std::sqrt(sum);
}

}  // namespace

std::vector<size_t> light_sample(size_t width, size_t height) {
  const size_t columns = std::min<size_t>(width, 64), rows = std::min<size_t>(height, 64);
  std::vector<size_t> sample;
  for (size_t y = 0; y < rows; ++y)
    for (size_t x = 0; x < columns; ++x)
      sample.push_back(y * height / rows * width + x * width / columns);
  return sample;
}

std::vector<double> selected_shares(const std::vector<Base>& bases, const std::vector<Rgba>& model,
                                    const std::vector<double>& selection) {
  std::vector<double> held(bases.size()), all(bases.size());
  for (size_t n = 0; n < model.size(); ++n) {
    const Rgba p = finite(model[n]);
    const Rgb r{p[0], p[1], p[2]};
    double smallest = 1e300;
    size_t nearest = bases.size();
    for (size_t k = 0; k < bases.size(); ++k) {
      const double distance = chroma_distance(r, bases[k].color);
      if (!bases[k].exists || distance >= smallest) continue;
      smallest = distance;
      nearest = k;
    }
    if (nearest == bases.size()) continue;
    const double light = std::min(mean(r) * p[3], kLargest);
    all[nearest] += light;
    held[nearest] += light * std::min(finite(selection[n]), 1.0);
  }
  for (size_t k = 0; k < bases.size(); ++k) held[k] /= all[k] + kLightFloor;
  return held;
}

double base_selection(const Rgba& model, const std::vector<Base>& bases, size_t index,
                      double softness) {
  constexpr double kDark = 5e-4, kWhite = 0.15;
  const auto log_chroma = [](Rgb v, double floor) {
    for (double& x : v) x = std::min(x, kLargest) + floor;
    const double level = mean(v);
    for (double& x : v) x = std::log(x / level);
    return v;
  };
  const auto apart = [](const Rgb& a, const Rgb& b) {
    return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
  };
  if (!bases[index].exists) return 0;
  const Rgba p = finite(model);
  const Rgb c = log_chroma({p[0] * p[3], p[1] * p[3], p[2] * p[3]}, kDark);
  const Rgb own = log_chroma(bases[index].color, 1e-3), white{};
  double other = apart(own, white) > kWhite ? apart(c, white) : 1e15;
  for (size_t k = 0; k < bases.size(); ++k)
    if (bases[k].exists && k != index)
      other = std::min(other, apart(c, log_chroma(bases[k].color, 1e-3)));
  const double t = std::clamp(0.5 - (other - apart(c, own)) / std::max(softness, 1e-6), 0.0, 1.0);
  return 1 - t * t * (3 - 2 * t);
}

Rgb base_key(const std::vector<Rgba>& model, const std::vector<Base>& bases, size_t index,
             double softness) {
  Rgb sum{};
  double weight = 0;
  for (const Rgba& pixel : model) {
    const Rgba p = finite(pixel);
    const Rgb r{p[0], p[1], p[2]};
    const double w =
        base_selection(pixel, bases, index, softness) * std::min(mean(r) * p[3], kLargest);
    for (size_t i = 0; i < 3; ++i) sum[i] += w * r[i];
    weight += w;
  }
  if (weight <= 0) return bases[index].color;
  for (double& x : sum) x /= weight;
  return sum;
}

double sent_on(const std::vector<Rgba>& model, const std::vector<Rgba>& light) {
  constexpr double kMaxShare = 0.75;
  double all = 0, direct = 0;
  for (size_t n = 0; n < model.size(); ++n) {
    const Rgba l = finite(light[n]);
    const double shading = finite(model[n])[3], level = mean({l[0], l[1], l[2]});
    all += std::min(shading * level, kLargest);
    direct += std::min(shading * std::min(l[3], level), kLargest);
  }
  return 1 / (1 - std::clamp(1 - direct / (all + kLightFloor), 0.0, kMaxShare));
}

double chosen(const Rgb& base, const Rgb& key, double tolerance, double softness) {
  const double t =
      std::clamp((chroma_distance(base, key) - tolerance) / std::max(softness, 1e-6), 0.0, 1.0);
  return 1 - t * t * (3 - 2 * t);
}

Rgb repainted(const Rgb& base, const Rgb& key, const Rgb& target, double w) {
  double along = 0, length2 = 0;
  for (size_t c = 0; c < 3; ++c) {
    along += base[c] * key[c];
    length2 += key[c] * key[c];
  }
  Rgb result = base;
  for (size_t c = 0; c < 3; ++c)
    result[c] += w * (along / std::max(length2, kLightFloor) * target[c] - base[c]);
  return result;
}

Rgb changed(const Rgb& base, const Rgb& target, double w) {
  Rgb result = base;
  for (size_t c = 0; c < 3; ++c) result[c] += w * (mean(base) * target[c] - base[c]);
  return result;
}

Rgba retinted(const Rgba& light, const std::vector<double>& shares, const std::vector<Rgb>& change,
              double matte) {
  Rgba result = finite(light);
  for (size_t k = 0; k < shares.size(); ++k)
    for (size_t c = 0; c < 3; ++c)
      result[c] += finite(shares[k]) * std::min(finite(matte), 1.0) * change[k][c];
  for (size_t c = 0; c < 3; ++c) result[c] = finite(result[c]);
  return result;
}

}  // namespace inverse::reference
