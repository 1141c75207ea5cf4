// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <cstdint>
#include <optional>

#include "kernels/lightstage/program/light_program.hpp"

namespace inverse {

/// Statistics of an image that depend on its light.
struct ImageEvidence {
  std::array<double, 3> level{};  ///< mean linear RGB, 1 = full scale; gray: three equal values
  double clipped = 0;             ///< share of clipped pixels
  uint64_t content = 0;           ///< hash of the pixels; 0: unknown

  double luminance() const { return (level[0] + level[1] + level[2]) / 3; }
};

/// Whether images of this kind of step differ from those of a single light or of none.
inline bool is_check(StepKind kind) {
  return kind == StepKind::tracking || kind == StepKind::gradient_a || kind == StepKind::gradient_b;
}

/// Brightness of a camera's images in each kind of step, learned while labels are certain. Light
/// adds up: every step lies between the images under no light and under all lights.
class LightEvidence {
 public:
  explicit LightEvidence(const LightProgram& program) : program_(program) {}

  /// Sets the initial luminance of a black and of a full frame.
  void start(double black, double full, bool clipped);
  bool started() const { return full_ > black_; }
  double black() const { return black_; }
  double full() const { return full_; }

  /// Images at another size or framing follow: all levels change by one factor. `find_scale`
  /// measures it from the next tracking frame or pair of gradients. Until then images confirm
  /// nothing, and only dark ones contradict.
  void new_framing();
  /// Measures that factor from the image of the step that its time stamp gives. Call it before the
  /// other methods.
  void find_scale(LightProgram::Position position, const ImageEvidence& image);

  /// Updates the levels with an image that certainly shows this step.
  void learn(LightProgram::Position position, const ImageEvidence& image);
  /// Whether an image cannot show this step.
  bool contradicts(LightProgram::Position position, const ImageEvidence& image) const;
  /// Whether an image fits this step and not a single light or none.
  bool confirms(LightProgram::Position position, const ImageEvidence& image) const;
  /// Whether an image is too bright for a black step.
  bool bright(const ImageEvidence& image) const;
  /// Distance between the means of the two gradients, in standard deviations; 0: not known yet.
  /// Above kMinSeparation the gradients can be distinguished.
  double separation() const;
  static constexpr double kMinSeparation = 6;

 private:
  struct Learned {
    std::array<double, 3> mean{};
    uint64_t count = 0;
  };
  double exposure_of(LightProgram::Position position) const;
  double relative(LightProgram::Position position, const ImageEvidence& image) const;
  bool usable() const { return started() && scaled_; }
  /// Position of an image between the means of the two gradients: -1/2 is A, 1/2 is B.
  std::optional<double> between(const ImageEvidence& image) const;

  const LightProgram& program_;
  double black_ = 0, full_ = 0;
  bool clipped_ = false;
  bool scaled_ = true;              // levels fit the present framing
  std::array<double, 2> framed_{};  // if not scaled_: luminance of each gradient, 0: not seen yet
  Learned gradient_[2];
  double variance_ = 0;  // of `between` about its expected value
};

}  // namespace inverse
