// SPDX-License-Identifier: LGPL-2.1-or-later
#include "texture.hpp"

#include <algorithm>
#include <cmath>

namespace inverse::reference {
namespace {

constexpr double kCompareFloor = 0.02;
constexpr double kMemory = 50, kStep = 0.001;
constexpr double kNear = 0.3, kHiddenMin = 0.2, kHiddenMax = 0.5;
constexpr int kReach = 4;
constexpr double kNone = 0.2, kAll = 0.6;
constexpr double kMaxTaps = 8;
constexpr double kLargest = 65504;

/// From 0 to 1 as t goes from 0 to 1.
double rising(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

/// at + step within [0, size).
size_t within(size_t at, int step, size_t size) {
  return static_cast<size_t>(
      std::clamp(static_cast<long>(at) + step, 0L, static_cast<long>(size) - 1));
}

double difference(const Observed& now, const Cell& learned) {
  double sum = 0;
  for (size_t c = 0; c < 3; ++c)
    sum += (now.mean[c] - learned.mean[c]) * (now.mean[c] - learned.mean[c]);
  return std::sqrt(sum / 3);
}

struct Mapped {
  double x, y, depth;
};
Mapped mapped(const Matrix& h, double x, double y) {
  const auto row = [&](size_t k) { return h[k][0] * x + h[k][1] * y + h[k][2]; };
  return {row(0) / row(2), row(1) / row(2), row(2)};
}

/// The value of a grid at a continuous place, in pixels; beyond its border that of the border.
template <typename Read>
auto bilinear(double x, double y, size_t width, size_t height, Read read) {
  const double column = std::clamp(x - 0.5, 0.0, static_cast<double>(width - 1));
  const double row = std::clamp(y - 0.5, 0.0, static_cast<double>(height - 1));
  const auto left = static_cast<size_t>(column), top = static_cast<size_t>(row);
  const size_t right = std::min(left + 1, width - 1), bottom = std::min(top + 1, height - 1);
  const double s = column - static_cast<double>(left), t = row - static_cast<double>(top);
  auto sum = read(left, top);
  const auto a = read(left, top), b = read(right, top), c = read(left, bottom),
             d = read(right, bottom);
  for (size_t k = 0; k < sum.size(); ++k)
    sum[k] = (1 - t) * ((1 - s) * a[k] + s * b[k]) + t * ((1 - s) * c[k] + s * d[k]);
  return sum;
}

/// The share of fine pixel `at` that coarse pixel `of` covers.
double overlap(size_t at, size_t of, size_t fine, size_t coarse) {
  const double scale = static_cast<double>(fine) / static_cast<double>(coarse);
  const double from = std::max(static_cast<double>(at), static_cast<double>(of) * scale);
  const double to = std::min(static_cast<double>(at + 1), static_cast<double>(of + 1) * scale);
  return std::max(to - from, 0.0);
}

Rgba sampled(const std::vector<Grid<Rgba>>& levels, double u, double v, double level) {
  const auto of = [&](size_t k) {
    const Grid<Rgba>& grid = levels[k];
    return bilinear(u * static_cast<double>(grid.width), v * static_cast<double>(grid.height),
                    grid.width, grid.height, [&](size_t x, size_t y) { return grid.at(x, y); });
  };
  const double last = static_cast<double>(levels.size() - 1);
  const double low = std::min(std::floor(level), last);
  Rgba color = of(static_cast<size_t>(low));
  if (low < last) {
    const Rgba next = of(static_cast<size_t>(low) + 1);
    for (size_t c = 0; c < 4; ++c) color[c] += (level - low) * (next[c] - color[c]);
  }
  return color;
}

/// A pixel on the plane: its place, and how that changes along x and along y.
struct Footprint {
  Mapped place;
  std::array<double, 2> along_x, along_y;
};
Footprint footprint(size_t x, size_t y, const Matrix& h) {
  Footprint f{mapped(h, static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5), {}, {}};
  f.along_x = {(h[0][0] - f.place.x * h[2][0]) / f.place.depth,
               (h[1][0] - f.place.y * h[2][0]) / f.place.depth};
  f.along_y = {(h[0][1] - f.place.x * h[2][1]) / f.place.depth,
               (h[1][1] - f.place.y * h[2][1]) / f.place.depth};
  return f;
}

/// Its sides in texels, along x and along y.
std::array<double, 2> sides(const Footprint& f, const Grid<Rgba>& picture) {
  const auto w = static_cast<double>(picture.width), h = static_cast<double>(picture.height);
  return {std::hypot(f.along_x[0] * w, f.along_x[1] * h),
          std::hypot(f.along_y[0] * w, f.along_y[1] * h)};
}

double ratio_of(const std::array<double, 2>& s) {
  return std::max(s[0], s[1]) / std::max(std::min(s[0], s[1]), 1.0);
}

}  // namespace

Grid<double> luminance(const Grid<Rgba>& frame, size_t factor) {
  Grid<double> out{(frame.width + factor - 1) / factor, (frame.height + factor - 1) / factor, {}};
  for (size_t y = 0; y < out.height; ++y)
    for (size_t x = 0; x < out.width; ++x) {
      double sum = 0, count = 0;
      for (size_t v = y * factor; v < std::min((y + 1) * factor, frame.height); ++v)
        for (size_t u = x * factor; u < std::min((x + 1) * factor, frame.width); ++u, ++count) {
          const Rgba p = finite(frame.at(u, v));
          sum += std::min(0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2], 1.0);
        }
      out.data.push_back(std::pow(sum / count, 1 / 2.2));
    }
  return out;
}

std::vector<Grid<Rgba>> texture_levels(const Grid<Rgba>& picture) {
  std::vector<Grid<Rgba>> levels{picture};
  for (Rgba& p : levels[0].data) {
    p = finite(p);
    p[3] = std::min(p[3], 1.0);
    for (size_t c = 0; c < 3; ++c) p[c] *= p[3];
  }
  while (levels.back().data.size() > 1) {
    const Grid<Rgba>& fine = levels.back();
    Grid<Rgba> coarse{(fine.width + 1) / 2, (fine.height + 1) / 2, {}};
    for (size_t y = 0; y < coarse.height; ++y)
      for (size_t x = 0; x < coarse.width; ++x) {
        Rgba sum{};
        double total = 0;
        // What a coarse pixel covers is within three of its fine ones.
        for (size_t v = 2 * y > 0 ? 2 * y - 1 : 0; v < std::min(2 * y + 2, fine.height); ++v)
          for (size_t u = 2 * x > 0 ? 2 * x - 1 : 0; u < std::min(2 * x + 2, fine.width); ++u) {
            const double w =
                overlap(u, x, fine.width, coarse.width) * overlap(v, y, fine.height, coarse.height);
            for (size_t c = 0; c < 4; ++c) sum[c] += w * fine.at(u, v)[c];
            total += w;
          }
        for (double& s : sum) s /= total;
        coarse.data.push_back(sum);
      }
    levels.push_back(std::move(coarse));
  }
  return levels;
}

Observed observe(const Grid<Rgba>& model, const Matrix& to_frame, size_t x, size_t y,
                 std::array<size_t, 2> cells) {
  constexpr double kOffsets[5][2] = {{-0.5, -0.5}, {0.5, -0.5}, {-0.5, 0.5}, {0.5, 0.5}, {0, 0}};
  Observed now;
  Rgb squares{};
  const auto width = static_cast<double>(model.width), height = static_cast<double>(model.height);
  for (const auto& offset : kOffsets) {
    const Mapped at =
        mapped(to_frame, (static_cast<double>(x) + 0.5 + offset[0]) / static_cast<double>(cells[0]),
               (static_cast<double>(y) + 0.5 + offset[1]) / static_cast<double>(cells[1]));
    if (!(at.depth > 0 && at.x >= 0 && at.y >= 0 && at.x <= width && at.y <= height)) return {};
    const Rgb value =
        bilinear(at.x, at.y, model.width, model.height, [&](size_t column, size_t row) {
          const Rgba p = finite(model.at(column, row));
          return Rgb{std::log(p[0] + kCompareFloor), std::log(p[1] + kCompareFloor),
                     std::log(p[2] + kCompareFloor)};
        });
    for (size_t c = 0; c < 3; ++c) {
      now.mean[c] += value[c] / 5;
      squares[c] += value[c] * value[c] / 5;
    }
  }
  double variance = 0;
  for (size_t c = 0; c < 3; ++c) variance += (squares[c] - now.mean[c] * now.mean[c]) / 3;
  now.spread = std::sqrt(std::max(variance, 0.0));
  return now;
}

double excess(const Observed& now, const Cell& learned) {
  if (now.spread < 0 || learned.frames < 1) return 0;
  return difference(now, learned) - 2 * learned.spread;
}

Grid<double> hide(const Grid<double>& excess, double tolerance, double softness) {
  Grid<double> out{excess.width, excess.height, {}};
  const auto over = [&](double e, double limit) { return rising((e - limit) / softness); };
  for (size_t y = 0; y < excess.height; ++y)
    for (size_t x = 0; x < excess.width; ++x) {
      double sum = 0, count = 0;
      for (int v = -kReach; v <= kReach; v += 2)
        for (int u = -kReach; u <= kReach; u += 2, ++count)
          sum +=
              over(excess.at(within(x, u, excess.width), within(y, v, excess.height)), tolerance);
      const double near = rising((sum / count - kHiddenMin) / (kHiddenMax - kHiddenMin));
      out.data.push_back(over(excess.at(x, y), tolerance * (1 - (1 - kNear) * near)));
    }
  return out;
}

void learn(Cell& learned, const Observed& now, double hidden) {
  if (now.spread < 0) return;
  if (learned.frames < 1) {
    learned = {now.mean, 1, now.spread};
    return;
  }
  const double off = difference(now, learned);
  if (hidden < 0.5) {
    learned.frames = std::min(learned.frames + 1, kMemory);
    for (size_t c = 0; c < 3; ++c)
      learned.mean[c] += (now.mean[c] - learned.mean[c]) / learned.frames;
    learned.spread += (off - learned.spread) / learned.frames;
  } else {
    for (size_t c = 0; c < 3; ++c)
      learned.mean[c] += std::clamp(now.mean[c] - learned.mean[c], -kStep, kStep);
  }
}

Grid<double> soften(const Grid<double>& hidden) {
  constexpr double kBinomial[5] = {1, 4, 6, 4, 1};
  Grid<double> out{hidden.width, hidden.height, {}};
  for (size_t y = 0; y < hidden.height; ++y)
    for (size_t x = 0; x < hidden.width; ++x) {
      double sum = 0;
      for (int v = -2; v <= 2; ++v)
        for (int u = -2; u <= 2; ++u)
          sum += kBinomial[u + 2] * kBinomial[v + 2] / 256 *
                 hidden.at(within(x, u, hidden.width), within(y, v, hidden.height));
      out.data.push_back(rising((sum - kNone) / (kAll - kNone)));
    }
  return out;
}

Rgba draw_texture(const Rgba& layers, size_t x, size_t y, double matte,
                  const std::vector<Grid<Rgba>>& levels, const Grid<double>* hidden,
                  const TextureSpec& spec) {
  Rgba out = finite(layers);
  const Footprint f = footprint(x, y, spec.to_plane);
  if (!(f.place.depth > 0)) return out;
  double w = spec.opacity;
  for (size_t k = 0; k < 2; ++k) {
    const double at = k == 0 ? f.place.x : f.place.y;
    const double slope = std::max(std::hypot(f.along_x[k], f.along_y[k]), 1e-12);
    w *= std::clamp(0.5 + at / slope, 0.0, 1.0) * std::clamp(0.5 + (1 - at) / slope, 0.0, 1.0);
  }
  if (!(w > 0)) return out;
  const auto [a, b] = sides(f, levels[0]);
  const std::array<double, 2> axis = a > b ? f.along_x : f.along_y;
  const double taps = std::clamp(std::ceil(ratio_of({a, b})), 1.0, kMaxTaps);
  const double level = std::max(std::log2(std::max(std::max(a, b) / taps, 1e-6)), 0.0);
  Rgba color{};
  for (double k = 0.5; k < taps; ++k) {
    const double along = k / taps - 0.5;
    const Rgba one =
        sampled(levels, f.place.x + axis[0] * along, f.place.y + axis[1] * along, level);
    for (size_t c = 0; c < 4; ++c) color[c] += one[c] / taps;
  }
  w *= std::min(finite(matte), 1.0);
  if (hidden)
    w *= 1 - bilinear(f.place.x * static_cast<double>(hidden->width),
                      f.place.y * static_cast<double>(hidden->height), hidden->width,
                      hidden->height, [&](size_t column, size_t row) {
                        return std::array<double, 1>{hidden->at(column, row)};
                      })[0];
  for (size_t c = 0; c < 3; ++c)
    out[c] = std::clamp(out[c] + w * (spec.white * color[c] - color[3] * out[c]), 0.0, kLargest);
  return out;
}

double off_whole_taps(size_t x, size_t y, const Grid<Rgba>& picture, const TextureSpec& spec) {
  const double ratio = ratio_of(sides(footprint(x, y, spec.to_plane), picture));
  return std::abs(ratio - std::round(ratio)) / ratio;
}

}  // namespace inverse::reference
