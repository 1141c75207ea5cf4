// SPDX-License-Identifier: LGPL-2.1-or-later
#include "key_color.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace inverse::run {
namespace {

using Color = std::array<double, 3>;

// Distances are of chromaticity c = R / mean R: gray is 1, 1, 1, a pure primary 2.45 from it.
constexpr Color kGray{1, 1, 1};
constexpr double kLightFloor = 5e-4;  // as intrinsicrecolor: darker pixels count as gray
constexpr double kDark = 4e-3;        // mean light below which a pixel is ignored
constexpr double kCell = 0.1;         // of the histogram of chromaticities
constexpr double kMinCell = 5e-4;     // minimum share of the pixels of an initial color
constexpr double kNear = 0.35;        // radius of the mean
constexpr double kMinSaturation = 0.6;
constexpr double kTolerances[] = {0.3, 0.45, 0.6};
constexpr double kSoftness = 0.75;   // of the tolerance
constexpr double kMinShare = 0.006;  // of the pixels
// More area may be repainted of a more saturated color: an orange suit, but no brown room. Per
// squared saturation, and the upper limit.
constexpr double kMaxShare = 0.3, kMaxOfAll = 0.75;
constexpr double kMinThing = 0.0015;   // minimum size of a connected part, share of an image
constexpr double kPresent = 0.004;     // share of an image above which a color is present
constexpr double kMinPresence = 0.75;  // minimum share of the images with the color
constexpr double kMinCrisp = 0.65;     // 0.63 is the value in the middle of a color gradient
constexpr double kMinWhole = 0.7;
constexpr double kCrispSlack = 0.08;  // accepted loss for a wider tolerance

double distance(const Color& a, const Color& b) {
  double sum = 0;
  for (size_t k = 0; k < 3; ++k) sum += (a[k] - b[k]) * (a[k] - b[k]);
  return std::sqrt(sum);
}

double falling(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return 1 - t * t * (3 - 2 * t);
}

struct Pixels {
  int width, height;
  std::vector<Color> chromaticity;
  std::vector<bool> votes;
};

Pixels chromaticities(const LinearPicture& picture) {
  Pixels pixels{picture.width, picture.height, {}, {}};
  for (size_t i = 0; i + 2 < picture.rgb.size(); i += 3) {
    Color light;
    for (size_t c = 0; c < 3; ++c) light[c] = picture.rgb[i + c] + kLightFloor;
    const double mean = (light[0] + light[1] + light[2]) / 3;
    pixels.chromaticity.push_back({light[0] / mean, light[1] / mean, light[2] / mean});
    pixels.votes.push_back(mean > kDark);
  }
  return pixels;
}

/// Local maxima of the histogram of chromaticities.
std::vector<Color> peaks(const std::vector<Pixels>& pictures) {
  std::map<std::pair<int, int>, double> histogram;
  double count = 0;
  for (const Pixels& pixels : pictures) {
    count += static_cast<double>(pixels.votes.size());
    for (size_t i = 0; i < pixels.votes.size(); ++i) {
      const Color& c = pixels.chromaticity[i];
      if (pixels.votes[i])
        ++histogram[{static_cast<int>(c[0] / kCell), static_cast<int>(c[1] / kCell)}];
    }
  }
  const auto sum_around = [&](int x, int y) {
    double sum = 0;
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx)
        if (const auto cell = histogram.find({x + dx, y + dy}); cell != histogram.end())
          sum += cell->second * (dx ? 0.25 : 0.5) * (dy ? 0.25 : 0.5);
    return sum;
  };
  std::vector<Color> found;
  for (const auto& [at, ignored] : histogram) {
    const auto [x, y] = at;
    const double here = sum_around(x, y);
    bool highest = here >= kMinCell * count;
    for (int dy = -1; dy <= 1 && highest; ++dy)
      for (int dx = -1; dx <= 1; ++dx) highest = highest && here >= sum_around(x + dx, y + dy);
    const double red = (x + 0.5) * kCell, green = (y + 0.5) * kCell;
    if (highest) found.push_back({red, green, 3 - red - green});
  }
  return found;
}

/// Moves a color to the mean of its neighborhood.
Color refine_color(Color color, const std::vector<Pixels>& pictures) {
  for (int step = 0; step < 5; ++step) {
    Color sum{};
    double count = 0;
    for (const Pixels& pixels : pictures)
      for (size_t i = 0; i < pixels.votes.size(); ++i) {
        const Color& c = pixels.chromaticity[i];
        if (!pixels.votes[i] || distance(c, color) >= kNear) continue;
        for (size_t k = 0; k < 3; ++k) sum[k] += c[k];
        ++count;
      }
    if (count < 10) break;
    for (size_t k = 0; k < 3; ++k) color[k] = sum[k] / count;
  }
  return color;
}

/// Number of pixels in connected parts of at least `min_size` pixels.
size_t pixels_of_things(const std::vector<bool>& inside, int width, size_t min_size) {
  std::vector<bool> left = inside;
  std::vector<size_t> open;
  size_t sum = 0;
  for (size_t start = 0; start < left.size(); ++start) {
    if (!left[start]) continue;
    size_t size = 0;
    left[start] = false;
    open.push_back(start);
    while (!open.empty()) {
      const size_t at = open.back(), x = at % static_cast<size_t>(width);
      open.pop_back();
      ++size;
      const auto visit = [&](bool there, size_t next) {
        if (!there || !left[next]) return;
        left[next] = false;
        open.push_back(next);
      };
      visit(x > 0, at - 1);
      visit(x + 1 < static_cast<size_t>(width), at + 1);
      visit(at >= static_cast<size_t>(width), at - static_cast<size_t>(width));
      visit(at + static_cast<size_t>(width) < left.size(), at + static_cast<size_t>(width));
    }
    if (size >= min_size) sum += size;
  }
  return sum;
}

/// Pixels selected by a key of this chromaticity and tolerance, as in intrinsicrecolor.
struct Selection {
  double saturation = 0, tolerance = 0;
  double share = 0;     // of the pixels
  double crisp = 0;     // fully selected share of the touched pixels
  double whole = 0;     // share of the selected pixels in connected parts
  double presence = 0;  // share of the images with the color
  bool good() const {
    return share >= kMinShare &&
           share <= std::min(kMaxShare * saturation * saturation, kMaxOfAll) &&
           crisp >= kMinCrisp && whole >= kMinWhole && presence >= kMinPresence;
  }
};

Selection select(const Color& key, double tolerance, const std::vector<Pixels>& pictures) {
  Selection result;
  result.saturation = distance(key, kGray);
  result.tolerance = tolerance;
  double full = 0, half = 0, things = 0, inside_count = 0;
  for (const Pixels& pixels : pictures) {
    const size_t count = pixels.chromaticity.size();
    std::vector<bool> inside(count);
    double sum = 0;
    for (size_t i = 0; i < count; ++i) {
      const double selection =
          falling((distance(pixels.chromaticity[i], key) - tolerance) / (kSoftness * tolerance));
      sum += selection;
      full += selection >= 0.98;
      half += selection > 0.02 && selection < 0.98;
      inside[i] = selection > 0.5;
    }
    const double share = sum / static_cast<double>(count);
    result.share += share;
    result.presence += share > kPresent;
    inside_count += static_cast<double>(std::count(inside.begin(), inside.end(), true));
    things += static_cast<double>(
        pixels_of_things(inside, pixels.width,
                         static_cast<size_t>(std::ceil(kMinThing * static_cast<double>(count)))));
  }
  result.share /= static_cast<double>(pictures.size());
  result.presence /= static_cast<double>(pictures.size());
  result.crisp = full / std::max(full + half, 1.0);
  result.whole = things / std::max(inside_count, 1.0);
  return result;
}

}  // namespace

std::optional<KeyColor> find_key_color(const std::vector<LinearPicture>& pictures) {
  std::vector<Pixels> all;
  for (const LinearPicture& picture : pictures) all.push_back(chromaticities(picture));
  std::optional<KeyColor> best;
  double best_score = 0;
  for (const Color& peak : peaks(all)) {
    const Color key = refine_color(peak, all);
    const double saturation = distance(key, kGray);
    if (saturation < kMinSaturation) continue;
    std::vector<Selection> good;
    for (const double tolerance : kTolerances) {
      // Gray must stay unselected.
      if (tolerance * (1 + kSoftness / 2) > 0.9 * saturation) continue;
      if (const Selection selection = select(key, tolerance, all); selection.good())
        good.push_back(selection);
    }
    if (good.empty()) continue;
    double crispest = 0, score = 0;
    for (const Selection& selection : good) {
      crispest = std::max(crispest, selection.crisp);
      score = std::max(score, std::min(saturation, 1.5) * selection.crisp * selection.whole *
                                  std::min(1.0, std::sqrt(selection.share / 0.05)));
    }
    if (score <= best_score) continue;
    best_score = score;
    // The widest tolerance that is nearly as crisp leaves the thinnest rim of the old color.
    for (const Selection& selection : good)
      if (selection.crisp >= crispest - kCrispSlack)
        best = {key, selection.tolerance, kSoftness * selection.tolerance, selection.share};
  }
  return best;
}

}  // namespace inverse::run
