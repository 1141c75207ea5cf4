// SPDX-License-Identifier: LGPL-2.1-or-later
#include "light_evidence.hpp"

#include <algorithm>
#include <cmath>

namespace inverse {
namespace {

// Relative levels: 0 is black, 1 is full. The ranges are wide, because a contradiction is final.
constexpr double kMaxBlack = 0.25, kMinFull = 0.5, kMaxOlat = 0.5;
constexpr double kMinGradient = 0.06, kMaxGradient = 0.95;
constexpr size_t kManyLights = 16;        // with so many, a single one is below kMaxOlat
constexpr double kGradientMargin = 0.25;  // of the distance between the two gradients
constexpr uint64_t kMinSamples = 4;
constexpr double kLearningRate = 1.0 / 8;
constexpr double kMaxClipped = 0.02;      // share of pixels
constexpr double kMinFramingScale = 0.2;  // of brightness after a change of framing

size_t gradient_index(StepKind kind) { return kind == StepKind::gradient_b ? 1 : 0; }
bool is_gradient(StepKind kind) {
  return kind == StepKind::gradient_a || kind == StepKind::gradient_b;
}

}  // namespace

void LightEvidence::start(double black, double full, bool clipped) {
  black_ = black;
  full_ = full;
  clipped_ = clipped;
  gradient_[0] = gradient_[1] = {};
  variance_ = 0;
  scaled_ = true;
}

void LightEvidence::new_framing() {
  scaled_ = false;
  framed_ = {};
}

void LightEvidence::find_scale(LightProgram::Position position, const ImageEvidence& image) {
  if (scaled_ || !started() || position.part == LightProgram::Position::Part::ended) return;
  const StepKind kind = program_.kind(position);
  double scale = 0;
  if (kind == StepKind::tracking) {
    scale = image.luminance() / (black_ + exposure_of(position) * (full_ - black_));
  } else if (is_gradient(kind) && exposure_of(position) == 1) {
    framed_[gradient_index(kind)] = image.luminance();
    // A + B is the image under all lights plus twice the ambient light.
    if (framed_[0] > 0 && framed_[1] > 0) scale = (framed_[0] + framed_[1]) / (full_ + black_);
  }
  if (!(scale > kMinFramingScale) || !std::isfinite(scale)) return;
  scaled_ = true;
  black_ *= scale;
  full_ *= scale;
  for (Learned& learned : gradient_)
    for (double& level : learned.mean) level *= scale;
}

double LightEvidence::exposure_of(LightProgram::Position position) const {
  if (position.part != LightProgram::Position::Part::step || program_.exposure <= 0) return 1;
  return program_.steps[position.index].exposure.value_or(program_.exposure) / program_.exposure;
}

double LightEvidence::relative(LightProgram::Position position, const ImageEvidence& image) const {
  const double exposure = std::max(exposure_of(position), 1e-6);
  return (image.luminance() - black_) / ((full_ - black_) * exposure);
}

bool LightEvidence::confirms(LightProgram::Position position, const ImageEvidence& image) const {
  if (!usable() || position.part == LightProgram::Position::Part::ended) return false;
  const StepKind kind = program_.kind(position);
  const double y = relative(position, image);
  if (kind == StepKind::tracking) return y >= kMinFull || (clipped_ && image.clipped > kMaxClipped);
  return is_gradient(kind) && y >= kMinGradient;
}

bool LightEvidence::bright(const ImageEvidence& image) const {
  return usable() && image.luminance() - black_ > 0.5 * (full_ - black_);
}

std::optional<double> LightEvidence::between(const ImageEvidence& image) const {
  if (std::min(gradient_[0].count, gradient_[1].count) < kMinSamples) return std::nullopt;
  double along = 0, length = 0;
  for (size_t c = 0; c < 3; ++c) {
    const double a = gradient_[0].mean[c], b = gradient_[1].mean[c];
    along += (image.level[c] - (a + b) / 2) * (b - a);
    length += (b - a) * (b - a);
  }
  if (length <= 0) return std::nullopt;
  return along / length;
}

double LightEvidence::separation() const {
  if (std::min(gradient_[0].count, gradient_[1].count) < kMinSamples) return 0;
  return variance_ > 0 ? 1 / std::sqrt(variance_) : 1e6;
}

void LightEvidence::learn(LightProgram::Position position, const ImageEvidence& image) {
  if (!usable() || position.part == LightProgram::Position::Part::ended) return;
  const StepKind kind = program_.kind(position);
  if (kind == StepKind::black) black_ += kLearningRate * (image.luminance() - black_);
  if (kind == StepKind::tracking && exposure_of(position) == 1) {
    full_ += kLearningRate * (image.luminance() - full_);
    clipped_ = image.clipped > kMaxClipped;
  }
  if (!is_gradient(kind) || exposure_of(position) != 1) return;
  if (const auto at = between(image)) {
    const double off = *at - (kind == StepKind::gradient_b ? 0.5 : -0.5);
    variance_ += kLearningRate * (off * off - variance_);
  }
  Learned& learned = gradient_[gradient_index(kind)];
  ++learned.count;
  const double share = std::max(kLearningRate, 1.0 / static_cast<double>(learned.count));
  for (size_t c = 0; c < 3; ++c) learned.mean[c] += share * (image.level[c] - learned.mean[c]);
  // A + B is the image under all lights: the scale follows the camera's exposure.
  if (std::min(gradient_[0].count, gradient_[1].count) < kMinSamples) return;
  double sum = 0;
  for (size_t c = 0; c < 3; ++c) sum += (gradient_[0].mean[c] + gradient_[1].mean[c]) / 3;
  const double full = sum - black_;
  if (full > black_) full_ += kLearningRate * (full - full_);
}

bool LightEvidence::contradicts(LightProgram::Position position, const ImageEvidence& image) const {
  if (!started() || position.part == LightProgram::Position::Part::ended) return false;
  const StepKind kind = program_.kind(position);
  const double y = relative(position, image);
  if (!scaled_ && is_gradient(kind)) {
    const double other = framed_[1 - gradient_index(kind)];
    return other > 0 && image.luminance() + other < kMinFramingScale * (full_ + black_);
  }
  if (!scaled_) return kind == StepKind::tracking && y < kMinFramingScale;
  switch (kind) {
    case StepKind::black:
      return y > kMaxBlack;
    case StepKind::tracking:
      return y < kMinFull && !clipped_;
    case StepKind::olat:
      return program_.lights.size() >= kManyLights && y > kMaxOlat;
    case StepKind::gradient_a:
    case StepKind::gradient_b: {
      if (y < kMinGradient) return true;
      if (y > kMaxGradient && !clipped_ && image.clipped <= kMaxClipped) return true;
      if (separation() < kMinSeparation) return false;
      const double at = *between(image);
      return kind == StepKind::gradient_a ? at > kGradientMargin : at < -kGradientMargin;
    }
    case StepKind::custom:
      return false;  // its level is unknown
  }
  return false;
}

}  // namespace inverse
