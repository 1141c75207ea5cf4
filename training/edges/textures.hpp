// SPDX-License-Identifier: LGPL-2.1-or-later
// Palettes and textures of the procedural training scenes, and the small vectors they are made of.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>

namespace inverse::training {

using Vec = std::array<double, 3>;
inline Vec operator+(Vec a, Vec b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline Vec operator-(Vec a, Vec b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline Vec operator*(double k, Vec a) { return {k * a[0], k * a[1], k * a[2]}; }
inline double dot(Vec a, Vec b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline Vec normalize(Vec a) { return (1 / std::sqrt(std::max(dot(a, a), 1e-18))) * a; }

struct Random {
  std::mt19937 engine;
  double uniform(double a = 0, double b = 1) {
    return a + (b - a) * double(engine() >> 8) / 16777216.0;
  }
  int integer(int n) { return std::min(n - 1, int(uniform() * n)); }
  bool chance(double p) { return uniform() < p; }
  double normal() {  // nearly
    double sum = -6;
    for (int k = 0; k < 12; ++k) sum += uniform();
    return sum;
  }
};

// --- palettes and textures
// -------------------------------------------------------------------------

inline Vec from_hue(double hue, double saturation, double value) {
  Vec c;
  for (int k = 0; k < 3; ++k) {
    const double t = std::fmod(hue * 6 + (k == 0 ? 0 : k == 1 ? 4 : 2), 6.0);
    const double w = std::clamp(std::abs(t - 3) - 1, 0.0, 1.0);
    c[std::size_t(k)] = value * (1 - saturation + saturation * w);
  }
  return c;
}

struct Palette {
  int scheme;
  double hue, width;
  Vec draw(Random& r) const {
    switch (scheme) {
      case 0:  // bright, value within a factor e^width
        return from_hue(r.uniform(), r.chance(0.3) ? r.uniform(0, 0.1) : r.uniform(0.1, 0.95),
                        0.85 * std::exp(-r.uniform(0, width)));
      case 1:  // any hue, value log-uniform
        return from_hue(r.uniform(), r.uniform(0, 0.9),
                        std::exp(r.uniform(std::log(0.04), std::log(0.9))));
      case 2:  // grays
        return from_hue(0, r.uniform(0, 0.06), std::exp(r.uniform(std::log(0.04), std::log(0.9))));
      case 3:  // one chroma
        return from_hue(hue, 0.55, std::exp(r.uniform(std::log(0.05), std::log(0.9))));
      case 4:  // browns and stone
        return from_hue(r.uniform(0.04, 0.13), r.uniform(0.15, 0.6),
                        std::exp(r.uniform(std::log(0.08), std::log(0.7))));
      case 5:  // ink on paper
        return r.chance(0.4)
                   ? from_hue(r.uniform(), r.uniform(0, 0.5), r.uniform(0.03, 0.09))
                   : from_hue(r.uniform(0.08, 0.16), r.uniform(0, 0.15), r.uniform(0.6, 0.85));
      default:  // saturated next to neutral, medium spread
        return from_hue(r.uniform(), r.chance(0.5) ? r.uniform(0.5, 0.95) : r.uniform(0, 0.1),
                        r.uniform(0.2, 0.8));
    }
  }
};

inline Palette draw_palette(Random& r) {
  return {r.chance(0.4) ? 0 : r.integer(7), r.uniform(), r.uniform(0.1, 1.1)};
}

inline double hash(int x, int y, int seed) {
  std::uint32_t h = std::uint32_t(x) * 374761393U + std::uint32_t(y) * 668265263U +
                    std::uint32_t(seed) * 2246822519U;
  h = (h ^ (h >> 13)) * 1274126177U;
  h ^= h >> 16;
  return double(h & 0xFFFFFF) / 16777216.0;
}
inline double value_noise(double u, double v, int seed) {
  const int x = int(std::floor(u)), y = int(std::floor(v));
  double fx = u - x, fy = v - y;
  fx = fx * fx * (3 - 2 * fx);
  fy = fy * fy * (3 - 2 * fy);
  return (1 - fy) * ((1 - fx) * hash(x, y, seed) + fx * hash(x + 1, y, seed)) +
         fy * ((1 - fx) * hash(x, y + 1, seed) + fx * hash(x + 1, y + 1, seed));
}

struct Texture {
  int kind = 0, seed = 0;
  double scale = 1, aspect = 1;
  std::array<Vec, 6> colors{};
  Vec at(double u, double v) const {
    const double su = u * scale, sv = v * scale * aspect;
    const int x = int(std::floor(su)), y = int(std::floor(sv));
    const auto mix = [&](double t) {
      t = std::clamp(t, 0.0, 1.0);
      return (1 - t) * colors[0] + t * colors[1];
    };
    switch (kind) {
      case 1:
        return colors[std::size_t((x + y) & 1)];
      case 2:
        return colors[std::size_t(x & 1)];
      case 3: {  // brick with mortar
        const double bu = su * 0.5 + 0.5 * (y & 1), fu = bu - std::floor(bu), fv = sv - y;
        if (fu < 0.06 || fv < 0.12) return colors[5];
        return colors[std::size_t(hash(int(std::floor(bu)), y, seed) * 3)];
      }
      case 4: {  // Voronoi patches
        double best = 1e9, id = 0;
        for (int dy = -1; dy <= 1; ++dy)
          for (int dx = -1; dx <= 1; ++dx) {
            const double cx = x + dx + hash(x + dx, y + dy, seed),
                         cy = y + dy + hash(x + dx, y + dy, seed + 7);
            const double d = (cx - su) * (cx - su) + (cy - sv) * (cy - sv);
            if (d < best) best = d, id = hash(x + dx, y + dy, seed + 3);
          }
        return colors[std::size_t(id * 6)];
      }
      case 5:
        return mix(0.6 * value_noise(su, sv, seed) +
                   0.4 * value_noise(2.3 * su, 2.3 * sv, seed + 1));
      case 6: {  // wood
        const double g =
            value_noise(0.15 * su, 3 * sv, seed) + 0.5 * value_noise(0.3 * su, 9 * sv, seed + 2);
        return mix(0.5 + 0.5 * std::sin(9 * g));
      }
      case 7: {  // lettering
        const double fv = sv - y, fu = su * 2 - std::floor(su * 2);
        const bool line = fv > 0.25 && fv < 0.75 && hash(int(std::floor(su * 2)), y, seed) < 0.75;
        const bool glyph =
            hash(int(std::floor(su * 8)), int(std::floor(sv * 6)), seed + 1) < 0.55 && fu > 0.1;
        return line && glyph ? colors[0] : colors[1];
      }
      case 8: {  // dots
        const double fu = su - x - 0.5, fv = sv - y - 0.5;
        return fu * fu + fv * fv < 0.1 ? colors[0] : colors[1];
      }
      case 9:
        return value_noise(su, sv, seed) > 0.55 ? colors[0] : colors[1];  // blotches
      default:
        return colors[0];
    }
  }
};

inline Texture draw_texture(Random& r, const Palette& palette, double flat) {
  Texture t;
  t.kind = r.chance(flat) ? 0 : 1 + r.integer(9);
  t.seed = r.integer(1 << 20);
  t.scale = std::exp(r.uniform(std::log(1.2), std::log(9)));
  t.aspect = r.chance(0.7) ? 1 : r.uniform(0.5, 2);
  for (Vec& c : t.colors) c = palette.draw(r);
  return t;
}

}  // namespace inverse::training
