#include "light_evidence.hpp"

#include <algorithm>
#include <cmath>

namespace inverse {
namespace {

// Shares of the way from black to full. Wide: what they rule out is ruled out for good.
constexpr double kBlackAtMost = 0.25, kFullAtLeast = 0.5, kOlatAtMost = 0.5;
constexpr double kGradientAtLeast = 0.06, kGradientAtMost = 0.95;
constexpr size_t kManyLights = 16;  // of which one alone is never half of all
constexpr double kClearly = 0.25;   // in units of the distance of the two gradients
constexpr uint64_t kLearned = 4;
constexpr double kSlow = 1.0 / 8;
constexpr double kMuchClipped = 0.02;
constexpr double kDimmestFraming = 0.2;  // of what a subject was before, in another frame

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
  spread_ = 0;
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
    // A + B is the picture under all lights, with what is there without them twice.
    if (framed_[0] > 0 && framed_[1] > 0) scale = (framed_[0] + framed_[1]) / (full_ + black_);
  }
  if (!(scale > kDimmestFraming) || !std::isfinite(scale)) return;
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
  if (!tells() || position.part == LightProgram::Position::Part::ended) return false;
  const StepKind kind = program_.kind(position);
  const double y = relative(position, image);
  if (kind == StepKind::tracking)
    return y >= kFullAtLeast || (clipped_ && image.clipped > kMuchClipped);
  return is_gradient(kind) && y >= kGradientAtLeast;
}

bool LightEvidence::bright(const ImageEvidence& image) const {
  return tells() && image.luminance() - black_ > 0.5 * (full_ - black_);
}

std::optional<double> LightEvidence::between(const ImageEvidence& image) const {
  if (std::min(gradient_[0].count, gradient_[1].count) < kLearned) return std::nullopt;
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
  if (std::min(gradient_[0].count, gradient_[1].count) < kLearned) return 0;
  return spread_ > 0 ? 1 / std::sqrt(spread_) : 1e6;
}

void LightEvidence::learn(LightProgram::Position position, const ImageEvidence& image) {
  if (!tells() || position.part == LightProgram::Position::Part::ended) return;
  const StepKind kind = program_.kind(position);
  if (kind == StepKind::black) black_ += kSlow * (image.luminance() - black_);
  if (kind == StepKind::tracking && exposure_of(position) == 1) {
    full_ += kSlow * (image.luminance() - full_);
    clipped_ = image.clipped > kMuchClipped;
  }
  if (!is_gradient(kind) || exposure_of(position) != 1) return;
  if (const auto at = between(image)) {
    const double off = *at - (kind == StepKind::gradient_b ? 0.5 : -0.5);
    spread_ += kSlow * (off * off - spread_);
  }
  Learned& learned = gradient_[gradient_index(kind)];
  ++learned.count;
  const double share = std::max(kSlow, 1.0 / static_cast<double>(learned.count));
  for (size_t c = 0; c < 3; ++c) learned.mean[c] += share * (image.level[c] - learned.mean[c]);
  // A + B is the picture under all lights: the scale follows the camera's exposure.
  if (std::min(gradient_[0].count, gradient_[1].count) < kLearned) return;
  double sum = 0;
  for (size_t c = 0; c < 3; ++c) sum += (gradient_[0].mean[c] + gradient_[1].mean[c]) / 3;
  const double full = sum - black_;
  if (full > black_) full_ += kSlow * (full - full_);
}

bool LightEvidence::contradicts(LightProgram::Position position, const ImageEvidence& image) const {
  if (!started() || position.part == LightProgram::Position::Part::ended) return false;
  const StepKind kind = program_.kind(position);
  const double y = relative(position, image);
  if (!scaled_ && is_gradient(kind)) {
    const double other = framed_[1 - gradient_index(kind)];
    return other > 0 && image.luminance() + other < kDimmestFraming * (full_ + black_);
  }
  if (!scaled_) return kind == StepKind::tracking && y < kDimmestFraming;
  switch (kind) {
    case StepKind::black:
      return y > kBlackAtMost;
    case StepKind::tracking:
      return y < kFullAtLeast && !clipped_;
    case StepKind::olat:
      return program_.lights.size() >= kManyLights && y > kOlatAtMost;
    case StepKind::gradient_a:
    case StepKind::gradient_b: {
      if (y < kGradientAtLeast) return true;
      if (y > kGradientAtMost && !clipped_ && image.clipped <= kMuchClipped) return true;
      if (separation() < kTellable) return false;
      const double at = *between(image);
      return kind == StepKind::gradient_a ? at > kClearly : at < -kClearly;
    }
    case StepKind::custom:
      return false;  // who knows
  }
  return false;
}

}  // namespace inverse
