// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "environment.hpp"
#include "inflated_normals.hpp"

namespace inverse {

/// Estimates the light around an object from its images (thesis 6.8, Live Material Cloning): low
/// frequencies as spherical harmonics of order 2 from its diffuse layer, plus high frequencies from
/// its mirror image; over time the mean of Eq. 6.5.
///
/// Low frequencies: diffuse light is m_d D(n), D(n) = Σ A_l/π L_lm Y_lm(n), A_l/π = 1, 2/3, 1/4. A
/// camera sees half of all normals, on which the nine functions are nearly dependent; a flat object
/// shows one normal. So the coefficients maximize the posterior. The prior is fitted to indoor and
/// outdoor maps, about the gray light of the mirror image. Colors deviate from gray as far as each
/// channel's albedo shows them. Undetermined coefficients follow the prior.
///
/// High frequencies: the mirror image alpha M(n), M = E(2 (n·v) n − v) / π, drawn into the map,
/// filled smoothly where no normal reflects to, minus its own low frequencies.
class EnvironmentFit {
 public:
  static constexpr uint32_t kWidth = 64, kHeight = 32;  ///< of the map
  static constexpr size_t kTerms = 9;                   ///< Y_lm, l = 0, 1, 2

  struct Params {
    uint32_t memory = 100;  ///< maximum number of views in the mean
    float noise = 0.3F;     ///< rms difference between the diffuse layer and the model, relative to
                            ///< its mean
    float glossy = 0.06F;   ///< specular albedo at which the mirror image has half weight
  };
  /// One point of the object. A normal with z = 0 is missing.
  struct Point {
    Normal normal{};
    std::array<float, 3> diffuse{};  ///< linear light without the specular layer
    bool clipped = false;            ///< the camera clipped: `diffuse` is ignored
    float mirror = 0;                ///< alpha M, gray
  };

  EnvironmentFit();

  /// Adds the points of a frame. Ignores points that are not finite, and frames with fewer than
  /// kMinPoints points.
  void add(std::span<const Point> points, const Params& params);
  void reset();
  /// Limits the weight of earlier views to this number of views.
  void shorten(uint64_t views);
  uint64_t count() const { return count_; }
  static constexpr size_t kMinPoints = 24;

  /// The light, given the object's albedos; empty before any view, and if the object is black
  /// without gloss.
  std::optional<Environment> light(std::array<float, 3> diffuse, float specular,
                                   const Params& params) const;

  using Terms = std::array<double, kTerms>;
  static Terms harmonics(double x, double y, double z);

 private:
  struct Texel {
    float solid_angle;
    std::array<float, kTerms> harmonics;
  };
  std::vector<float> filled_mirror() const;
  Terms project(std::span<const float> map, size_t stride) const;

  std::vector<Texel> texels_;
  uint64_t count_ = 0, averaged_ = 0;                 // views; those that the means are of
  double weight_ = 0;                                 // of points in a view, mean
  std::array<double, kTerms * kTerms> products_{};    // mean of w f f^T over points
  std::array<std::array<double, kTerms>, 3> seen_{};  // mean of w f diffuse
  std::array<double, 3> level_{};                     // mean of w diffuse
  std::vector<float> mirror_weight_, mirror_sum_;     // by texel
};

}  // namespace inverse
