#pragma once
#include <array>
#include <cstdint>
#include <optional>

#include "stage/program/light_program.hpp"

namespace inverse {

/// What a picture tells of the light on it, at a glance.
struct ImageEvidence {
  std::array<double, 3> level{};  ///< mean linear RGB, 1 = full scale; gray cameras: three times
  double clipped = 0;             ///< share of pixels at the end of the scale
  uint64_t content = 0;           ///< fingerprint of the pixels; 0: not known

  double luminance() const { return (level[0] + level[1] + level[2]) / 3; }
};

/// Whether the picture of such a step tells that it is none of a single light, or of no light.
inline bool is_check(StepKind kind) {
  return kind == StepKind::tracking || kind == StepKind::gradient_a || kind == StepKind::gradient_b;
}

/// How bright a camera's pictures are in each kind of step: learned while labels are certain, and
/// said only where it is clear. Light adds up: whatever a step does, it lies between the pictures
/// under no light and under all.
class LightEvidence {
 public:
  explicit LightEvidence(const LightProgram& program) : program_(program) {}

  /// Levels of a black and of a full frame, to start from.
  void start(double black, double full, bool clipped);
  bool started() const { return full_ > black_; }
  double black() const { return black_; }
  double full() const { return full_; }

  /// Pictures of the subject in another size or frame follow: all levels change by one factor,
  /// which is told by the next tracking frame, or pair of gradients, that `find_scale` is given.
  /// Until then pictures neither confirm nor contradict, but for such that are dark.
  void new_framing();
  /// Takes the picture of a step that it shows by its time, before all else.
  void find_scale(LightProgram::Position position, const ImageEvidence& image);

  /// Takes the picture of a step that it certainly shows.
  void learn(LightProgram::Position position, const ImageEvidence& image);
  /// Whether a picture cannot be of this step.
  bool contradicts(LightProgram::Position position, const ImageEvidence& image) const;
  /// Whether a picture tells that it is of this step, and not of a single light or of none.
  bool confirms(LightProgram::Position position, const ImageEvidence& image) const;
  /// Whether a picture is so bright that a step in which no light was on cannot explain it.
  bool bright(const ImageEvidence& image) const;
  /// By how far the means of gradient frames lie apart, in how far one lies from its mean; 0 where
  /// it is not known yet. Beyond kTellable they are told from each other.
  double separation() const;
  static constexpr double kTellable = 6;

 private:
  struct Learned {
    std::array<double, 3> mean{};
    uint64_t count = 0;
  };
  double exposure_of(LightProgram::Position position) const;
  double relative(LightProgram::Position position, const ImageEvidence& image) const;
  bool tells() const { return started() && scaled_; }
  /// Where a picture lies between the means of the two gradients: -1/2 is A, 1/2 is B.
  std::optional<double> between(const ImageEvidence& image) const;

  const LightProgram& program_;
  double black_ = 0, full_ = 0;
  bool clipped_ = false;
  bool scaled_ = true;              // levels are those of pictures as they are now
  std::array<double, 2> framed_{};  // where not: luminance of each gradient, 0: not seen yet
  Learned gradient_[2];
  double spread_ = 0;  // of `between` about what it should be
};

}  // namespace inverse
