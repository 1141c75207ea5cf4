// SPDX-License-Identifier: LGPL-2.1-or-later
#include "couples.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "colored_light.hpp"
#include "scene_files.hpp"

namespace inverse::training {
namespace {

constexpr double kNear = 0.02, kMinSpread = 0.05;
constexpr double kStepWeight =
    0.5 / 8;  // of steps at each scale and way, beside the planes themselves

/// The pseudo-Huber distance of steps of `off` over 1, 2, 4 and 8 pixels from 0, a mean of each
/// scale; adds the derivative by `off`.
double step_distance(const Change& c, const Plane& off, double factor, Plane& gradient) {
  const std::size_t w = std::size_t(c.width), n = off.size();
  double error = 0;
  for (std::size_t apart = 1; apart <= 8; apart *= 2)
    for (const bool down : {false, true}) {
      const std::size_t stride = down ? apart * w : apart;
      const auto inside = [&](std::size_t i) { return down ? i + stride < n : i % w + apart < w; };
      double all = 1e-9;
      for (std::size_t i = 0; i < n; ++i)
        if (inside(i)) all += std::min(c.weight[i], c.weight[i + stride]);
      for (std::size_t i = 0; i < n; ++i) {
        if (!inside(i)) continue;
        const double weight = factor * std::min(c.weight[i], c.weight[i + stride]) / all,
                     step = double(off[i + stride]) - off[i],
                     root = std::sqrt(step * step + kNear * kNear);
        error += weight * (root - kNear);
        gradient[i + stride] += float(weight * step / root);
        gradient[i] -= float(weight * step / root);
      }
    }
  return error;
}

}  // namespace

Change::Change(const Example& before, const Example& after, const bench::Image& ratio)
    : width(after.width) {
  const std::size_t n = after.m.size();
  if (before.m.size() != n || ratio.data.size() != 3 * n || before.width != width)
    throw std::runtime_error("a couple's pictures differ in size");
  light.assign(n, 0), weight.assign(n, 0);
  double all = 1e-9, mean = 0;
  const auto added = [&](std::size_t i) { return double(after.m[i]) - before.m[i]; };
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t c = 0; c < 3; ++c) light[i] += std::log(ratio.data[3 * i + c]) / 3;
    if (after.mask.data[i] < 0.5F) continue;
    weight[i] = float(brightness_weight(std::min(before.m[i], after.m[i])));
    all += weight[i], mean += weight[i] * added(i);
  }
  double sum = 0;
  for (std::size_t i = 0; i < n; ++i) sum += weight[i] * std::abs(added(i) - mean / all);
  spread = std::max(sum / all, kMinSpread);
}

double change_distance(const Change& c, double sign, const Plane& s, const Plane& other,
                       Plane& gradient) {
  Plane off(s.size());
  for (std::size_t i = 0; i < s.size(); ++i) off[i] = s[i] - other[i] - float(sign) * c.light[i];
  gradient.assign(s.size(), 0);
  const double factor = 1 / c.spread;
  return distance_from_mean(c.weight, off, kNear, factor, gradient) +
         step_distance(c, off, kStepWeight * factor, gradient);
}

Couple load_couple(const std::string& path, std::mt19937& engine) {
  const Scene after = load_scene(path);
  Scene before = after;
  before.input = after.reflectance;
  std::normal_distribution<double> error(0, kSlopeError);
  const double slope = light_slope(after);
  Example first = make_example(before, slope + error(engine));
  Example last = make_example(after, slope + error(engine));
  Change change(first, last, after.shading);
  return {std::move(first), std::move(last), std::move(change)};
}

double evaluate(const Model& model, const std::vector<float>& parameters, const Couple& c,
                CoupleSolution& solution, std::vector<double>* gradient) {
  Solution &before = solution.before, &after = solution.after;
  evaluate(model, parameters, c.before, before, nullptr, [](const Plane&, Plane&) { return 0.0; });
  const double value = evaluate(
      model, parameters, c.after, after, gradient,
      [&](const Plane& s, Plane& d) { return change_distance(c.change, 1, s, before.s, d); });
  // Through the other picture, while this one's solution is constant.
  if (gradient)
    evaluate(model, parameters, c.before, before, gradient, [&](const Plane& s, Plane& d) {
      return change_distance(c.change, -1, s, after.s, d);
    });
  return value;
}

}  // namespace inverse::training
