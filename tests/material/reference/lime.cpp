// SPDX-License-Identifier: LGPL-2.1-or-later
#include "lime.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "tests/reference/environment/lit_sphere.hpp"
#include "tests/srgb.hpp"

namespace inverse::reference {
namespace {

constexpr double kClipsFrom = 0.85, kClips = 0.98;  // linear light

double finite(double value) { return value > 0 ? std::min(value, 65504.0) : 0; }

double to_srgb(double linear) { return srgb_code(std::clamp(linear, 0.0, 1.0)); }

double smoothstep(double low, double high, double x) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

/// Between the points of a plane, whose middles are at halves; its border goes on.
Vec4 bilinear(const Plane& plane, double x, double y) {
  x = std::clamp(x - 0.5, 0.0, plane.width - 1.0);
  y = std::clamp(y - 0.5, 0.0, plane.height - 1.0);
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  const int x1 = std::min(x0 + 1, plane.width - 1), y1 = std::min(y0 + 1, plane.height - 1);
  Vec4 out{};
  for (size_t c = 0; c < 4; ++c)
    out[c] = std::lerp(std::lerp(plane.at(x0, y0)[c], plane.at(x1, y0)[c], x - x0),
                       std::lerp(plane.at(x0, y1)[c], plane.at(x1, y1)[c], x - x0), y - y0);
  return out;
}

double largest(const Vec4& p) { return std::max({p[0], p[1], p[2]}); }
double smallest(const Vec4& p) { return std::min({p[0], p[1], p[2]}); }

/// Weighted means of 2 × 2 points.
Plane pull(const Plane& fine) {
  const int side = (fine.width + 1) / 2;
  Plane coarse(side, side);
  for (int y = 0; y < fine.height; ++y)
    for (int x = 0; x < fine.width; ++x) {
      const Vec4& p = fine.at(x, y);
      Vec4& sum = coarse.at(x / 2, y / 2);
      for (size_t c = 0; c < 3; ++c) sum[c] += p[c] * p[3];
      sum[3] += p[3];
    }
  for (Vec4& p : coarse.data) {
    for (size_t c = 0; c < 3; ++c) p[c] /= std::max(p[3], 1e-6);
    p[3] = std::min(p[3], 1.0);
  }
  return coarse;
}

Plane fill(const Plane& known) {
  if (known.width == 1) return known;
  const Plane coarse = fill(pull(known));
  Plane whole(known.width, known.height);
  for (int y = 0; y < known.height; ++y)
    for (int x = 0; x < known.width; ++x) {
      const Vec4 around = bilinear(coarse, 0.5 * (x + 0.5), 0.5 * (y + 0.5));
      const Vec4& here = known.at(x, y);
      for (size_t c = 0; c < 3; ++c) whole.at(x, y)[c] = std::lerp(around[c], here[c], here[3]);
    }
  return whole;
}

/// Points of a square of which some count.
struct Counted {
  const Plane& at;
  bool (*counts)(const Vec4&);

  /// Mean of `value` over the 5 × 5 points around (x, y) that count; 0 if none does.
  template <typename Value>
  double mean(int x, int y, Value value) const {
    double sum = 0, count = 0;
    for (int row = std::max(y - 2, 0); row <= std::min(y + 2, at.height - 1); ++row)
      for (int column = std::max(x - 2, 0); column <= std::min(x + 2, at.width - 1); ++column)
        if (counts(at.at(column, row))) {
          sum += value(column, row);
          ++count;
        }
    return count > 0 ? sum / count : 0;
  }
};

constexpr double kNoise = 1e-3;  // variance of light at white, and of its roots

}  // namespace

double lime_decode(double code) { return 0.25 * std::expm1(2 * std::clamp(code, 0.0, 8.0)); }

Plane lime_crop(const Plane& frame, const LimeSquare& square) {
  Plane image(square.side, square.side);
  const int taps = std::clamp(static_cast<int>(std::ceil(square.pixels)), 1, 12);
  for (int row = 0; row < square.side; ++row)
    for (int column = 0; column < square.side; ++column) {
      Vec4 sum{};
      for (int j = 0; j < taps; ++j)
        for (int i = 0; i < taps; ++i) {
          const double x = square.x + square.pixels * (column + (i + 0.5) / taps);
          const double y = square.y + square.pixels * (row + (j + 0.5) / taps);
          const Vec4& pixel =
              frame.at(std::clamp(static_cast<int>(std::floor(x)), 0, frame.width - 1),
                       std::clamp(static_cast<int>(std::floor(y)), 0, frame.height - 1));
          for (size_t c = 0; c < 3; ++c) sum[c] += finite(pixel[c]);
        }
      for (size_t c = 0; c < 3; ++c) image.at(column, row)[c] = to_srgb(sum[c] / (taps * taps));
    }
  return image;
}

Plane lime_drop_foreign(const Plane& probability, const std::vector<uint32_t>& foreign) {
  Plane out = probability;
  for (size_t i = 0; i < out.size(); ++i)
    if (foreign[i] != 0) out.data[i] = {};
  return out;
}

Plane lime_to_specular(const Plane& image, const Plane& probability) {
  Plane out(image.width, image.height);
  for (size_t i = 0; i < out.size(); ++i)
    if (probability.data[i][0] > 0.5) {
      out.data[i] = image.data[i];
      out.data[i][3] = 1;
    }
  return out;
}

LimeSpecular lime_to_mirror_and_albedo(const Plane& masked, const Plane& specular) {
  LimeSpecular out{Plane(masked.width, masked.height), Plane(masked.width, masked.height)};
  for (size_t i = 0; i < masked.size(); ++i) {
    const Vec4& here = masked.data[i];
    const double code = here[3] * finite(specular.data[i][0]);
    out.mirror_in.data[i] = {code, 0, 0, 0};
    out.albedo_in.data[i] = {here[0], here[1], here[2], code};
  }
  return out;
}

Plane lime_to_exponent(const Plane& masked, const Plane& specular, const Plane& mirror) {
  Plane out(masked.width, masked.height);
  for (size_t i = 0; i < out.size(); ++i)
    out.data[i] = {specular.data[i][0], masked.data[i][3] * finite(mirror.data[i][0]), 0, 0};
  return out;
}

Plane lime_preview(const Plane& frame, const Plane& table, double x, double y, double radius) {
  Plane out(frame.width, frame.height);
  for (int row = 0; row < frame.height; ++row)
    for (int column = 0; column < frame.width; ++column) {
      const double right = (column + 0.5 - x) / radius, down = (row + 0.5 - y) / radius;
      const double away = std::hypot(right, down);
      // The share of the pixel that the sphere covers, as if its edge were straight there.
      const double covered = std::clamp(0.5 + radius * (1 - away), 0.0, 1.0);
      const double rim = std::max(away, 1.0);  // what is beyond it looks as on it
      const Vec3 lit =
          lit_lookup(table, {right / rim, -down / rim, std::sqrt(std::max(1 - away * away, 0.0))});
      const Vec4& pixel = frame.at(column, row);
      for (size_t c = 0; c < 3; ++c)
        out.at(column, row)[c] = (1 - covered) * finite(pixel[c]) + covered * finite(lit[c]);
      out.at(column, row)[3] = pixel[3];
    }
  return out;
}

Plane lime_under_highlights(const Plane& masked, const Plane& codes) {
  Plane known(masked.width, masked.height);
  for (size_t i = 0; i < known.size(); ++i) {
    Vec4 rgb = masked.data[i];
    for (size_t c = 0; c < 3; ++c) rgb[c] = srgb_light(rgb[c]);
    const double specular = lime_decode(codes.data[i][0]);
    if (rgb[3] > 0.5 && largest(rgb) < kClipsFrom && specular < smallest(rgb))
      known.data[i] = {rgb[0] - specular, rgb[1] - specular, rgb[2] - specular, 1};
  }
  return fill(known);
}

Plane lime_guided_specular(const Plane& masked, const Plane& codes) {
  const Counted object{masked, [](const Vec4& p) { return p[3] > 0.5; }};
  const auto guide = [&](int x, int y) { return srgb_light(smallest(masked.at(x, y))); };
  const auto layer = [&](int x, int y) {
    return std::min(lime_decode(codes.at(x, y)[0]), guide(x, y));
  };
  Plane lines(masked.width, masked.height), out(masked.width, masked.height);
  for (int y = 0; y < masked.height; ++y)
    for (int x = 0; x < masked.width; ++x) {
      const double mean_guide = object.mean(x, y, guide), mean_layer = object.mean(x, y, layer);
      const auto away = [&](int u, int v) { return guide(u, v) - mean_guide; };
      const double variance =
          object.mean(x, y, [&](int u, int v) { return away(u, v) * away(u, v); });
      const double covariance =
          object.mean(x, y, [&](int u, int v) { return away(u, v) * (layer(u, v) - mean_layer); });
      const double noise = kNoise * std::max(mean_guide, 0.02);
      const double slope = std::clamp(covariance / (variance + noise), 0.0, 1.0);
      lines.at(x, y) = {slope, mean_layer - slope * mean_guide, 0, 0};
    }
  for (int y = 0; y < masked.height; ++y)
    for (int x = 0; x < masked.width; ++x)
      for (size_t c = 0; c < 2; ++c)
        out.at(x, y)[c] = object.mean(x, y, [&](int u, int v) { return lines.at(u, v)[c]; });
  return out;
}

Plane lime_guided_mask(const Plane& image, const Plane& probability) {
  const Counted known{probability, [](const Vec4& p) { return p[0] != 0; }};
  const auto guide = [&](int x, int y, int c) {
    return std::sqrt(std::max(srgb_light(image.at(x, y)[c]), 0.0));
  };
  const auto object = [&](int x, int y) { return probability.at(x, y)[0]; };
  Plane planes(image.width, image.height), out(image.width, image.height);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      Eigen::Vector3d mean, along;
      Eigen::Matrix3d spread;
      const double mean_object = known.mean(x, y, object);
      for (int c = 0; c < 3; ++c)
        mean[c] = known.mean(x, y, [&](int u, int v) { return guide(u, v, c); });
      for (int c = 0; c < 3; ++c) {
        along[c] = known.mean(x, y, [&](int u, int v) {
          return (guide(u, v, c) - mean[c]) * (object(u, v) - mean_object);
        });
        for (int d = 0; d < 3; ++d)
          spread(c, d) = known.mean(x, y, [&](int u, int v) {
            return (guide(u, v, c) - mean[c]) * (guide(u, v, d) - mean[d]);
          });
      }
      spread.diagonal().array() += kNoise;
      const Eigen::Vector3d slopes = spread.llt().solve(along);
      planes.at(x, y) = {slopes[0], slopes[1], slopes[2], mean_object - slopes.dot(mean)};
    }
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      if (object(x, y) != 0)
        for (size_t c = 0; c < 4; ++c)
          out.at(x, y)[c] = known.mean(x, y, [&](int u, int v) { return planes.at(u, v)[c]; });
  return out;
}

LimeLayers lime_layers(const Plane& frame, const LimeSquare& square, const Plane& mask_lines,
                       const Plane& codes, const Plane& specular_lines, const Plane& under) {
  LimeLayers out{Plane(frame.width, frame.height), Plane(frame.width, frame.height)};
  for (int y = 0; y < frame.height; ++y)
    for (int x = 0; x < frame.width; ++x) {
      Vec4 rgb = frame.at(x, y);
      for (size_t c = 0; c < 3; ++c) rgb[c] = finite(rgb[c]);
      const double u = (x + 0.5 - square.x) / square.pixels,
                   v = (y + 0.5 - square.y) / square.pixels;
      Vec4 specular{};
      double mask = 0, mirror = 0;
      if (u >= 0 && v >= 0 && u < square.side && v < square.side) {
        const Vec4 color = bilinear(mask_lines, u, v);
        double probability = color[3];
        for (size_t c = 0; c < 3; ++c) probability += color[c] * std::sqrt(rgb[c]);
        mask = smoothstep(0.25, 0.75, probability);
        const Vec4 code = bilinear(codes, u, v), base = bilinear(under, u, v);
        mirror = mask * lime_decode(code[1]);
        const Vec4 line = bilinear(specular_lines, u, v);
        const double least = smallest(rgb),
                     layer = std::clamp(mask * (line[0] * least + line[1]), 0.0, least);
        for (size_t c = 0; c < 3; ++c) {
          // Where the camera was at its end, what is under the highlight stays.
          const double under_it =
              std::min(base[c] * smoothstep(kClipsFrom, kClips, rgb[c]), rgb[c]);
          specular[c] = std::min(layer, rgb[c] - under_it);
        }
      }
      out.diffuse.at(x, y) = {rgb[0] - specular[0], rgb[1] - specular[1], rgb[2] - specular[2],
                              mask};
      out.gloss.at(x, y) = {specular[0], specular[1], specular[2], mirror};
    }
  return out;
}

}  // namespace inverse::reference
