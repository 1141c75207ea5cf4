// SPDX-License-Identifier: LGPL-2.1-or-later
#include "blinn_phong.hpp"

#include <algorithm>
#include <cmath>

namespace inverse::lime {
namespace {

using Words = std::int32_t __attribute__((vector_size(64)));

inline Lanes fill(float x) { return Lanes{} + x; }

/// log2 for positive finite x: the exponent, and the series of artanh on [√½, √2); relative error
/// below 3e-7 near 1.
inline Lanes log2_of(Lanes x) {
  const Words bits = (Words)x, exponent = (bits - 0x3f3504f3) >> 23;
  const Lanes m = (Lanes)(bits - (exponent << 23));
  const Lanes z = (m - 1.f) / (m + 1.f), q = z * z;
  return z * (2.885390082f +
              q * (0.961796694f + q * (0.577078016f + q * (0.412198583f + q * 0.320598898f)))) +
         __builtin_convertvector(exponent, Lanes);
}

/// 2^y for y ≤ 0; below 2^-126 it gives that. Relative error below 3e-6.
inline Lanes exp2_of(Lanes y) {
  y = y < -126.f ? fill(-126.f) : y;
  const Lanes shifted = y + 12582912.f;  // 1.5 · 2^23: rounds to an integer in the low bits
  const Lanes f = y - (shifted - 12582912.f);
  const Lanes p =
      1.f + f * (0.69314718f +
                 f * (0.24022651f + f * (0.05550411f + f * (0.00961813f + f * 0.00133336f))));
  return (Lanes)((Words)p + (((Words)shifted - 0x4b400000) << 23));
}

inline float sum(Lanes v) {
  float total = 0;
  for (int i = 0; i < 16; ++i) total += v[i];
  return total;
}

constexpr int kTileRows = 4, kTileColumns = 8;

}  // namespace

Lights::Lights(const Environment& map) {
  for (int row = 0; row < map.rows; row += kTileRows)
    for (int column = 0; column < map.columns(); column += kTileColumns) {
      Tile tile{};
      for (int i = 0; i < 32; ++i) {
        const int r = row + i / kTileColumns, c = column + i % kTileColumns;
        const Vec d = texel_direction(r, c, map.rows, map.columns());
        const Vec e = texel_solid_angle(r, map.rows, map.columns()) * map.at(r, c);
        tile.x[i / 16][i % 16] = d.x;
        tile.y[i / 16][i % 16] = d.y;
        tile.z[i / 16][i % 16] = d.z;
        tile.red[i / 16][i % 16] = e.x;
        tile.green[i / 16][i % 16] = e.y;
        tile.blue[i / 16][i % 16] = e.z;
        tile.axis += d;
      }
      tile.axis = normalize(tile.axis);
      float cosine = 1;
      for (int i = 0; i < 32; ++i)
        cosine = std::min(cosine, tile.axis.x * tile.x[i / 16][i % 16] +
                                      tile.axis.y * tile.y[i / 16][i % 16] +
                                      tile.axis.z * tile.z[i / 16][i % 16]);
      tile.cosine = cosine;
      tile.sine = std::sqrt(std::max(0.f, 1 - cosine * cosine));
      tiles_.push_back(tile);
    }
}

Vec Lights::diffuse(Vec n) const {
  Lanes red{}, green{}, blue{};
  for (const Tile& tile : tiles_) {
    if (dot(tile.axis, n) < -tile.sine) continue;
    for (int k = 0; k < 2; ++k) {
      Lanes cosine = tile.x[k] * n.x + tile.y[k] * n.y + tile.z[k] * n.z;
      cosine = cosine > 0.f ? cosine : Lanes{};
      red += cosine * tile.red[k];
      green += cosine * tile.green[k];
      blue += cosine * tile.blue[k];
    }
  }
  return {sum(red), sum(green), sum(blue)};
}

Vec Lights::specular(Vec n, Vec view, float shininess, bool all) const {
  const float facing = dot(n, view);
  const Vec mirror = 2 * facing * n - view;
  // cos of the cone around `mirror` outside of which the lobe is negligible; −1 if it covers the
  // sphere.
  const float edge = std::exp(-9.2103f / shininess);  // ln 1e4
  const float lobe_cosine = all || edge < 0.7072f ? -1.f : 2 * edge * edge - 1;
  const float lobe_sine = std::sqrt(std::max(0.f, 1 - lobe_cosine * lobe_cosine));
  const float half = 0.5f * shininess;
  Lanes red{}, green{}, blue{};
  for (const Tile& tile : tiles_) {
    if (dot(tile.axis, n) < -tile.sine) continue;
    // Cones miss each other where the angle of their axes exceeds the sum of their half angles
    // (when that is below π).
    if (lobe_cosine > -tile.cosine &&
        dot(tile.axis, mirror) < lobe_cosine * tile.cosine - lobe_sine * tile.sine)
      continue;
    for (int k = 0; k < 2; ++k) {
      const Lanes wn = tile.x[k] * n.x + tile.y[k] * n.y + tile.z[k] * n.z;
      const Lanes wo = tile.x[k] * view.x + tile.y[k] * view.y + tile.z[k] * view.z;
      // (h·n)² = (w·n + o·n)² / |w + o|²
      const Lanes up = wn + facing;
      Lanes both = 2.f + 2.f * wo;
      both = both < 1e-6f ? fill(1e-6f) : both;
      Lanes squared = up * up / both;
      squared = squared > 1.f ? fill(1.f) : squared;
      squared = squared < 1e-12f ? fill(1e-12f) : squared;
      Lanes lobe = exp2_of(half * log2_of(squared));
      lobe = wn > 0.f ? lobe : Lanes{};
      red += lobe * tile.red[k];
      green += lobe * tile.green[k];
      blue += lobe * tile.blue[k];
    }
  }
  return {sum(red), sum(green), sum(blue)};
}

}  // namespace inverse::lime
