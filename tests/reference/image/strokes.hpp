// SPDX-License-Identifier: LGPL-2.1-or-later
// Where the user's strokes lie on a picture, and how they follow it. Double precision.
#pragma once

#include <array>
#include <complex>
#include <vector>

namespace inverse::reference {

/// A line drawn with a round brush, in pixels of the picture.
struct StrokeLine {
  std::vector<std::complex<double>> points;
  double radius = 1;
};

/// How a stroke has moved: from p to center + shift + turn (p - center).
struct StrokeMove {
  std::complex<double> center, turn{1}, shift;
};

/// Which stroke a pixel belongs to, -1: none, and how firmly.
struct StrokeWeights {
  std::vector<int> stroke;
  std::vector<double> weight;
};

/// Draws strokes where they have moved to: min(1, (radius - d) / border)^2 at the distance d from
/// the line as it was drawn, border = min(radius, max(radius / 4, 2)). The later stroke covers the
/// earlier one unless its weight is smaller.
StrokeWeights draw_strokes(const std::vector<StrokeLine>& lines,
                           const std::vector<StrokeMove>& moves, int width, int height);

/// A stroke that is followed from frame to frame (kernels/image/strokes/track.comp).
class StrokeTrack {
 public:
  enum class State { waiting, followed, lost, outside };
  struct Sample {
    std::complex<double> at;  ///< from the center
    double weight;
  };
  StrokeTrack(std::vector<Sample> samples, std::complex<double> center, double radius, int levels)
      : samples_(std::move(samples)), radius_(radius), levels_(levels) {
    move_.center = center;
  }
  /// Follows it into a frame: interleaved linear RGB.
  void follow(const std::vector<double>& rgb, int width, int height);
  const StrokeMove& move() const { return move_; }
  State state() const { return state_; }

 private:
  struct Template {
    double value = 0;
    std::complex<double> gradient;
    bool known = false;
  };
  struct Fit {
    double inside, fits, variance;
  };
  double value(int level, std::complex<double> place) const;
  bool inside(std::complex<double> place) const;
  std::complex<double> moved(std::complex<double> at) const {
    return move_.center + move_.shift + move_.turn * at;
  }
  double sigma() const;
  double step(int level);
  Fit fit(int level) const;
  double telling(int level, std::size_t sample) const;
  void align(int from);
  void search();
  void take(bool all);
  bool acceptable(const Fit& fit) const;

  struct Level {
    int width, height;
    std::vector<double> values;
  };
  std::vector<Sample> samples_;
  double radius_;
  int levels_;
  StrokeMove move_;
  State state_ = State::waiting;
  std::complex<double> key_{1}, velocity_;
  double gain_ = 0, texture_ = 0, best_ = 0, fit0_ = -1;
  std::vector<std::vector<Template>> templates_;  // by level
  std::vector<Level> frame_;
};

}  // namespace inverse::reference
