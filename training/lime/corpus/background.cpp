// SPDX-License-Identifier: LGPL-2.1-or-later
#include "background.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "noise.hpp"

namespace inverse::lime {
namespace {

Vec random_color(Random& random) {
  const auto channel = [&] { return std::pow(random.uniform(), 1.4f); };
  const Vec color{channel(), channel(), channel()};
  // Most surroundings are less colorful than three independent numbers.
  const float gray = luminance(color), keep = random.uniform();
  return gray * Vec{1, 1, 1} + keep * (color - gray * Vec{1, 1, 1});
}

Vec mix(Vec a, Vec b, float t) { return (1 - t) * a + t * b; }

/// Ellipses and turned rectangles over each other, half as wide as from `least` to 0.3 of the
/// picture, in what `draw_color` gives; a share of them is shaded across.
template <typename Color>
void clutter(Random& random, int size, int count, float least, float shaded,
             const Color& draw_color, std::vector<Vec>& pixels) {
  for (int i = 0; i < count; ++i) {
    const float x = random.uniform(), y = random.uniform(), angle = random.uniform(0.f, kPi);
    const float c = std::cos(angle), s = std::sin(angle);
    const float a = random.log_uniform(least, 0.3f), b = random.log_uniform(least, 0.3f);
    const bool round = random.chance(0.4f);
    const float shade = random.chance(shaded) ? random.uniform(-0.8f, 0.8f) : 0.f;
    const Vec color = draw_color();
    const float reach = a + b;
    const auto pixel = [&](float t) { return std::clamp(int(t * float(size)), 0, size - 1); };
    for (int row = pixel(y - reach); row <= pixel(y + reach); ++row)
      for (int column = pixel(x - reach); column <= pixel(x + reach); ++column) {
        const float dx = (float(column) + 0.5f) / float(size) - x,
                    dy = (float(row) + 0.5f) / float(size) - y;
        const float u = (c * dx + s * dy) / a, v = (c * dy - s * dx) / b;
        const bool inside = round ? u * u + v * v < 1 : std::max(std::abs(u), std::abs(v)) < 1;
        if (inside) pixels[std::size_t(row * size + column)] = std::max(1 + shade * u, 0.f) * color;
      }
  }
}

/// The environment behind the object, through a lens of `width` (tangent of half the angle of
/// view), exposed to mean 0.4.
void look_around(const Environment& map, float width, int size, std::vector<Vec>& pixels) {
  float total = 0;
  for (int row = 0; row < size; ++row)
    for (int column = 0; column < size; ++column) {
      const float x = (2 * (float(column) + 0.5f) / float(size) - 1) * width;
      const float y = (1 - 2 * (float(row) + 0.5f) / float(size)) * width;
      const Vec color = map.look(normalize({x, y, -1}));
      pixels[std::size_t(row * size + column)] = color;
      total += std::min(luminance(color), 10.f);
    }
  const float gain = 0.4f * float(size * size) / std::max(total, 1e-6f);
  for (Vec& p : pixels) p = gain * p;
}

}  // namespace

std::vector<Vec> make_background(Random& random, int size, const Environment& map) {
  std::vector<Vec> pixels(std::size_t(size * size));
  const Noise noise(random, 4 + 4 * random.below(3), 5);
  const Vec one = random_color(random), two = random_color(random);
  const float angle = random.uniform(0.f, kPi), c = std::cos(angle), s = std::sin(angle);
  const float frequency = random.log_uniform(10, 60), cells = float(4 + random.below(20));
  const float table = random.uniform(0.35f, 0.8f), rough = random.uniform(0.f, 1.f);
  const int kind = random.below(7);
  if (kind == 6) look_around(map, random.uniform(0.4f, 1.2f), size, pixels);
  for (int row = 0; row < size && kind != 6; ++row)
    for (int column = 0; column < size; ++column) {
      const float x = (float(column) + 0.5f) / float(size), y = (float(row) + 0.5f) / float(size);
      const float n = noise(4 * x, 4 * y);
      const auto textured = [&](Vec color) { return (1 + rough * (2 * n - 1)) * color; };
      Vec& p = pixels[std::size_t(row * size + column)];
      switch (kind) {
        case 0:
          p = mix(one, two, std::clamp(2 * n - 0.5f, 0.f, 1.f));
          break;
        case 1:
          p = textured(mix(one, two, 0.5f + 0.5f * std::sin(frequency * (c * x + s * y))));
          break;
        case 2:
          p = textured((int(x * cells) + int(y * cells)) % 2 ? one : two);
          break;
        case 3:
          p = textured(one);
          break;
        case 4:
          p = textured(y + 0.05f * c * x > table ? one : two);
          break;
        case 5:
          p = (0.9f + 0.2f * n) *
              mix(one, two, std::clamp(0.5f + c * (x - 0.5f) + s * (y - 0.5f), 0.f, 1.f));
          break;
      }
    }
  if (kind == 3 || (kind == 4 && random.chance(0.7f)) || random.chance(0.15f))
    clutter(
        random, size, kind == 3 ? 40 : 8, 0.03f, 0.5f, [&] { return random_color(random); },
        pixels);
  const float level = random.uniform(0.3f, 1.f);
  for (Vec& p : pixels)
    p = {std::clamp(level * p.x, 0.f, 1.f), std::clamp(level * p.y, 0.f, 1.f),
         std::clamp(level * p.z, 0.f, 1.f)};
  return pixels;
}

void print_marks(Random& random, int size, std::vector<Vec>& pixels) {
  const std::array<Vec, 3> inks{random_color(random), random_color(random), random_color(random)};
  const Vec paper = random.uniform(0.5f, 0.95f) * mix({1, 1, 1}, random_color(random), 0.1f);
  const bool on_paper = random.chance(0.3f);
  const float white = random.chance(0.6f) && !on_paper ? random.uniform(0.4f, 1.f) : 0.1f;
  const int count = random.chance(0.5f) ? 1 + random.below(6) : 6 + random.below(60);
  const int colors = 1 + random.below(3);
  if (on_paper) std::fill(pixels.begin(), pixels.end(), paper);
  clutter(
      random, size, count, 0.01f, 0.f,
      [&] { return random.chance(white) ? paper : inks[std::size_t(random.below(colors))]; },
      pixels);
}

std::vector<Vec> make_plain_background(Random& random, int size) {
  std::vector<Vec> pixels(std::size_t(size * size));
  const bool black = random.chance(0.17f), has_table = random.chance(0.6f);
  const float level = black ? random.uniform(0.f, 0.01f) : random.uniform(0.05f, 0.9f);
  const auto pale = [&](Vec color) { return mix(luminance(color) * Vec{1, 1, 1}, color, 0.4f); };
  const Vec wall = pale(random_color(random)), table = pale(random_color(random));
  const float edge = has_table ? random.uniform(0.3f, 0.9f) : 2, tilt = random.uniform(-0.1f, 0.1f);
  const float soft = random.log_uniform(0.002f, 0.05f);
  const float slope_x = random.uniform(-0.6f, 0.6f), slope_y = random.uniform(-0.6f, 0.6f);
  const Noise noise(random, 4, 5);
  const float rough = random.uniform(0.f, 0.15f);
  for (int row = 0; row < size; ++row)
    for (int column = 0; column < size; ++column) {
      const float x = (float(column) + 0.5f) / float(size), y = (float(row) + 0.5f) / float(size);
      const float under = std::clamp(0.5f + (y + tilt * x - edge) / soft, 0.f, 1.f);
      const float lit = std::max(1 + slope_x * (x - 0.5f) + slope_y * (y - 0.5f), 0.f) *
                        (1 + rough * (2 * noise(4 * x, 4 * y) - 1));
      pixels[std::size_t(row * size + column)] = level * lit * mix(wall, table, under);
    }
  return pixels;
}

}  // namespace inverse::lime
