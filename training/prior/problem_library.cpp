// SPDX-License-Identifier: LGPL-2.1-or-later
// Examples of training/edges for Python (problem.py, by ctypes): what the prior's network sees of a
// picture, and the loss of a decomposition with what the network answers, with its derivative.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <random>
#include <string>

#include "tests/reference/intrinsic/prior_network.hpp"
#include "training/edges/colored_light.hpp"
#include "training/edges/couples.hpp"
#include "training/edges/problem.hpp"
#include "training/edges/weights.hpp"

namespace inverse::training {
namespace {

constexpr std::size_t kFields = reference::kPriorFields;
using Cells = decltype(Prior::cell);  // ln v, V, ln g
constexpr double kShareWeight = 2;    // of a kept share beside the distance of the whole change

std::size_t index(int x, int y, int width) {
  return std::size_t(y) * std::size_t(width) + std::size_t(x);
}

struct Problem {
  Example e;
  Prior fitted;
  Solution solution;
  std::mutex settling;
  Plane settled;                          // mean ln R of the last solution
  reference::PriorPicture picture{0, 0};  // that the network sees
  reference::Image input;

  std::size_t size() const { return std::size_t(picture.width) * std::size_t(picture.height); }
};

void make_input(Problem& p, double slope, int least_level) {
  const Example& e = p.e;
  const std::vector<double> rgb(e.input.data.begin(), e.input.data.end());
  reference::Guide guide = reference::make_guide(rgb.data(), e.width, e.height);
  guide.statistics.back() = std::min(std::abs(slope), 1.0);  // the picture is in white light
  p.picture = {e.width, e.height, least_level};
  p.input = reference::prior_input(guide, p.picture);
}

/// The weights of a file, which is read once.
const Weights& weights_of(const std::string& path) {
  static std::mutex mutex;
  static std::map<std::string, Weights> known;
  const std::lock_guard lock(mutex);
  const auto found = known.find(path);
  return found != known.end() ? found->second : known[path] = load_weights(path);
}

Problem* make_problem(const Scene& scene, double slope_error, unsigned seed, int least_level,
                      const Weights& weights) {
  auto p = std::make_unique<Problem>();
  std::mt19937 engine(seed);
  std::normal_distribution<double> normal;
  const double slope = light_slope(scene) + slope_error * normal(engine);
  p->e = make_example(scene, slope);
  draw_pairs(p->e);
  p->fitted = fitted_prior({weights.edge_hidden, weights.cell_hidden}, weights.values, p->e);
  make_input(*p, slope, least_level);
  for (auto* cues : {&p->e.right, &p->e.down, &p->e.cell}) cues->clear();  // fitted_prior had them
  return p.release();
}

/// Calls f(cell, network pixel, share of the pixel in the cell's mean).
template <class F>
void for_cells(const Problem& p, F f) {
  const int up = std::max(0, 2 - p.picture.level), down = std::max(0, p.picture.level - 2);
  for (int y = 0; y < p.e.cells_y; ++y)
    for (int x = 0; x < p.e.cells_x; ++x) {
      const int x0 = x << up >> down, x1 = std::min(p.picture.width, x0 + (1 << up)),
                y0 = y << up >> down, y1 = std::min(p.picture.height, y0 + (1 << up));
      const float share = 1.0F / float((x1 - x0) * (y1 - y0));
      for (int v = y0; v < y1; ++v)
        for (int u = x0; u < x1; ++u)
          f(index(x, y, p.e.cells_x), index(u, v, p.picture.width), share);
    }
}

/// The fitted prior, changed by fields.
Prior with_fields(const Problem& p, const float* fields) {
  Prior prior = p.fitted;
  for_cells(p, [&](std::size_t cell, std::size_t pixel, float share) {
    for (std::size_t o = 0; o < kFields; ++o)
      prior.cell[o][cell] += share * fields[o * p.size() + pixel];
  });
  return prior;
}

/// The derivative by fields of what has the derivative `change` by the prior's cells.
void to_fields(const Problem& p, const Cells& change, float* gradient) {
  std::fill(gradient, gradient + kFields * p.size(), 0.0F);
  for_cells(p, [&](std::size_t cell, std::size_t pixel, float share) {
    for (std::size_t o = 0; o < kFields; ++o)
      gradient[o * p.size() + pixel] += share * change[o][cell];
  });
}

Cells zeros_like(const Cells& cells) {
  Cells zeros;
  zeros.fill(Plane(cells[0].size(), 0));
  return zeros;
}

/// See problem_local_loss.
double local_loss(const Example& e, const Prior& prior, Cells& change) {
  constexpr double kNear = 0.2;
  const std::size_t cells = e.cell_m.size();
  change = zeros_like(prior.cell);
  Plane truth(cells, 0), count(cells, 0);
  for (std::size_t i = 0; i < e.m.size(); ++i)
    if (e.mask.data[i] > 0.5F && e.shading.data[i] > 1e-4F && e.m[i] > -5) {
      truth[std::size_t(e.cell_of(int(i)))] += std::log(e.shading.data[i]);
      count[std::size_t(e.cell_of(int(i)))] += 1;
    }
  Plane off(cells, 0), weight(cells, 0);
  for (std::size_t c = 0; c < cells; ++c) {
    if (count[c] == 0) continue;
    weight[c] = float(brightness_weight(e.cell_m[c]));
    off[c] = e.cell_value[c] + prior.cell[1][c] - truth[c] / count[c];
  }
  return distance_from_mean(weight, off, kNear, 1, change[1]);
}

/// The slope of a change by that of ln I is the sum of `part` times the change.
struct Share {
  Plane part;
  bool is_known = false;  ///< Enough was added.

  Share(const Example& before, const Example& after, const Plane& weight) : part(weight.size(), 0) {
    constexpr double kMinVariance = 0.05 * 0.05;
    const auto added = [&](std::size_t i) { return double(after.m[i]) - before.m[i]; };
    double n = 1e-9, mean = 0, variance = 1e-9;
    for (std::size_t i = 0; i < weight.size(); ++i)
      if (weight[i] > 0) n += 1, mean += added(i);
    mean /= n;
    for (std::size_t i = 0; i < weight.size(); ++i)
      if (weight[i] > 0) part[i] = float(added(i) - mean), variance += part[i] * part[i];
    for (float& p : part) p = float(p / variance);
    is_known = variance > n * kMinVariance;
  }
};

/// A photograph, the same with light, and one of the two with paint (training/couples).
struct Triple {
  std::array<Problem*, 3> picture;
  std::size_t base;  ///< Of the paint: 0 or 1.
  std::array<Change, 2> change;
  std::array<Share, 2> share;

  std::size_t before(std::size_t which) const { return which == 0 ? 0 : base; }
  std::size_t after(std::size_t which) const { return which + 1; }
};

/// Without a solve: the change of V between two pictures against the light that was added.
double local_loss(const Change& c, const Example& before, const Prior& v0, const Example& after,
                  const Prior& v1, Cells& d0, Cells& d1) {
  constexpr double kNear = 0.1;
  const std::size_t n = after.m.size(), cells = after.cell_m.size();
  Plane off(cells, 0), weight(cells, 0), slope(cells, 0);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t cell = std::size_t(after.cell_of(int(i)));
    off[cell] -= c.weight[i] * c.light[i], weight[cell] += c.weight[i];
  }
  for (std::size_t j = 0; j < cells; ++j) {
    if (weight[j] == 0) continue;
    off[j] = off[j] / weight[j] + after.cell_value[j] + v1.cell[1][j] - before.cell_value[j] -
             v0.cell[1][j];
  }
  const double error = distance_from_mean(weight, off, kNear, 1 / c.spread, slope);
  for (std::size_t j = 0; j < cells; ++j) d1[1][j] += slope[j], d0[1][j] -= slope[j];
  return error;
}

void add(Cells& to, const Cells& from, double factor) {
  for (std::size_t o = 0; o < to.size(); ++o)
    for (std::size_t i = 0; i < to[o].size(); ++i) to[o][i] += float(factor) * from[o][i];
}

/// The share of what was added that reflectance keeps: the slope of the change of ln R by that of
/// ln I, between two solved pictures.
double kept_share(const Triple& t, std::size_t which) {
  const Plane &part = t.share[which].part, &before = t.picture[t.before(which)]->solution.s,
              &after = t.picture[t.after(which)]->solution.s;
  double share = 1;
  for (std::size_t i = 0; i < part.size(); ++i)
    share -= double(part[i]) * (double(after[i]) - before[i]);
  return share;
}

/// The pseudo-Huber distance of the kept share from what it should be; adds the derivative by ln S
/// of the picture after (sign 1) or before (-1). A mean distance of planes is decided by weak and
/// wide changes, a share by large steps: a fit on the first alone keeps more and more light.
double share_distance(const Triple& t, std::size_t which, double sign, Plane& slope) {
  constexpr double kNear = 0.05;
  if (!t.share[which].is_known) return 0;
  const double off = kept_share(t, which) - double(which),
               root = std::sqrt(off * off + kNear * kNear);
  for (std::size_t i = 0; i < slope.size(); ++i)
    slope[i] -= float(kShareWeight * sign * off / root) * t.share[which].part[i];
  return kShareWeight * (root - kNear);
}

/// Solves the three pictures, and returns the distances of their changes of ln S from the light
/// that was added, and of the shares that they keep, each seen from both of its pictures;
/// `change`, if given, receives derivatives.
double solved_loss(Triple& t, const std::array<Prior, 3>& prior, std::array<Prior, 3>* change,
                   double* shares) {
  const auto solve = [&](std::size_t k, Prior* slope, const LossOfShading& loss_of) {
    return evaluate(t.picture[k]->e, prior[k], t.picture[k]->solution, slope, loss_of);
  };
  for (std::size_t k = 0; k < 3; ++k) solve(k, nullptr, [](const Plane&, Plane&) { return 0.0; });
  double value = 0;
  for (std::size_t k = 0; k < 3; ++k)
    value += solve(k, change ? &(*change)[k] : nullptr, [&](const Plane& s, Plane& slope) {
      double sum = 0;
      slope.assign(s.size(), 0);
      Plane one;
      for (const std::size_t which : {0, 1}) {
        const bool after = k == t.after(which);
        if (!after && k != t.before(which)) continue;
        const Problem& other = *t.picture[after ? t.before(which) : t.after(which)];
        const double sign = after ? 1 : -1;
        sum += change_distance(t.change[which], sign, s, other.solution.s, one);
        for (std::size_t i = 0; i < s.size(); ++i) slope[i] += one[i];
        sum += share_distance(t, which, sign, slope);
      }
      return sum;
    });
  for (const std::size_t which : {0, 1}) shares[which] = kept_share(t, which);
  return value / 2;
}

/// See triple_loss.
double loss_of(Triple& t, const std::array<const float*, 3>& fields, double solved, double local,
               double* shares, const std::array<float*, 3>& gradient) {
  std::array<Prior, 3> prior, slope;
  std::array<Cells, 3> change;
  for (std::size_t k = 0; k < 3; ++k)
    prior[k] = with_fields(*t.picture[k], fields[k]), change[k] = zeros_like(prior[k].cell);
  double value = 0;
  if (solved > 0) {
    value += solved * solved_loss(t, prior, gradient[0] ? &slope : nullptr, shares);
    if (gradient[0])
      for (std::size_t k = 0; k < 3; ++k) add(change[k], slope[k].cell, solved);
  }
  if (local > 0)
    for (const std::size_t which : {0, 1}) {
      const std::size_t a = t.before(which), b = t.after(which);
      Cells da = zeros_like(change[a]), db = zeros_like(change[b]);
      value += local * local_loss(t.change[which], t.picture[a]->e, prior[a], t.picture[b]->e,
                                  prior[b], da, db);
      add(change[a], da, local), add(change[b], db, local);
    }
  if (gradient[0])
    for (std::size_t k = 0; k < 3; ++k) to_fields(*t.picture[k], change[k], gradient[k]);
  return value;
}

}  // namespace
}  // namespace inverse::training

using namespace inverse::training;
namespace bench = inverse::bench;

extern "C" {

/// A procedural scene (scenes.hpp). `least_level`: of the network's picture, 0…2; it is higher
/// where that would be too large.
void* problem_of_seed(std::uint32_t seed, int width, int height, int least_level,
                      double slope_error, const char* weights) {
  return make_problem(make_scene(seed, width, height), slope_error, seed, least_level,
                      weights_of(weights));
}

/// A picture with truth: input, reflectance, irradiance (interleaved RGB, linear), mask.
void* problem_of_picture(const float* input, const float* reflectance, const float* shading,
                         const float* mask, int width, int height, int least_level,
                         double slope_error, unsigned seed, const char* weights) {
  const std::size_t n = std::size_t(width) * std::size_t(height);
  const auto image = [&](const float* values, int channels) {
    bench::Image out(width, height, channels);
    std::copy(values, values + n * std::size_t(channels), out.data.begin());
    return out;
  };
  return make_problem({image(input, 3), image(reflectance, 3), image(shading, 3), image(mask, 1)},
                      slope_error, seed, least_level, weights_of(weights));
}

void problem_free(void* problem) { delete static_cast<Problem*>(problem); }

/// Width and height of the picture; width, height and padded size of the network's; its level.
void problem_size(const void* problem, int* out) {
  const auto& p = *static_cast<const Problem*>(problem);
  const int size[] = {p.e.width,
                      p.e.height,
                      p.picture.width,
                      p.picture.height,
                      int(p.input.shape.width),
                      int(p.input.shape.height),
                      p.picture.level};
  std::copy(std::begin(size), std::end(size), out);
}

/// 6 x padded height x padded width.
void problem_input(const void* problem, float* out) {
  const auto& p = *static_cast<const Problem*>(problem);
  std::copy(p.input.data.begin(), p.input.data.end(), out);
}

/// `fields`: ln v, V and ln g, 3 x height x width of the network's picture; `twin`: the same scene
/// in another light, or null. Returns the loss; `gradient`, if not null, receives its derivative by
/// the fields; what was last found for the twin is constant in it. Not for one problem in two
/// threads.
double problem_loss(void* problem, const float* fields, double equal, double different,
                    double alike, void* twin, float* gradient) {
  auto& p = *static_cast<Problem*>(problem);
  const Prior prior = with_fields(p, fields);
  Prior change;
  Plane other;
  if (auto* t = static_cast<Problem*>(twin)) {
    const std::lock_guard lock(t->settling);
    other = t->settled;
  }
  const double value = evaluate(p.e, prior, p.solution, gradient ? &change : nullptr,
                                {equal, different, alike, &other});
  const std::lock_guard lock(p.settling);
  p.settled = p.e.m;
  for (std::size_t i = 0; i < p.settled.size(); ++i) p.settled[i] -= p.solution.s[i];
  if (gradient) to_fields(p, change.cell, gradient);
  return value;
}

/// Without a solve: how far V is from true ln shading, less the mean difference (pseudo-Huber).
double problem_local_loss(void* problem, const float* fields, float* gradient) {
  const auto& p = *static_cast<const Problem*>(problem);
  const Prior prior = with_fields(p, fields);
  Cells change;
  const double value = local_loss(p.e, prior, change);
  if (gradient) to_fields(p, change, gradient);
  return value;
}

/// Of the last problem_loss: ln shading; of the picture in white light: input and true reflectance
/// (interleaved RGB), true shading, mask.
void problem_planes(const void* problem, float* s, float* input, float* reflectance, float* shading,
                    float* mask) {
  const auto& p = *static_cast<const Problem*>(problem);
  std::copy(p.solution.s.begin(), p.solution.s.end(), s);
  std::copy(p.e.input.data.begin(), p.e.input.data.end(), input);
  std::copy(p.e.reflectance.data.begin(), p.e.reflectance.data.end(), reflectance);
  std::copy(p.e.shading.data.begin(), p.e.shading.data.end(), shading);
  std::copy(p.e.mask.data.begin(), p.e.mask.data.end(), mask);
}

/// A photograph, the same with light, and one of the two (`base`: 0 or 1) with paint, which are
/// kept by the caller. `light`: the ratio of the light that was added (interleaved RGB).
void* triple_of(void* first, void* lit, void* painted, int base, const float* light) {
  const std::array<Problem*, 3> picture{static_cast<Problem*>(first), static_cast<Problem*>(lit),
                                        static_cast<Problem*>(painted)};
  const Example& e = picture[0]->e;
  bench::Image ratio(e.width, e.height, 3), none = ratio;
  std::copy(light, light + ratio.data.size(), ratio.data.begin());
  std::fill(none.data.begin(), none.data.end(), 1.0F);
  const Example &lit_one = picture[1]->e, &unpainted = picture[std::size_t(base)]->e,
                &painted_one = picture[2]->e;
  const Change by_light(e, lit_one, ratio), by_paint(unpainted, painted_one, none);
  return new Triple{
      picture,
      std::size_t(base),
      {by_light, by_paint},
      {Share(e, lit_one, by_light.weight), Share(unpainted, painted_one, by_paint.weight)}};
}

void triple_free(void* triple) { delete static_cast<Triple*>(triple); }

/// `fields` and `gradient`: of the three pictures, as in problem_loss; `gradient` may have nulls.
/// Returns `solved` x the distance of the changes of ln S from the light that was added, as shares
/// of what was added, and of the shares that reflectance keeps from 0 and 1, + `local` x a loss
/// that takes no solve. `shares` receives the shares of light and of paint that reflectance keeps,
/// if `solved` is above 0. Not in two threads.
double triple_loss(void* triple, const float* const* fields, double solved, double local,
                   double* shares, float* const* gradient) {
  return loss_of(*static_cast<Triple*>(triple), {fields[0], fields[1], fields[2]}, solved, local,
                 shares, {gradient[0], gradient[1], gradient[2]});
}
}
