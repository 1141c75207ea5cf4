// SPDX-License-Identifier: LGPL-2.1-or-later
#include "global_palette.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace inverse::reference::global {

ChromaHistogram::ChromaHistogram(int bins, double width)
    : bins_(bins), width_(width), values_(std::size_t(bins) * std::size_t(bins), 0.0) {}

void ChromaHistogram::add(const Chroma& c, double weight) {
  const auto place = [&](double v) {
    return std::clamp(v / width_ + 0.5 * bins_, 0.0, bins_ - 1.001);
  };
  const double u = place(c[0]), v = place(c[1]);
  const auto a = std::size_t(u), b = std::size_t(v), at = b * std::size_t(bins_) + a;
  const double fu = u - double(a), fv = v - double(b);
  values_[at] += weight * (1 - fu) * (1 - fv);
  values_[at + 1] += weight * fu * (1 - fv);
  values_[at + std::size_t(bins_)] += weight * (1 - fu) * fv;
  values_[at + std::size_t(bins_) + 1] += weight * fu * fv;
}

Chroma ChromaHistogram::center(std::size_t bin) const {
  const auto n = std::size_t(bins_);
  return {width_ * (double(bin % n) - 0.5 * bins_), width_ * (double(bin / n) - 0.5 * bins_)};
}

std::size_t ChromaHistogram::nearest(const Chroma& c) const {
  const auto place = [&](double v) {
    return std::size_t(std::clamp(std::floor(v / width_ + 0.5 * bins_ + 0.5), 0.0, bins_ - 1.0));
  };
  return place(c[1]) * std::size_t(bins_) + place(c[0]);
}

double ChromaHistogram::total() const {
  return std::accumulate(values_.begin(), values_.end(), 0.0);
}

double ChromaHistogram::entropy() const {
  const double all = total();
  double sum = 0;
  for (const double v : values_)
    if (v > 0) sum -= v / all * std::log(v / all);
  return sum;
}

int BaseColors::used() const {
  return int(
      std::count_if(color.begin(), color.end(), [](const auto& c) { return c.has_value(); }));
}

namespace {

struct Mode {
  Chroma center{};
  double mass = 0;
  std::size_t peak = 0;
};

std::vector<double> smoothed(const ChromaHistogram& h, double sigma) {
  const int n = h.bins(), reach = int(std::ceil(3 * sigma));
  std::vector<double> in = h.values(), out(in.size());
  for (const int step : {1, n}) {
    for (int b = 0; b < n; ++b)
      for (int a = 0; a < n; ++a) {
        const int along = step == 1 ? a : b;
        double sum = 0, all = 0;
        for (int d = -reach; d <= reach; ++d) {
          const double w = std::exp(-0.5 * d * d / (sigma * sigma));
          all += w;
          if (along + d >= 0 && along + d < n) sum += w * in[std::size_t(b * n + a + d * step)];
        }
        out[std::size_t(b * n + a)] = sum / all;
      }
    in = out;
  }
  return out;
}

/// Every bin's peak; of equal neighbors the first.
std::vector<std::size_t> climb(const std::vector<double>& height, int n) {
  std::vector<std::size_t> up(height.size());
  for (int b = 0; b < n; ++b)
    for (int a = 0; a < n; ++a) {
      auto best = std::size_t(b * n + a);
      for (int v = std::max(b - 1, 0); v <= std::min(b + 1, n - 1); ++v)
        for (int u = std::max(a - 1, 0); u <= std::min(a + 1, n - 1); ++u)
          if (const auto at = std::size_t(v * n + u);
              height[at] > height[best] || (height[at] == height[best] && at < best))
            best = at;
      up[std::size_t(b * n + a)] = best;
    }
  for (int k = 0; k < 6; ++k) {
    const std::vector<std::size_t> before = up;
    for (std::size_t& u : up) u = before[u];
  }
  return up;
}

double distance2(const Chroma& a, const Chroma& b) { return norm2(a - b); }

constexpr auto kNone = std::size_t(-1);

/// Slots of modes that continue a color, nearest pairs first.
std::vector<std::size_t> continued(const std::vector<Mode>& modes, const BaseColors& colors,
                                   double same) {
  std::vector<std::size_t> slot(modes.size(), kNone);
  std::vector<bool> taken(colors.memory.size(), false);
  for (;;) {
    double nearest = same * same;
    std::size_t mode = kNone, at = kNone;
    for (std::size_t m = 0; m < modes.size(); ++m)
      for (std::size_t s = 0; s < taken.size(); ++s) {
        if (slot[m] != kNone || taken[s] || !colors.memory[s]) continue;
        const double d = distance2(colors.memory[s]->usual, modes[m].center);
        if (d < nearest) nearest = d, mode = m, at = s;
      }
    if (mode == kNone) return slot;
    slot[mode] = at;
    taken[at] = true;
  }
}

/// The histogram's mass close to a chroma.
double mass_around(const ChromaHistogram& h, const Chroma& c, int reach) {
  const int n = h.bins(), at = int(h.nearest(c)), x = at % n, y = at / n;
  double sum = 0;
  for (int v = std::max(y - reach, 0); v <= std::min(y + reach, n - 1); ++v)
    for (int u = std::max(x - reach, 0); u <= std::min(x + reach, n - 1); ++u)
      sum += h.values()[std::size_t(v * n + u)];
  return sum;
}

/// A free slot, or the one whose color has been absent for longest.
std::size_t free_slot(const BaseColors& colors, const std::vector<std::size_t>& used) {
  std::size_t best = kNone;
  for (std::size_t s = 0; s < colors.memory.size(); ++s) {
    if (std::find(used.begin(), used.end(), s) != used.end()) continue;
    if (!colors.memory[s]) return s;
    if (best == kNone || colors.memory[s]->absent > colors.memory[best]->absent) best = s;
  }
  return best;
}

}  // namespace

BaseColors find_modes(const ChromaHistogram& histogram, const BaseColors& before,
                      const PaletteParams& params) {
  const std::vector<double> height = smoothed(histogram, params.smoothing);
  const std::vector<std::size_t> peak = climb(height, histogram.bins());
  const std::vector<double>& mass = histogram.values();
  std::vector<Mode> basin(mass.size());
  for (std::size_t b = 0; b < mass.size(); ++b) {
    Mode& m = basin[peak[b]];
    const Chroma at = histogram.center(b);
    m.peak = peak[b];
    m.center = m.center + mass[b] * at;
    m.mass += mass[b];
  }
  std::vector<Mode> modes;
  for (Mode m : basin)
    if (m.mass >= params.min_share * histogram.total() && m.mass > 0) {
      m.center = (1 / m.mass) * m.center;
      modes.push_back(m);
    }
  std::stable_sort(modes.begin(), modes.end(),
                   [](const Mode& a, const Mode& b) { return a.mass > b.mass; });
  if (modes.size() > std::size_t(params.most)) modes.resize(std::size_t(params.most));
  if (modes.empty()) modes.push_back({{0, 0}, 0, histogram.nearest({0, 0})});

  BaseColors out;
  out.color.assign(std::size_t(params.most), std::nullopt);
  out.memory = before.memory;
  out.memory.resize(std::size_t(params.most));
  std::vector<std::size_t> slot = continued(modes, out, params.same);
  const std::size_t seen = modes.size();
  for (std::size_t s = 0; s < out.memory.size(); ++s) {
    auto& memory = out.memory[s];
    if (!memory || std::find(slot.begin(), slot.end(), s) != slot.end()) continue;
    if (++memory->absent > params.forget) {
      memory.reset();
      continue;
    }
    const Chroma usual = memory->usual;
    const double left = mass_around(histogram, usual, params.around);
    if (memory->absent > params.keep || modes.size() == std::size_t(params.most) ||
        left < 0.5 * params.min_share * histogram.total())
      continue;
    modes.push_back({usual, left, peak[histogram.nearest(usual)]});
    slot.push_back(s);
  }
  for (std::size_t m = 0; m < seen; ++m) {
    if (slot[m] == kNone) {
      slot[m] = free_slot(out, slot);
      out.memory[slot[m]] = {modes[m].center};
    }
    Chroma& usual = out.memory[slot[m]]->usual;
    usual = usual + params.follow * (modes[m].center - usual);
    out.memory[slot[m]]->absent = 0;
  }
  for (std::size_t m = 0; m < modes.size(); ++m) out.color[slot[m]] = modes[m].center;
  for (std::size_t b = 0; b < mass.size(); ++b) {
    std::size_t best = modes.size();
    for (std::size_t m = 0; m < modes.size(); ++m)
      if (modes[m].peak == peak[b] &&
          (best == modes.size() || distance2(modes[m].center, histogram.center(b)) <
                                       distance2(modes[best].center, histogram.center(b))))
        best = m;
    if (best == modes.size()) {
      best = 0;
      for (std::size_t m = 1; m < modes.size(); ++m)
        if (distance2(modes[m].center, histogram.center(b)) <
            distance2(modes[best].center, histogram.center(b)))
          best = m;
    }
    out.label.push_back(int(slot[best]));
  }
  return out;
}

}  // namespace inverse::reference::global
