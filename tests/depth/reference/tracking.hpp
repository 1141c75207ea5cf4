// SPDX-License-Identifier: LGPL-2.1-or-later
// Specification of kernels/depth/tracking: one step of an alignment, in double precision.
#pragma once
#include <vector>

#include "tests/reference/camera/volume.hpp"

namespace inverse::reference {

/// A frame, or a view: normal and depth, and ln brightness, of a camera.
struct Sight {
  Camera camera;
  Plane surface;
  std::vector<double> brightness;
};

struct AlignParams {
  double max_distance, min_cosine, photometric, damping;
};

struct Alignment {
  Camera camera;     ///< of the frame, moved
  double rms = 0;    ///< weighted distance of matched points before the step, meters
  double share = 0;  ///< of pixels with a depth that matched
};

/// Minimizes, over a turn and a shift of the frame, the sum over its pixels of
///   w² (n·(q − p))² + photometric² v (b − a)²,   w = noise(.4 m) / noise(z),  v Huber's weight,
/// where the point p falls on the point q with the normal n and the ln brightness a of the view.
Alignment align(const Sight& frame, const Sight& view, const AlignParams& params);

/// How alike both look where the frame's points fall on the view within `max_distance` of depth.
struct Agreement {
  double correlation = 0;  ///< of steps of ln brightness to the third pixels at the right and below
  double frame = 0, view = 0;  ///< root mean square of these
  double count = 0;            ///< of steps; not across jumps of depth
};
Agreement agreement(const Sight& frame, const Sight& view, double max_distance);

/// `last`, moved by what moves `before` to it: the turn in the world's axes, and the shift.
Camera predict(const Camera& before, const Camera& last);

/// A depth image, smoothed within surfaces.
std::vector<double> smooth(int width, int height, const std::vector<double>& depth);

/// Ln of the mean channel, blurred by (1 2 1)/4 along both sides.
std::vector<double> log_brightness(const Plane& picture);

/// Half a depth image and half of ln brightness.
void halve(int width, int height, const std::vector<double>& depth,
           const std::vector<double>& brightness, std::vector<double>& half_depth,
           std::vector<double>& half_brightness);

}  // namespace inverse::reference
