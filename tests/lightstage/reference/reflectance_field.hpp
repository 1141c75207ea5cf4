// SPDX-License-Identifier: LGPL-2.1-or-later
// One cosine lobe per pixel from two color gradients (Fyffe et al. 2009), for the lights of a
// stage, from the equations, without tables.
#pragma once

#include <vector>

#include "kernels/lightstage/network/relight_models.hpp"
#include "tests/reference/network/network.hpp"
#include "tests/reference/plane.hpp"

namespace inverse::reference {

/// A light that lights the relit subject; weight 1 is a light of the stage.
struct Lamp {
  Vec3 direction{};
  Vec3 weight{};
};

struct CosineLobe {
  Vec3 full{};          ///< A + B
  Vec3 direction{};     ///< u, of length 1
  double share = 0;     ///< of the lobe; the rest is uniform
  double exponent = 0;  ///< p
};

/// A stage: directions of its lights, and the largest exponent that they can resolve.
struct Stage {
  std::vector<Vec3> lights;
  double largest_exponent = 63;
};

/// (A − B) F / (F² + noise²) by channel, of length 1 at most.
Vec3 mean_direction(const Vec3& a, const Vec3& b, double noise);
/// The mean direction under the stage's lights of a lobe with mean direction v under uniform light.
Vec3 seen_mean(const Vec3& v, const Stage& stage);
/// The lobe with mean direction v under uniform light: u = v / |v|, |v| = (p + 1) / (p + 2), mixed
/// with uniform light for |v| < 1/2.
CosineLobe lobe_of(const Vec3& full, const Vec3& v, const Stage& stage);
/// S(u, p) = Σ max(0, u·w)^p over the stage's lights, at least a quarter of N / (2 (p + 1)).
double lobe_sum(const Vec3& u, double p, const Stage& stage);
/// F ((1 − s) Σ weight / N + s Σ weight max(0, u·w)^p / S(u, p)).
Vec3 relit(const CosineLobe& lobe, const std::vector<Lamp>& lamps, const Stage& stage);

/// The measured part of the lights' weights, by channel: an even part and one along each component
/// of the directions. Minimizes Σ
/// w − e − a·ω
/// ^1.4 by reweighting, with distances of at least 2 % of the mean weight; components of other
/// channels have weight 0.7.
struct Measured {
  Vec3 even{};
  std::vector<Vec3> along = std::vector<Vec3>(3);  ///< by component
};
Measured measured_light(const std::vector<Lamp>& lamps);
/// F (even + Σ along_k m_k), m = (A − B) F / (F² + noise²).
Vec3 measured_picture(const Measured& light, const Vec3& a, const Vec3& b, double noise);

/// P of a light for every pixel (training/olat/README.md, "What is computed"): as bright as if the
/// light had the energy of the whole sphere. `a` and `b` hold RGB; their size is a multiple of 32.
Plane network_light(const RelightModels& models, const Plane& a, const Plane& b, const Vec3& light);

}  // namespace inverse::reference
