// SPDX-License-Identifier: LGPL-2.1-or-later
#include "misclustering_survey.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace inverse {
namespace {

using Rgb = BaseColors::Rgb;

constexpr size_t kSlots = BaseColors::kMaxColors;
constexpr float kFloor = 3e-3f;  // ε_c of chromaticities, as in the method's default

// All of these were chosen on the project's own scenes and hold on others, see
// docs/reference/methods/globalintrinsicthesis.md.
constexpr float kMinArea = 0.003f;       // of the frame
constexpr int kMinPixels = 12;           // of the small frame
constexpr float kMinShare = 0.1f;        // of a region's border, to the cluster of its base color
constexpr float kMinBorder = 0.5f;       // share of it that is none of paint
constexpr float kMinContrast = 0.15f;    // distance of two base colors, ln chroma
constexpr float kNear = 0.5f;            // "the same chroma", in distances of the two base colors
constexpr float kShadow = 0.15f;         // by how much a shadow is darker
constexpr float kMaxBrighter = 1.3f;     // than the surface in other light
constexpr float kHidden = 3;             // see the header
constexpr float kMinTint = 0.02f;        // share of colored light
constexpr float kMaxTint = 0.3f;         // ln chroma left unexplained,
constexpr float kMaxUnexplained = 0.6f;  // also as a share of the difference
constexpr float kMinScore = 0.05f;
constexpr int kShares = 20;   // of colored light that are tried
constexpr int kCell = 8;      // pixels, along an axis, of a cell of light
constexpr int kSamples = 64;  // pixels of a region that receive light

float mean(const Rgb& v) { return (v[0] + v[1] + v[2]) / 3; }

Rgb log_chroma(const Rgb& v) {
  const float m = mean(v) + kFloor;
  return {std::log((v[0] + kFloor) / m), std::log((v[1] + kFloor) / m),
          std::log((v[2] + kFloor) / m)};
}

Rgb minus(const Rgb& a, const Rgb& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

float length(const Rgb& v) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

/// A connected component.
struct Component {
  int cluster = -1, region = 0, pixels = 0;
  Rgb chroma{};  // sum of ln chroma, then mean
  std::vector<int> samples;
};

/// Of a component's border to a cluster, in steps from pixel to pixel.
struct Border {
  float steps = 0, gradual = 0, shadow = 0, here = 0, there = 0;
};

class Search {
 public:
  explicit Search(const Survey& survey)
      : s_(survey),
        w_(static_cast<int>(survey.extent.width)),
        h_(static_cast<int>(survey.extent.height)) {
    for (const BaseColors::Color& color : survey.colors)
      by_slot_.at(static_cast<size_t>(color.slot)) = &color;
    min_pixels_ = std::max(kMinPixels, static_cast<int>(kMinArea * static_cast<float>(w_ * h_)));
  }

  SurveyResult run() {
    read();
    find_components();
    collect_light();
    measure_borders();
    for (size_t c = 0; c < components_.size(); ++c)
      if (components_[c].pixels >= min_pixels_) score(c);
    place();
    std::stable_sort(
        result_.found.begin(), result_.found.end(),
        [](const Misclustered& a, const Misclustered& b) { return a.pixels > b.pixels; });
    return std::move(result_);
  }

 private:
  int pixels() const { return w_ * h_; }

  void read() {
    colors_.resize(static_cast<size_t>(pixels()));
    chromas_.resize(colors_.size());
    clusters_.resize(colors_.size());
    regions_.resize(colors_.size());
    for (size_t n = 0; n < colors_.size(); ++n) {
      const float* p = &s_.pixels[4 * n];
      const int code = static_cast<int>(p[3]);
      colors_[n] = {p[0], p[1], p[2]};
      chromas_[n] = log_chroma(colors_[n]);
      regions_[n] = std::clamp(code / Survey::kClusterCodes, 0, MarkedRegions::kMaxRegions);
      const int cluster = code % Survey::kClusterCodes - 1;
      const bool known = cluster >= 0 && cluster < static_cast<int>(kSlots) &&
                         by_slot_[static_cast<size_t>(cluster)];
      clusters_[n] = known ? cluster : -1;
    }
  }

  /// The four neighbors of pixel n, or n itself across the frame's border.
  std::array<int, 4> neighbors(int n) const {
    const int x = n % w_;
    return {x > 0 ? n - 1 : n, x + 1 < w_ ? n + 1 : n, n >= w_ ? n - w_ : n,
            n + w_ < pixels() ? n + w_ : n};
  }
  int component(int n) const { return result_.components[static_cast<size_t>(n)]; }
  int cluster(int n) const { return clusters_[static_cast<size_t>(n)]; }
  const BaseColors::Color& color(int slot) const { return *by_slot_[static_cast<size_t>(slot)]; }

  /// The cluster of a pixel, or what its region has been given instead.
  int true_cluster(int n) const {
    const auto at = static_cast<size_t>(n);
    const int given = s_.given[static_cast<size_t>(regions_[at])];
    return given >= 0 && by_slot_.at(static_cast<size_t>(given)) ? given : clusters_[at];
  }

  void find_components() {
    result_.components.assign(colors_.size(), -1);
    std::vector<int> open;
    for (int first = 0; first < pixels(); ++first) {
      if (cluster(first) < 0 || component(first) >= 0) continue;
      const auto number = static_cast<int>(components_.size());
      Component found;
      found.cluster = cluster(first);
      std::array<int, MarkedRegions::kMaxRegions + 1> in{};
      open.assign(1, first);
      result_.components[static_cast<size_t>(first)] = number;
      for (size_t i = 0; i < open.size(); ++i) {
        const auto n = static_cast<size_t>(open[i]);
        ++in[static_cast<size_t>(regions_[n])];
        for (size_t c = 0; c < 3; ++c) found.chroma[c] += chromas_[n][c];
        for (const int m : neighbors(open[i])) {
          if (component(m) >= 0 || cluster(m) != found.cluster) continue;
          result_.components[static_cast<size_t>(m)] = number;
          open.push_back(m);
        }
      }
      found.pixels = static_cast<int>(open.size());
      for (float& c : found.chroma) c /= static_cast<float>(found.pixels);
      found.region = static_cast<int>(std::max_element(in.begin(), in.end()) - in.begin());
      if (found.pixels >= min_pixels_)
        for (int i = 0; i < kSamples; ++i)
          found.samples.push_back(open[static_cast<size_t>(i * found.pixels / kSamples)]);
      components_.push_back(std::move(found));
    }
  }

  /// How much light each base color sends from every cell of the frame.
  void collect_light() {
    across_ = (w_ - 1) / kCell + 1;
    const auto cells = static_cast<size_t>(across_ * ((h_ - 1) / kCell + 1));
    light_.assign(cells, {});
    for (int n = 0; n < pixels(); ++n) {
      const int k = true_cluster(n);
      if (k >= 0) light_[cell(n)][static_cast<size_t>(k)] += mean(colors_[static_cast<size_t>(n)]);
    }
  }
  size_t cell(int n) const {
    return static_cast<size_t>(n / w_ / kCell * across_ + n % w_ / kCell);
  }

  /// Each base color's share of the light that the component receives from the rest of the frame.
  std::array<float, kSlots> surroundings(size_t index) const {
    const Component& c = components_[index];
    std::vector<float> near(light_.size(), 0);
    for (size_t i = 0; i < light_.size(); ++i) {
      const float x = (static_cast<float>(i % static_cast<size_t>(across_)) + 0.5f) * kCell;
      const float y = (static_cast<float>(i / static_cast<size_t>(across_)) + 0.5f) * kCell;
      for (const int n : c.samples) {
        const float dx = static_cast<float>(n % w_) - x, dy = static_cast<float>(n / w_) - y;
        near[i] += 1 / (dx * dx + dy * dy + kCell * kCell);
      }
    }
    std::array<float, kSlots> share{};
    for (size_t i = 0; i < light_.size(); ++i)
      for (size_t k = 0; k < kSlots; ++k) share[k] += near[i] * light_[i][k];
    for (int n = 0; n < pixels(); ++n) {
      if (component(n) != static_cast<int>(index)) continue;
      const int k = true_cluster(n);
      share[static_cast<size_t>(k)] -= near[cell(n)] * mean(colors_[static_cast<size_t>(n)]);
    }
    float sum = 1e-9f;
    for (float& k : share) sum += k = std::max(k, 0.0f);
    for (float& k : share) k /= sum;
    return share;
  }

  void measure_borders() {
    borders_.assign(components_.size(), {});
    for (int n = 0; n < pixels(); ++n) {
      if (cluster(n) < 0 || components_[static_cast<size_t>(component(n))].pixels < min_pixels_)
        continue;
      for (const int m : neighbors(n)) {
        if (component(m) == component(n) || cluster(m) < 0) continue;
        // A pixel further on each side, if there is one: the nearest are blurred.
        const int step = m - n;
        add_step(component(n), further(n, -step), further(m, step), true_cluster(m));
      }
    }
  }
  int further(int n, int step) const {
    for (const int m : neighbors(n))
      if (m == n + step && component(m) == component(n)) return m;
    return n;
  }
  void add_step(int from, int n, int m, int slot) {
    const Rgb &here = colors_[static_cast<size_t>(n)], &there = colors_[static_cast<size_t>(m)];
    const Rgb &goal = color(slot).center,
              &own = color(components_[static_cast<size_t>(from)].cluster).center;
    const float same = kNear * length(minus(own, goal));
    const Rgb missing = minus(there, here);
    Border& border = borders_[static_cast<size_t>(from)][static_cast<size_t>(slot)];
    border.steps += 1;
    border.here += mean(here);
    border.there += mean(there);
    if (length(minus(chromas_[static_cast<size_t>(n)], chromas_[static_cast<size_t>(m)])) < same)
      border.gradual += 1;
    if (*std::min_element(missing.begin(), missing.end()) > 0 &&
        mean(missing) > kShadow * mean(there) && length(minus(log_chroma(missing), goal)) < same)
      border.shadow += 1;
  }

  /// What is left of `tint`, ln chroma, by the best share of light of a base color.
  float unexplained(const Rgb& tint, const std::array<float, kSlots>& around) const {
    float best = 3.4e38f;
    for (const BaseColors::Color& k : s_.colors) {
      const float max_share = std::min(kHidden * around[static_cast<size_t>(k.slot)], 1.0f);
      const float scale = 1 / std::max(mean(k.initial), 1e-6f);
      for (int i = 1; i <= kShares; ++i) {
        const float share = static_cast<float>(i) / kShares;
        if (share > max_share || share < kMinTint) continue;
        Rgb light{};
        for (size_t c = 0; c < 3; ++c) light[c] = 1 - share + share * k.initial[c] * scale;
        best = std::min(best, length(minus(tint, log_chroma(light))));
      }
    }
    return best;
  }

  void score(size_t index) {
    const Component& c = components_[index];
    float steps = 0;
    for (const Border& border : borders_[index]) steps += border.steps;
    std::array<float, kSlots> around{};
    bool has_around = false;
    Misclustered best{0, 0, c.pixels, c.cluster, -1, c.region, 0, static_cast<int>(index)};
    for (const BaseColors::Color& b : s_.colors) {
      const Border& border = borders_[index][static_cast<size_t>(b.slot)];
      const float share = border.steps / std::max(steps, 1.0f);
      const float soft = std::max(border.gradual, border.shadow) / std::max(border.steps, 1.0f);
      if (b.slot == c.cluster || share < kMinShare || soft < kMinBorder) continue;
      if (border.here > kMaxBrighter * border.there) continue;
      if (length(minus(color(c.cluster).center, b.center)) < kMinContrast) continue;
      if (!std::exchange(has_around, true)) around = surroundings(index);
      const Rgb tint = minus(c.chroma, b.center);
      const float left = unexplained(tint, around), all = length(tint);
      if (left > kMaxTint || left > kMaxUnexplained * all) continue;
      const float score = share * soft * (1 - left / all);
      if (score < kMinScore || score <= best.score) continue;
      best.score = score;
      best.color = b.slot;
    }
    if (best.color >= 0) result_.found.push_back(best);
  }

  /// A pixel of each that is as far from its border as any, by city blocks.
  void place() {
    std::vector<int> depth(colors_.size());
    const auto pass = [&](int n, bool up) {
      int smallest = depth[static_cast<size_t>(n)];
      for (const int m : neighbors(n)) {
        if (m == n || component(m) != component(n)) {
          smallest = std::min(smallest, 1);
        } else if (up ? m > n : m < n) {
          smallest = std::min(smallest, depth[static_cast<size_t>(m)] + 1);
        }
      }
      depth[static_cast<size_t>(n)] = smallest;
    };
    std::fill(depth.begin(), depth.end(), w_ + h_);
    for (int n = 0; n < pixels(); ++n) pass(n, false);
    for (int n = pixels() - 1; n >= 0; --n) pass(n, true);
    for (Misclustered& found : result_.found) {
      int deepest = 0;
      for (int n = 0; n < pixels(); ++n) {
        if (component(n) != found.component || depth[static_cast<size_t>(n)] <= deepest) continue;
        deepest = depth[static_cast<size_t>(n)];
        found.x = n % w_;
        found.y = n / w_;
      }
    }
  }

  const Survey& s_;
  int w_, h_, min_pixels_ = 0, across_ = 0;
  std::array<const BaseColors::Color*, kSlots> by_slot_{};
  std::vector<Rgb> colors_, chromas_;
  std::vector<int> clusters_, regions_;
  std::vector<Component> components_;
  std::vector<std::array<float, kSlots>> light_;  // by cell and slot
  std::vector<std::array<Border, kSlots>> borders_;
  SurveyResult result_;
};

}  // namespace

SurveyResult find_misclustered(const Survey& survey) { return Search(survey).run(); }

}  // namespace inverse
