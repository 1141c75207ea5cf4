// SPDX-License-Identifier: LGPL-2.1-or-later
#include "strokes.hpp"

#include <algorithm>
#include <cmath>

#include "pyramid.hpp"

namespace inverse::reference {
namespace {

using Complex = std::complex<double>;

double distance(Complex p, Complex from, Complex to) {
  const Complex line = to - from;
  const double length = std::norm(line);
  const double along =
      length > 0 ? std::clamp(std::real((p - from) * std::conj(line)) / length, 0.0, 1.0) : 0;
  return std::abs(p - from - along * line);
}

constexpr double kLightFloor = 0.02, kStatic = 0.1, kMoved = 0.05, kConverged = 0.02;
constexpr double kSharpness = 0.35, kMinSigma = 0.08, kMinTexture = 0.03;
constexpr double kFitLost = 0.5, kFitFound = 0.65, kMinSpread = 0.25, kMinInside = 0.3,
                 kLeaving = 0.6;
constexpr double kDamping = 0.02, kNewTurn = 0.12, kNewFit = 0.15, kFar = 0.002, kFitWell = 0.8,
                 kEven = 0.05;
constexpr int kSteps = 5, kReach = 5, kSearchLevel = 2;
constexpr std::size_t kSearched = 256;

/// Solves a symmetric positive definite system by Gaussian elimination.
std::array<double, 5> solve(std::array<std::array<double, 5>, 5> a, std::array<double, 5> b) {
  for (std::size_t k = 0; k < 5; ++k)
    for (std::size_t m = k + 1; m < 5; ++m) {
      const double factor = a[m][k] / a[k][k];
      for (std::size_t n = k; n < 5; ++n) a[m][n] -= factor * a[k][n];
      b[m] -= factor * b[k];
    }
  for (std::size_t k = 5; k-- > 0;) {
    for (std::size_t n = k + 1; n < 5; ++n) b[k] -= a[k][n] * b[n];
    b[k] /= a[k][k];
  }
  return b;
}

}  // namespace

StrokeWeights draw_strokes(const std::vector<StrokeLine>& lines,
                           const std::vector<StrokeMove>& moves, int width, int height) {
  StrokeWeights result;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      int stroke = -1;
      double best = 0;
      for (std::size_t k = 0; k < lines.size(); ++k) {
        const StrokeMove& move = moves[k];
        const Complex drawn =
            move.center + (Complex(x + .5, y + .5) - move.center - move.shift) / move.turn;
        const auto& [points, radius] = lines[k];
        double nearest = radius;
        for (std::size_t i = 0; i < points.size(); ++i)
          nearest = std::min(nearest, distance(drawn, points[i > 0 ? i - 1 : 0], points[i]));
        const double border = std::min(radius, std::max(radius / 4, 2.0));
        const double weight = std::pow(std::min(1.0, (radius - nearest) / border), 2);
        if (!(weight > 0) || weight < best) continue;
        best = weight;
        stroke = static_cast<int>(k);
      }
      result.stroke.push_back(stroke);
      result.weight.push_back(best);
    }
  return result;
}

double StrokeTrack::sigma() const { return std::max(kSharpness * texture_, kMinSigma); }

bool StrokeTrack::inside(Complex place) const {
  return place.real() >= 0 && place.imag() >= 0 && place.real() <= frame_[0].width &&
         place.imag() <= frame_[0].height;
}

double StrokeTrack::value(int level, Complex place) const {
  const Level& of = frame_[static_cast<std::size_t>(level)];
  const double x = std::clamp(place.real(), -8.0, frame_[0].width + 8.0) / (1 << level) - .5,
               y = std::clamp(place.imag(), -8.0, frame_[0].height + 8.0) / (1 << level) - .5;
  const auto at = [&](double u, double v) {
    const int i = std::clamp(static_cast<int>(u), 0, of.width - 1),
              j = std::clamp(static_cast<int>(v), 0, of.height - 1);
    return of.values[static_cast<std::size_t>(j) * static_cast<std::size_t>(of.width) +
                     static_cast<std::size_t>(i)];
  };
  const double left = std::floor(x), up = std::floor(y), a = x - left, b = y - up;
  return (1 - b) * ((1 - a) * at(left, up) + a * at(left + 1, up)) +
         b * ((1 - a) * at(left, up + 1) + a * at(left + 1, up + 1));
}

double StrokeTrack::step(int level) {
  std::array<std::array<double, 5>, 5> a{};
  std::array<double, 5> b{};
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const Template& known = templates_[static_cast<std::size_t>(level)][i];
    const Complex place = moved(samples_[i].at), u = samples_[i].at / radius_;
    if (!known.known || !inside(place)) continue;
    const double r = value(level, place) - known.value - gain_;
    const double w = samples_[i].weight / std::pow(1 + r * r / (sigma() * sigma()), 2);
    // Of the template at u, if it turns by q0 + i q1, moves by q2, q3 and becomes brighter by q4.
    const std::array<double, 5> j{std::real(std::conj(known.gradient) * u),
                                  std::real(std::conj(known.gradient) * u * Complex(0, 1)),
                                  known.gradient.real(), known.gradient.imag(), 1};
    for (std::size_t m = 0; m < 5; ++m) {
      for (std::size_t n = 0; n < 5; ++n) a[m][n] += w * j[m] * j[n];
      b[m] += w * j[m] * r;
    }
  }
  const double weight = a[4][4];
  for (std::size_t m = 0; m < 4; ++m)
    a[m][m] += std::pow(kDamping / (1 << level), 2) * weight + 1e-9;
  a[4][4] += 1e-9;
  const auto q = solve(a, b);
  const Complex turn(q[0], q[1]), shift(q[2], q[3]);
  const double far = std::max(std::abs(turn), std::abs(shift));
  if (!(far < 1e6)) return 0;
  const double part =
      std::min(1.0, std::min(2.0 * (1 << level), .3 * radius_) / std::max(far, 1e-6));
  move_.turn /= 1.0 + part * turn / radius_;
  move_.shift -= move_.turn * part * shift;
  gain_ += q[4];
  return part * far;
}

double StrokeTrack::telling(int level, std::size_t i) const {
  const Template& known = templates_[static_cast<std::size_t>(level)][i];
  return samples_[i].weight *
         std::clamp(std::abs(known.gradient) * (1 << level) / std::max(texture_, kMinTexture),
                    kEven, 1.0);
}

StrokeTrack::Fit StrokeTrack::fit(int level) const {
  double all = 0, in = 0, fits = 0, weight = 0, sum = 0, squares = 0;
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const Template& known = templates_[static_cast<std::size_t>(level)][i];
    const double tells = telling(level, i), w = samples_[i].weight;
    all += tells;
    if (!known.known || !inside(moved(samples_[i].at))) continue;
    in += tells;
    if (!(std::abs(value(level, moved(samples_[i].at)) - known.value - gain_) < sigma())) continue;
    fits += tells;
    weight += w, sum += w * known.value, squares += w * known.value * known.value;
  }
  weight = std::max(weight, 1e-6);
  return {in / std::max(all, 1e-6), fits / std::max(in, 1e-6),
          std::max(squares / weight - std::pow(sum / weight, 2), 0.0)};
}

void StrokeTrack::align(int from) {
  for (int level = from; level >= 0; --level)
    for (int k = 0; k < kSteps; ++k)
      if (!(step(level) >= kConverged * (1 << level))) break;
}

void StrokeTrack::search() {
  const int coarsest = std::min(levels_, kSearchLevel);
  const std::size_t every = (samples_.size() + kSearched - 1) / kSearched;
  for (int level = coarsest; level >= 0; --level) {
    const int reach = level == coarsest ? kReach : 2;
    const Complex from = move_.shift;
    Complex best = from;
    double least = 1e9;
    for (int y = -reach; y <= reach; ++y)
      for (int x = -reach; x <= reach; ++x) {
        move_.shift = from + Complex(x, y) * static_cast<double>(1 << level);
        double all = 0, in = 0, sum = 0, squares = 0;
        for (std::size_t i = 0; i < samples_.size(); i += every) {
          const Template& known = templates_[static_cast<std::size_t>(level)][i];
          if (!known.known) continue;
          const double tells = telling(level, i);
          all += tells;
          const Complex place = moved(samples_[i].at);
          if (!inside(place)) continue;
          const double apart = value(level, place) - known.value;
          in += tells, sum += tells * apart, squares += tells * apart * apart;
        }
        if (!(in > .5 * all)) continue;
        const double off = squares / in - std::pow(sum / in, 2) + kFar * (x * x + y * y);
        if (off >= least) continue;
        least = off;
        best = move_.shift;
        gain_ = sum / in;
      }
    move_.shift = best;
  }
}

void StrokeTrack::take(bool all) {
  const int judged = std::min(levels_, 2);
  templates_.resize(static_cast<std::size_t>(levels_) + 1);
  for (auto& level : templates_) level.resize(samples_.size());
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const Complex at = samples_[i].at, place = moved(at);
    const double was = templates_[static_cast<std::size_t>(judged)][i].value;
    if (!all && !(inside(place) && std::abs(value(judged, place) - was - gain_) < sigma()))
      continue;
    for (int level = 0; level <= levels_; ++level) {
      const double by = (1 << level) / std::abs(move_.turn);
      const auto slope = [&](Complex along) {
        return (value(level, moved(at + by * along)) - value(level, moved(at - by * along))) /
               (2 * by);
      };
      templates_[static_cast<std::size_t>(level)][i] = {
          value(level, place), {slope({1, 0}), slope({0, 1})}, inside(place)};
    }
  }
}

bool StrokeTrack::acceptable(const Fit& fit) const {
  return fit.inside >= kMinInside &&
         fit.fits >= (state_ == State::followed ? kFitLost : kFitFound) &&
         fit.variance >= kMinSpread * texture_ * texture_;
}

void StrokeTrack::follow(const std::vector<double>& rgb, int width, int height) {
  Level level{width, height, {}};
  for (std::size_t i = 0; i < rgb.size(); i += 3) {
    double mean = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const double light = rgb[i + c];
      mean += (light > 0 ? std::min(light, 65504.0) : 0) / 3;
    }
    level.values.push_back(std::log(mean + kLightFloor));
  }
  frame_ = {level};
  for (int k = 0; k < levels_; ++k) {
    level.values = halve(level.values, static_cast<uint32_t>(level.width),
                         static_cast<uint32_t>(level.height), 1);
    level.width = (level.width + 1) / 2, level.height = (level.height + 1) / 2;
    frame_.push_back(level);
  }

  const StrokeMove before = move_;
  const double gain_before = gain_;
  const int judged = std::min(levels_, 2);
  if (state_ == State::followed && fit0_ >= 0) {
    const Fit now = fit(0);
    const double far = step(0);
    move_ = before, gain_ = gain_before;
    if (far < kStatic && now.inside > kMinInside && now.fits > fit0_ - .05) {
      velocity_ = 0;
      return;
    }
  }
  if (state_ == State::waiting) {
    take(true);
    double all = 0, sum = 0, squares = 0;
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      const Template& known = templates_[static_cast<std::size_t>(judged)][i];
      if (!known.known) continue;
      const double w = samples_[i].weight;
      all += w, sum += w * known.value, squares += w * known.value * known.value;
    }
    all = std::max(all, 1e-6);
    texture_ = std::sqrt(std::max(squares / all - std::pow(sum / all, 2), 0.0));
    gain_ = best_ = 0;
    if (texture_ >= kMinTexture) state_ = State::followed;
    return;
  }
  if (state_ == State::followed) move_.shift += velocity_;
  const bool leaves = state_ == State::followed && fit(judged).inside < kLeaving;
  align(levels_);
  Fit now = fit(judged);
  if (!(now.fits >= kFitWell)) {
    const StrokeMove first = move_;
    const double gain_first = gain_;
    move_ = before;
    search();
    align(std::min(levels_, 1));
    const Fit other = fit(judged);
    if (other.fits > now.fits)
      now = other;
    else
      move_ = first, gain_ = gain_first;
  }
  const double scale = std::abs(move_.turn);
  if (!acceptable(now) || !(scale > .2 && scale < 5)) {
    move_ = before, gain_ = gain_before, velocity_ = 0;
    state_ = state_ == State::outside || leaves ? State::outside : State::lost;
    return;
  }
  const double far =
      std::max(std::abs(move_.shift - before.shift), radius_ * std::abs(move_.turn - before.turn));
  velocity_ = state_ == State::followed ? move_.shift - before.shift : 0;
  if (state_ == State::followed && !(far > kMoved)) move_ = before;
  state_ = State::followed;
  best_ = std::max(best_, now.fits);
  if (now.inside > .9 &&
      (std::abs(move_.turn - key_) > kNewTurn * std::abs(key_) || now.fits < best_ - kNewFit)) {
    take(false);
    key_ = move_.turn;
    best_ = now.fits;
  }
  fit0_ = fit(0).fits;
}

}  // namespace inverse::reference
