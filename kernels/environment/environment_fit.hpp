#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "environment.hpp"
#include "inflated_normals.hpp"

namespace inverse {

/// The light around an object, from what it shows of it (thesis 6.8, Live Material Cloning): low
/// frequencies as spherical harmonics of order 2 from its diffuse layer, high ones from its mirror
/// image, added; over time the mean of Eq. 6.5.
///
/// Low frequencies: diffuse light is m_d D(n), D(n) = Σ A_l/π L_lm Y_lm(n), A_l/π = 1, 2/3, 1/4.
/// The normals that a camera sees are half of all, and on these the nine functions are nearly
/// dependent; of an object that is flat there is one normal. So the coefficients are the most
/// probable ones, with a prior: that of room and outdoor maps about the light that the mirror image
/// has, in one color; colors apart from that where a channel's albedo lets them be seen. What no
/// normal tells is as the prior has it.
///
/// High frequencies: the mirror image alpha M(n), M = E(2 (n·v) n − v) / π, drawn into the map and
/// filled smoothly where no normal reflects to, less its own low frequencies.
class EnvironmentFit {
 public:
  static constexpr uint32_t kWidth = 64, kHeight = 32;  ///< of the map
  static constexpr size_t kTerms = 9;                   ///< Y_lm, l = 0, 1, 2

  struct Params {
    uint32_t memory = 100;  ///< views that the mean remembers
    float noise = 0.3F;  ///< root mean square error of the diffuse layer and what the normals make
                         ///< of it, of its mean
    float glossy = 0.06F;  ///< specular albedo at which the mirror image counts half
  };
  /// What is seen of the object at one point. A normal of z = 0 is none.
  struct Point {
    Normal normal{};
    std::array<float, 3> diffuse{};  ///< linear light without the specular layer
    bool clipped = false;            ///< the camera was at its end: `diffuse` says nothing
    float mirror = 0;                ///< alpha M, gray
  };

  EnvironmentFit();

  /// Takes what a frame shows. Points that are no numbers are left out, and frames of fewer than
  /// kFewest points.
  void add(std::span<const Point> points, const Params& params);
  void reset();
  /// What was taken so far counts as so many views at most.
  void shorten(uint64_t views);
  uint64_t count() const { return count_; }
  static constexpr size_t kFewest = 24;

  /// The light, for an object of these albedos; nothing where nothing was seen, or where the object
  /// is black and dull.
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
