// SPDX-License-Identifier: LGPL-2.1-or-later
#include "object.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace inverse::reference {
namespace {

constexpr int kBinsL = 10, kBinsAb = 24;
constexpr double kStartColor = .5, kOwnColor = .2, kFloor = .002;

double max_of(const std::vector<double>& v) { return *std::max_element(v.begin(), v.end()); }

double distance(const Vec3& a, const Vec3& b) {
  return std::sqrt(std::pow(a[0] - b[0], 2) + std::pow(a[1] - b[1], 2) + std::pow(a[2] - b[2], 2));
}

}  // namespace

Vec3 oklab(const Vec3& rgb) {
  const auto root = [&](double r, double g, double b) {
    return std::cbrt(std::max(r * rgb[0] + g * rgb[1] + b * rgb[2], 1e-12));
  };
  const double l = root(.4122214708, .5363325363, .0514459929),
               m = root(.2119034982, .6806995451, .1073969566),
               s = root(.0883024619, .2817188376, .6299787005);
  return {.2104542553 * l + .7936177850 * m - .0040720468 * s,
          1.9779984951 * l - 2.4285922050 * m + .4505937099 * s,
          .0259040371 * l + .7827717662 * m - .8086757660 * s};
}

Plane cell_means(const Plane& plane, int side) {
  Plane means((plane.width + side - 1) / side, (plane.height + side - 1) / side);
  for (int y = 0; y < means.height; ++y)
    for (int x = 0; x < means.width; ++x) {
      Vec4 sum{};
      int count = 0;
      for (int v = y * side; v < std::min((y + 1) * side, plane.height); ++v)
        for (int u = x * side; u < std::min((x + 1) * side, plane.width); ++u, ++count)
          for (size_t c = 0; c < 4; ++c) sum[c] += plane.at(u, v)[c];
      for (double& s : sum) s /= count;
      means.at(x, y) = sum;
    }
  return means;
}

int color_bin(const Vec3& color) {
  const auto bin = [](double v, double low, double high, int bins) {
    return std::clamp(static_cast<int>(std::floor((v - low) / (high - low) * bins)), 0, bins - 1);
  };
  return (bin(color[0], 0, 1.05, kBinsL) * kBinsAb + bin(color[1], -.3, .3, kBinsAb)) * kBinsAb +
         bin(color[2], -.3, .3, kBinsAb);
}

std::vector<double> smooth_histogram(const std::vector<double>& counts) {
  std::vector<double> now = counts;
  const int strides[] = {kBinsAb * kBinsAb, kBinsAb, 1}, sizes[] = {kBinsL, kBinsAb, kBinsAb};
  for (int pass = 0; pass < 2; ++pass)
    for (int axis = 0; axis < 3; ++axis) {
      std::vector<double> next(now.size());
      for (int n = 0; n < kColorBins; ++n) {
        const int at = n / strides[axis] % sizes[axis];
        next[n] = .5 * now[n];
        if (at > 0) next[n] += .25 * now[n - strides[axis]];
        if (at + 1 < sizes[axis]) next[n] += .25 * now[n + strides[axis]];
      }
      now = next;
    }
  return now;
}

ObjectSelection::ObjectSelection(int width, int height)
    : alpha(static_cast<size_t>(width) * height),
      region(alpha.size()),
      width_(width),
      height_(height),
      object_(kColorBins),
      background_(kColorBins),
      added_(kColorBins),
      subtracted_(kColorBins),
      p_(alpha.size()),
      weight_(alpha.size()),
      memory_(alpha.size()) {}

int ObjectSelection::area() const {
  return static_cast<int>(std::count(region.begin(), region.end(), 1U));
}

std::vector<uint32_t> ObjectSelection::marks(const std::vector<Vec3>& colors,
                                             const std::vector<uint32_t>& drawn) {
  std::vector<uint32_t> seeds(alpha.size());
  for (size_t n = 0; n < seeds.size(); ++n) {
    Memory& memory = memory_[n];
    if (distance(colors[n], memory.color) > .08) memory = {};
    if (drawn[n] != no_seed && !(drawn[n] == seed_around && region[n]))
      memory = {colors[n], drawn[n] == seed_add ? 2. : -2.};
    seeds[n] = memory.s > 1 ? seed_add : memory.s < -1 ? seed_subtract : no_seed;
  }
  return seeds;
}

std::vector<double> ObjectSelection::distances(const std::vector<Vec3>& colors,
                                               const std::vector<uint32_t>& seeds,
                                               Seed kind) const {
  std::vector<double> d(alpha.size());
  for (size_t n = 0; n < d.size(); ++n) d[n] = seeds[n] == kind ? 0 : 1e6;
  const auto line = [&](int first, int stride, int count) {
    for (int i = 1; i < count; ++i) {
      const int n = first + i * stride;
      d[n] = std::min(d[n], d[n - stride] + .005 + distance(colors[n], colors[n - stride]) / .04);
    }
    for (int i = count - 2; i >= 0; --i) {
      const int n = first + i * stride;
      d[n] = std::min(d[n], d[n + stride] + .005 + distance(colors[n], colors[n + stride]) / .04);
    }
  };
  for (int pass = 0; pass < 8; ++pass) {
    for (int y = 0; y < height_; ++y) line(y * width_, 1, width_);
    for (int x = 0; x < width_; ++x) line(x, width_, height_);
  }
  return d;
}

void ObjectSelection::select(const std::vector<Vec3>& colors, const std::vector<uint32_t>& drawn,
                             bool restart) {
  const bool first = restart || !active_;
  if (first) *this = ObjectSelection(width_, height_);
  const std::vector<uint32_t> seeds = marks(colors, drawn);
  for (const Seed kind : {seed_add, seed_subtract}) {
    std::vector<double> counts(kColorBins), density(kColorBins);
    for (size_t n = 0; n < drawn.size(); ++n)
      if (drawn[n] == kind || (kind == seed_subtract && drawn[n] == seed_around && !region[n]))
        counts[color_bin(colors[n])] += 255;
    blend(density, counts, 1);
    std::vector<double>& all = kind == seed_add ? added_ : subtracted_;
    for (size_t n = 0; n < all.size(); ++n) all[n] = std::max(all[n], density[n]);
  }
  if (first) {
    const double top = max_of(added_);
    for (size_t n = 0; n < seeds.size(); ++n) {
      const bool own = top > 0 && added_[color_bin(colors[n])] > kStartColor * top;
      alpha[n] = seeds[n] == seed_add || (own && seeds[n] != seed_subtract);
    }
    find_region(seeds, true);
    learn(colors, 1);
  }
  const std::vector<double> to_added = distances(colors, seeds, seed_add),
                            to_subtracted = distances(colors, seeds, seed_subtract);
  for (size_t n = 0; n < seeds.size(); ++n) {
    if (seeds[n] != no_seed) continue;
    const bool both = std::max(to_added[n], to_subtracted[n]) < 1e5;
    const double ahead = std::clamp((to_added[n] - to_subtracted[n]) / .3, -40., 40.);
    memory_[n] = {colors[n], both ? 2 / (1 + std::exp(ahead)) - 1 : 0};
  }
  for (int round = 0; round < (first ? 5 : 1); ++round) {
    segment(colors, seeds, 48);
    learn(colors, 1);
  }
  active_ = true;
  lost_ = false;
}

void ObjectSelection::follow(const std::vector<Vec3>& colors) {
  segment(colors, marks(colors, std::vector<uint32_t>(alpha.size())), lost_ ? 48 : 8);
  lost_ = false;
  learn(colors, .1);
}

void ObjectSelection::lose() {
  std::ranges::fill(alpha, 0);
  std::ranges::fill(region, 0);
  lost_ = true;
}

void ObjectSelection::segment(const std::vector<Vec3>& colors, const std::vector<uint32_t>& seeds,
                              int steps) {
  const double e = kFloor * max_of(object_) + 1e-30;
  for (size_t n = 0; n < alpha.size(); ++n) {
    const int bin = color_bin(colors[n]);
    const double own = std::max(object_[bin], added_[bin]) + e,
                 other = std::max(background_[bin], subtracted_[bin]) + e;
    const double certain = std::min(std::abs(std::log(own / other)) / 3, 1.);
    const double p = certain * own / (own + other) + (1 - certain) * region[n],
                 w = .05 * certain * certain + 1e-3, s = memory_[n].s,
                 m = seeds[n] != no_seed ? 10 : .05 * std::abs(s) * (1 - certain) * (1 - certain);
    weight_[n] = w + m;
    p_[n] = (w * p + m * (s > 0)) / weight_[n];
    alpha[n] += std::min(weight_[n] / .05, 1.) * (p_[n] - alpha[n]);
  }
  const auto edge = [&](size_t a, size_t b) {
    double d2 = 0;
    for (size_t c = 0; c < 3; ++c) d2 += std::pow(colors[a][c] - colors[b][c], 2);
    return 2 * std::exp(-d2 / (2 * .04 * .04));
  };
  for (int step = 0; step < steps; ++step) {
    std::vector<double> next(alpha.size());
    for (int y = 0; y < height_; ++y)
      for (int x = 0; x < width_; ++x) {
        const size_t n = static_cast<size_t>(y) * width_ + x;
        double sum = weight_[n] * p_[n], weight = weight_[n];
        const auto neighbor = [&](bool there, size_t m) {
          if (!there) return;
          sum += edge(n, m) * alpha[m];
          weight += edge(n, m);
        };
        neighbor(x > 0, n - 1);
        neighbor(x + 1 < width_, n + 1);
        neighbor(y > 0, n - width_);
        neighbor(y + 1 < height_, n + width_);
        next[n] = sum / weight;
      }
    alpha = next;
  }
  find_region(seeds, false);
}

void ObjectSelection::find_region(const std::vector<uint32_t>& seeds, bool seeded) {
  const bool lost = area() == 0;
  std::vector<bool> seen(alpha.size());
  std::vector<uint32_t> next(alpha.size());
  for (size_t start = 0; start < alpha.size(); ++start) {
    if (seen[start] || !(alpha[start] > .5)) continue;
    std::vector<size_t> component{start};
    seen[start] = true;
    int claimed = 0;
    bool has_seed = false;
    for (size_t i = 0; i < component.size(); ++i) {
      const size_t n = component[i];
      claimed += lost ? p_[n] > .9 && weight_[n] > .9 * .05 : region[n] == 1;
      has_seed |= seeds[n] == seed_add;
      const int x = static_cast<int>(n) % width_, y = static_cast<int>(n) / width_;
      const auto visit = [&](bool there, size_t m) {
        if (!there || seen[m] || !(alpha[m] > .5)) return;
        seen[m] = true;
        component.push_back(m);
      };
      visit(x > 0, n - 1);
      visit(x + 1 < width_, n + 1);
      visit(y > 0, n - width_);
      visit(y + 1 < height_, n + width_);
    }
    const int size = static_cast<int>(component.size());
    bool kept = has_seed;
    if (!seeded)
      kept |= lost ? 2 * claimed >= size && last_area_ > 0 && 4 * size >= last_area_
                   : 10 * claimed >= size;
    for (const size_t n : component) {
      next[n] = kept;
      if (!kept) alpha[n] = 0;
    }
  }
  region = next;
  if (area() > 0) last_area_ = area();
}

std::vector<bool> ObjectSelection::near_region() const {
  const int columns = (width_ + 3) / 4, rows = (height_ + 3) / 4;
  std::vector<bool> occupied(static_cast<size_t>(columns) * rows), near(alpha.size());
  for (size_t n = 0; n < region.size(); ++n)
    if (region[n]) occupied[n / width_ / 4 * columns + n % width_ / 4] = true;
  const int reach = static_cast<int>(
      std::ceil(std::max(.4 * std::sqrt(area()), .02 * std::hypot(width_, height_)) / 4));
  for (size_t n = 0; n < near.size(); ++n) {
    const int x = static_cast<int>(n) % width_ / 4, y = static_cast<int>(n) / width_ / 4;
    for (int v = std::max(y - reach, 0); v <= std::min(y + reach, rows - 1); ++v)
      for (int u = std::max(x - reach, 0); u <= std::min(x + reach, columns - 1); ++u)
        if (occupied[static_cast<size_t>(v) * columns + u]) near[n] = true;
  }
  return near;
}

void ObjectSelection::learn(const std::vector<Vec3>& colors, double rate) {
  std::vector<double> counts(kColorBins);
  for (size_t n = 0; n < alpha.size(); ++n)
    if (region[n]) counts[color_bin(colors[n])] += std::floor(255 * alpha[n] + .5);
  blend(object_, counts, rate);
  std::fill(counts.begin(), counts.end(), 0);
  const std::vector<bool> near = near_region();
  const double top = max_of(object_), top_added = max_of(added_);
  for (size_t n = 0; n < alpha.size(); ++n) {
    const int bin = color_bin(colors[n]);
    if (!near[n] && !(object_[bin] > kOwnColor * top) && !(added_[bin] > kOwnColor * top_added))
      counts[bin] += 1;
  }
  blend(background_, counts, rate);
}

void ObjectSelection::blend(std::vector<double>& density, const std::vector<double>& counts,
                            double rate) {
  const std::vector<double> smoothed = smooth_histogram(counts);
  const double sum = std::accumulate(smoothed.begin(), smoothed.end(), 0.);
  for (size_t n = 0; n < density.size(); ++n) {
    if (sum > 0) density[n] += rate * (smoothed[n] / sum - density[n]);
  }
}

}  // namespace inverse::reference
