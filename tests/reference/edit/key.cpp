// SPDX-License-Identifier: LGPL-2.1-or-later
#include "key.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

namespace inverse::reference {
namespace {

constexpr double kBrightest = 16, kLightFloor = 5e-4;

double finite(double v) { return std::isnan(v) || v < 0 ? 0 : std::min(v, kBrightest); }
Vec3 rgb(const Vec4& v) { return {finite(v[0]), finite(v[1]), finite(v[2])}; }
double mean(const Vec3& v) { return (v[0] + v[1] + v[2]) / 3; }
Vec3 chroma(const Vec3& v) { return {v[0] - mean(v), v[1] - mean(v), v[2] - mean(v)}; }
double length(const Vec3& v) { return std::sqrt(dot(v, v)); }
Vec3 scaled(const Vec3& v, double by) { return {v[0] * by, v[1] * by, v[2] * by}; }
double distance(const Vec3& a, const Vec3& b) {
  return length({a[0] - b[0], a[1] - b[1], a[2] - b[2]});
}

double excess(const Vec3& c, const Vec3& d) {
  const Vec3 q = chroma(c);
  const double along = dot(q, d);
  return along - distance(q, scaled(d, along)) / std::sqrt(3.0);
}

/// From 0 to 1 as t goes from `low` to `high`, smoothly.
double rising(double low, double high, double t) {
  t = std::clamp((t - low) / (high - low), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

/// Bilinear between cells; a cell's value is at its middle.
Vec4 between(const Plane& cells, double x, double y) {
  x = std::clamp(x, 0.0, cells.width - 1.0);
  y = std::clamp(y, 0.0, cells.height - 1.0);
  const int left = static_cast<int>(x), top = static_cast<int>(y);
  Vec4 sum{};
  for (const int v : {top, top + 1})
    for (const int u : {left, left + 1}) {
      const double part = (1 - std::abs(x - u)) * (1 - std::abs(y - v));
      const Vec4& cell = cells.at(std::min(u, cells.width - 1), std::min(v, cells.height - 1));
      for (size_t c = 0; c < 4; ++c) sum[c] += part * cell[c];
    }
  return sum;
}
Vec4 at_pixel(const Plane& cells, int x, int y, int side) {
  return between(cells, (x + .5) / side - .5, (y + .5) / side - .5);
}

double opacity(const Vec3& seen, const Vec4& behind, const Vec4& front) {
  const Vec3 back{behind[0], behind[1], behind[2]};
  const Vec3 q = chroma(back);
  const double size = length(q);
  if (!(behind[3] > 0) || !(size > .0625 * mean(back)) || !(size > 1e-5)) return 1;
  const Vec3 d = scaled(q, 1 / size);
  const double free = 1 - excess(seen, d) / size;
  if (!(front[3] > 0)) return std::clamp(free, 0.0, 1.0);
  const Vec3 of_front{front[0], front[1], front[2]};
  const double own = std::clamp(excess(of_front, d) / size, 0.0, .2);
  const auto along = [&](const Vec3& c) { return dot(chroma(c), d) / size; };
  const auto across = [&](const Vec3& c) {
    Vec3 result = scaled(chroma(c), 1 / size);
    for (size_t k = 0; k < 3; ++k) result[k] -= along(c) * d[k];
    return result;
  };
  const double f = std::clamp(along(of_front), -1.0, .2);
  const double w = dot(across(of_front), across(of_front));
  const double part = std::clamp(dot(across(seen), across(of_front)) / std::max(w, 1e-6), 0.0, 2.0);
  const double mixed = std::lerp((1 - along(seen)) / (1 - std::min(f, 0.0)),
                                 1 - along(seen) + part * f, w / (w + .15 * .15));
  return std::lerp(std::clamp(mixed, 0.0, 1.0), std::clamp(free / (1 - own), 0.0, 1.0),
                   rising(.5, 1, front[3]));
}

/// Of a mean of a kind of pixels: how much it counts.
Plane trusted(const Plane& means) {
  Plane result = means;
  for (int y = 0; y < means.height; ++y)
    for (int x = 0; x < means.width; ++x) {
      double lowest = 1;
      for (int v = std::max(y - 1, 0); v <= std::min(y + 1, means.height - 1); ++v)
        for (int u = std::max(x - 1, 0); u <= std::min(x + 1, means.width - 1); ++u)
          lowest = std::min(lowest, means.at(u, v)[3]);
      double& weight = result.at(x, y)[3];
      weight = std::max(rising(.4, .8, lowest), .01 * weight);
    }
  return result;
}

/// Fills in from coarser cells.
Plane filled(const Plane& fine) {
  Plane result = fine;
  if (fine.size() == 1) return result;
  Plane coarse((fine.width + 1) / 2, (fine.height + 1) / 2);
  for (int y = 0; y < coarse.height; ++y)
    for (int x = 0; x < coarse.width; ++x) {
      double count = 0, weights = 0;
      Vec4& cell = coarse.at(x, y);
      for (int v = 2 * y; v < std::min(2 * y + 2, fine.height); ++v)
        for (int u = 2 * x; u < std::min(2 * x + 2, fine.width); ++u, ++count) {
          const Vec4& part = fine.at(u, v);
          weights += part[3];
          for (size_t c = 0; c < 3; ++c) cell[c] += part[c] * part[3];
        }
      for (size_t c = 0; c < 3; ++c) cell[c] = weights > 0 ? cell[c] / weights : 0;
      cell[3] = weights / count;
    }
  const Plane wide = filled(coarse);
  for (int y = 0; y < fine.height; ++y)
    for (int x = 0; x < fine.width; ++x) {
      Vec4& cell = result.at(x, y);
      const Vec4 other = at_pixel(wide, x, y, 2);
      const double rest = other[3] > 0 ? 1 - cell[3] : 0, all = cell[3] + rest;
      for (size_t c = 0; c < 3; ++c)
        cell[c] = all > 0 ? (cell[3] * cell[c] + rest * other[c]) / all : 0;
      cell[3] = all > 0 ? std::max(cell[3], .01) : 0;
    }
  return result;
}

using Weight = std::function<double(int x, int y)>;

/// Means of light on cells, weighted.
Plane cell_means(const Plane& frame, int side, const Weight& weight) {
  Plane cells((frame.width + side - 1) / side, (frame.height + side - 1) / side);
  for (int y = 0; y < cells.height; ++y)
    for (int x = 0; x < cells.width; ++x) {
      Vec4& cell = cells.at(x, y);
      double count = 0, sum = 0;
      for (int v = side * y; v < std::min(side * (y + 1), frame.height); ++v)
        for (int u = side * x; u < std::min(side * (x + 1), frame.width); ++u, ++count) {
          const double w = weight(u, v);
          const Vec3 seen = rgb(frame.at(u, v));
          sum += w;
          for (size_t c = 0; c < 3; ++c) cell[c] += w * seen[c];
        }
      if (sum > 1e-4)
        for (size_t c = 0; c < 3; ++c) cell[c] /= sum;
      else
        cell = {};
      cell[3] = sum > 1e-4 ? sum / count : 0;
    }
  return cells;
}

}  // namespace

Vec4 screen_of(const Plane& intrinsic, const KeySpec& spec) {
  const int wide = std::min(intrinsic.width, 64), high = std::min(intrinsic.height, 64);
  const int mx = (intrinsic.width + 7) / 8, my = (intrinsic.height + 7) / 8;
  std::vector<Vec3> sample;
  for (int j = 0; j < high; ++j)
    for (int i = 0; i < wide; ++i) {
      const int x = i * intrinsic.width / wide, y = j * intrinsic.height / high;
      const bool border =
          x < mx || y < my || x + mx >= intrinsic.width || y + my >= intrinsic.height;
      const Vec3 paint = rgb(intrinsic.at(x, y));
      if (mean(paint) > 1e-3 && (border || !spec.of_border)) sample.push_back(paint);
    }
  Vec3 hue = spec.key;
  if (spec.of_border) {
    hue = {};
    for (const Vec3& paint : sample)
      for (size_t c = 0; c < 3; ++c) hue[c] += paint[c];
  }
  hue = chroma(hue);
  if (!(length(hue) > 1e-6)) return {};
  const Vec3 d = scaled(hue, 1 / length(hue));
  Vec3 near{};
  Vec4 found{};
  for (const double width : {0.0, 1.0, 0.6, 0.4}) {
    Vec4 sum{};
    for (const Vec3& paint : sample) {
      double weight = std::clamp(excess(paint, d) / mean(paint), 0.0, 1.0);
      if (width > 0) weight *= 1 - rising(0, width, distance(scaled(paint, 1 / mean(paint)), near));
      for (size_t c = 0; c < 3; ++c) sum[c] += weight * paint[c];
      sum[3] += weight;
    }
    found = sum;
    const double value = mean({sum[0], sum[1], sum[2]});
    if (!(value > 0)) break;
    near = scaled({sum[0], sum[1], sum[2]}, 1 / value);
  }
  const Vec3 all{found[0], found[1], found[2]};
  if (found[3] < .01 * wide * high || !(length(chroma(all)) > .25 * mean(all))) return {};
  return {all[0] / found[3], all[1] / found[3], all[2] / found[3], 1};
}

KeyLight key_light(const Plane& frame, const Plane& intrinsic, const Vec4& screen, int side,
                   double tolerance) {
  const Vec3 paint = rgb(screen);
  KeyLight light;
  light.behind = filled(trusted(cell_means(frame, side, [&](int x, int y) {
    const Vec3 seen = rgb(frame.at(x, y)), own = rgb(intrinsic.at(x, y));
    const double value = mean(own);
    if (!(screen[3] > 0) || !(value > 1e-3)) return 0.0;
    const double apart = distance(scaled(own, 1 / value), scaled(paint, 1 / mean(paint)));
    return (1 - rising(tolerance, 1.5 * tolerance + 1e-3, apart)) *
           rising(kLightFloor, 4 * kLightFloor, mean(seen)) *
           (1 - rising(.7, 1.4, std::abs(std::log(value / mean(paint)))));
  })));
  light.front = filled(trusted(cell_means(frame, side, [&](int x, int y) {
    if (!(screen[3] > 0)) return 0.0;
    return rising(.75, .9, opacity(rgb(frame.at(x, y)), at_pixel(light.behind, x, y, side), {}));
  })));
  return light;
}

Plane key_matte(const Plane& frame, const Plane& intrinsic, const KeyLight& light, int side,
                const Plane* mask, const KeySpec& spec) {
  Plane result(frame.width, frame.height);
  for (int y = 0; y < frame.height; ++y)
    for (int x = 0; x < frame.width; ++x) {
      const Vec3 seen = rgb(frame.at(x, y)), paint = rgb(intrinsic.at(x, y));
      const Vec4 back = at_pixel(light.behind, x, y, side);
      const Vec4 front = at_pixel(light.front, x, y, side);
      const double alpha = std::clamp(
          (opacity(seen, back, front) - spec.black) / std::max(spec.white - spec.black, 1e-3), 0.0,
          1.0);
      const Vec4& hidden = spec.invert ? front : back;
      Vec4& matte = result.at(x, y);
      if (alpha > 0 && alpha < 1 && hidden[3] > 0)
        for (size_t c = 0; c < 3; ++c)
          matte[c + 1] = std::min(paint[c] * hidden[c] / std::max(seen[c], 1e-4), 4.0) - paint[c];
      double share = spec.strength;
      if (mask) share *= std::min(finite(mask->at(x, y)[0]), 1.0);
      matte[0] = spec.invert ? share * (1 - alpha) : 1 - share * (1 - alpha);
    }
  return result;
}

Plane shrunk(const Plane& matte, double radius) {
  if (radius == 0) return matte;
  const bool grow = radius < 0;
  const double size = std::abs(radius);
  const int whole = static_cast<int>(size);
  Plane from = matte;
  for (const bool down : {false, true}) {
    Plane to = from;
    for (int y = 0; y < matte.height; ++y)
      for (int x = 0; x < matte.width; ++x) {
        const auto found = [&](int reach) {
          double best = from.at(x, y)[0];
          for (int k = -reach; k <= reach; ++k) {
            const double other = from.at(std::clamp(x + (down ? 0 : k), 0, matte.width - 1),
                                         std::clamp(y + (down ? k : 0), 0, matte.height - 1))[0];
            best = grow ? std::max(best, other) : std::min(best, other);
          }
          return best;
        };
        Vec4& own = to.at(x, y);
        own[0] = std::lerp(found(whole), found(whole + 1), size - whole);
        if (!(own[0] > 0 && own[0] < 1)) own = {own[0], 0, 0, 0};
      }
    from = to;
  }
  return from;
}

Plane keyed_picture(const Plane& frame, const Plane* composed, const KeyLight& light, int side,
                    const Plane& matte, const Plane& shrunk, const KeySpec& spec, bool over_black) {
  Plane result(frame.width, frame.height);
  for (int y = 0; y < frame.height; ++y)
    for (int x = 0; x < frame.width; ++x) {
      const Vec3 seen = rgb(frame.at(x, y));
      const Vec4 behind = at_pixel(light.behind, x, y, side);
      const Vec4 front = at_pixel(light.front, x, y, side);
      const double alpha = matte.at(x, y)[0], few = .05 * (1 - alpha);
      Vec3 drawn = seen;
      if (behind[3] > 0 && !spec.invert) {
        for (size_t c = 0; c < 3; ++c) {
          const double other = front[3] > 0 ? front[c] : mean(seen);
          drawn[c] = std::max(seen[c] - (1 - alpha) * behind[c] + few * other, 0.0) /
                     std::max(alpha + few, 1e-3);
        }
        const Vec3 q = chroma({behind[0], behind[1], behind[2]});
        if (length(q) > 1e-5) {
          const Vec3 d = scaled(q, 1 / length(q));
          const double off = spec.despill * std::max(excess(drawn, d), 0.0);
          for (size_t c = 0; c < 3; ++c) drawn[c] = std::max(drawn[c] - off * d[c], 0.0);
        }
      }
      if (composed)
        for (size_t c = 0; c < 3; ++c) {
          const double edited = composed->at(x, y)[c];
          drawn[c] *= std::min((edited + kLightFloor) / (seen[c] + kLightFloor), kBrightest);
        }
      const double shown = shrunk.at(x, y)[0] * std::min(finite(frame.at(x, y)[3]), 1.0);
      for (size_t c = 0; c < 3; ++c)
        result.at(x, y)[c] = std::min(drawn[c], kBrightest) * (over_black ? shown : 1);
      result.at(x, y)[3] = shown;
    }
  return result;
}

}  // namespace inverse::reference
