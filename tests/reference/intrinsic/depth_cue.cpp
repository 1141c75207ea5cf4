// SPDX-License-Identifier: LGPL-2.1-or-later
#include "depth_cue.hpp"

#include <algorithm>
#include <cmath>

namespace inverse::reference {
namespace {

constexpr double kJump = 0.03, kFlat = 1.2, kTurned = -0.5, kAngle = 0.4, kNoiseAngle = 0.2,
                 kEqual = 1e-3;
constexpr int kReach = 3;

/// Nguyen et al. 2012.
double noise(double z) { return 0.0012 + 0.0019 * (z - 0.4) * (z - 0.4); }

struct Side {
  bool known = false, hidden = false;
  double z = 0, step = 0;  // beside the edge; from there to the next pixel
  std::array<double, 3> normal{};
};

/// The pixels of the view on one side of an edge: from one on, in steps of `sign`.
Side side_of(const SeenSurface& seen, int x, int y, bool down, int sign) {
  Side side;
  std::array<double, 3> sum{};
  for (int k = 0; k < kReach; ++k) {
    const int px = std::clamp(x + (down ? 0 : sign * k), 0, seen.width - 1),
              py = std::clamp(y + (down ? sign * k : 0), 0, seen.height - 1);
    const auto i = std::size_t(py) * std::size_t(seen.width) + std::size_t(px);
    const auto& n = seen.normal[i];
    const double z = seen.known_depth[i], square = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
    const bool known = z > 1e-3 && z < 100 && square > 0.5 && square < 2;
    if (k == 0) {
      if (!known) return side;
      side.z = z;
      const double here = seen.depth[i];
      side.hidden = here > 0 && here < z && !(z - here < 0.02 + 4 * noise(here));
    }
    if (!known) continue;
    if (k == 1) side.step = std::abs(z - side.z);
    if (std::abs(z - side.z) < (k + 1) * kJump * side.z)
      for (std::size_t c = 0; c < 3; ++c) sum[c] += n[c];
  }
  const double length = std::hypot(sum[0], sum[1], sum[2]);
  side.known = length > 0;
  for (std::size_t c = 0; c < 3; ++c) side.normal[c] = sum[c] / std::max(length, 1e-6);
  return side;
}

/// Of the edge from pixel (x, y) of the frame.
double cue(const Guide& guide, const SeenSurface& seen, int x, int y, bool down) {
  const GuideLevel& fine = guide.level[0];
  // The pixel of the view before its edge that is nearest to the place (i + 1) size/of, in whole
  // numbers, as that may be the middle of a pixel; and the one that has the place (i + 1/2)
  // size/of.
  const auto before = [](int i, int of, int size) {
    const long long at = 2LL * (i + 1) * size - of;
    return int(std::clamp(at < 0 ? 0LL : at / (2LL * of), 0LL, std::max(size - 2LL, 0LL)));
  };
  const auto at = [](int i, int of, int size) {
    return int(std::min((2LL * i + 1) * size / (2LL * of), size - 1LL));
  };
  const int px = (down ? at : before)(x, fine.width, seen.width),
            py = (down ? before : at)(y, fine.height, seen.height);
  const Side a = side_of(seen, px, py, down, -1), b = side_of(seen, px + !down, py + down, down, 1);
  if (!a.known || !b.known || (a.hidden && b.hidden)) return 0;
  const double z = std::min(a.z, b.z), step = std::max({std::abs(a.z - b.z), a.step, b.step});
  const double turn =
      std::hypot(a.normal[0] - b.normal[0], a.normal[1] - b.normal[1], a.normal[2] - b.normal[2]) /
      (kAngle + kNoiseAngle * noise(z) * seen.focal / z);
  const double t = turn * turn / (1 + turn * turn);
  const double share = std::clamp((step / z - 0.6 * kJump) / (0.4 * kJump), 0.0, 1.0);
  const double apart = share * share * (3 - 2 * share);
  return (1 - apart) * ((1 - t) * kFlat + t * kTurned);
}

}  // namespace

void apply_depth(const Guide& guide, const SeenSurface& seen, double weight, EdgePrior& prior) {
  const GuideLevel& fine = guide.level[0];
  for (int y = 0; y < fine.height; ++y)
    for (int x = 0; x < fine.width; ++x)
      for (const bool down : {false, true}) {
        if (down ? y + 1 == fine.height : x + 1 == fine.width) continue;
        const std::size_t i = fine.index(x, y), j = fine.index(x + !down, y + down);
        double &a = (down ? prior.a_down : prior.a_right)[i],
               &b = (down ? prior.b_down : prior.b_right)[i];
        const double factor = std::exp(weight * cue(guide, seen, x, y, down));
        // The device only has a + b and a dm.
        const double sum = a + b;
        const double step = fine.m[i] - fine.m[j], square = step * step;
        const double paint = (a * square + sum / 2 * kEqual * kEqual) / (square + kEqual * kEqual);
        b = paint + factor * (sum - paint) - a;
      }
}

}  // namespace inverse::reference
