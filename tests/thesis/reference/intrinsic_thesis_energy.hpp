// SPDX-License-Identifier: LGPL-2.1-or-later
// The decomposition energies of chapters 3 (Eqs. 3.3–3.15) and 4 (4.3–4.8), and the linear systems
// of their IRLS steps, in double precision. This is the specification of kernels/thesis/chapter3
// and kernels/thesis/chapter4.
//
// Unknowns: one vector (r_R, r_G, r_B, s) a pixel, natural logarithms of reflectance and shading.
#pragma once

#include <cstdint>
#include <vector>

#include "tests/reference/intrinsic/strokes.hpp"
#include "tests/reference/plane.hpp"

namespace inverse::reference {

/// Every parameter of the method with the values of section 3.6. The meaning of each is documented
/// in kernels/thesis/chapter3/thesis_params.hpp; the fields have the same names.
struct ThesisParams {
  bool chapter4 = false;
  double w_data = 10;
  double w_intensity = 0.8;
  double w_reflectance = 0.5;
  double w_shading = 10;
  double w_chromaticity = 10;
  double w_non_local = 10;
  double w_clustering = 10;
  double w_cs = 1;
  double p = 0.8;
  double alpha_cs = 15;
  double alpha_clustering = 0.4;
  double tau_cc = 0.05;
  double epsilon = 5e-3;
  double log_floor = 1e-3;
  double chroma_floor = 3e-3;
  bool consistent_irls = true;
  bool schwarz = false;
  int levels = 0;
  int irls_iterations = 4;
  int pcg_iterations = 8;
  int samples = 9;
  int keyframes = 5;
  int keyframe_spacing = 5;
  bool resample = false;
  std::uint32_t seed = 1;
};

/// NaN and −∞ become 0, +∞ becomes 1; the rest is clamped to 0 … 65504.
double finite_light(double value);

/// What a pyramid level holds before anything is solved on it.
struct ThesisLevel {
  Plane image;         ///< linear light I, sanitized
  Plane log_image;     ///< i = ln max(I, log_floor); w: ω_iw (3.6)
  Plane chromaticity;  ///< c = (I + ε_c)/mean(I + ε_c), mean 1; w: |I| clamped to 0 … 1
  Plane edges;  ///< right and down: W = 2 w_r ω_cs, then V = w_s (ω_l + ω_l')(1 − ω_cs)
  std::vector<double> packed;  ///< chromaticity as samples carry it

  ThesisLevel(const Plane& linear, const ThesisParams& params);
};

/// A chromaticity as the samples carry it: red and blue on a grid of 3/4095 (green follows, the
/// mean being 1), red · 4096 + blue, exact in a float.
double pack_chromaticity(const Vec4& chromaticity);

/// One frame that samples may be drawn from: rgb = r, w = packed chromaticity.
using SampleFrame = Plane;

/// Makes the frame that samples of this level and solution are drawn from.
SampleFrame make_sample_frame(const ThesisLevel& level, const Plane& x);

/// Source terms of targets of r: rgb = Σ weight · target, w = Σ weight.
using SourcePlane = Plane;

/// Eqs. 3.12–3.13: for every pixel the sum over its samples of w_non_local g_i (r_ti, 1).
/// `frames[0]` is the current one, the others are keyframes; `stream` is the second hash counter's
/// upper part (the pyramid level) and `epoch` the frame number where samples are redrawn.
SourcePlane draw_samples(const ThesisLevel& level, const std::vector<const SampleFrame*>& frames,
                         std::uint32_t stream, std::uint32_t epoch, const ThesisParams& params);

/// Energy per term, summed over pixels.
struct ThesisEnergy {
  double data = 0;
  double reflectance = 0;
  double shading = 0;
  double chromaticity = 0;
  double non_local = 0;
  double clustering = 0;
  double user = 0;
  double stabilization = 0;
  double total() const {
    return data + reflectance + shading + chromaticity + non_local + clustering + user +
           stabilization;
  }
};

/// Eq. 3.3 at x. The ℓp term is (|d|² + ε²)^(p/2), of which the consistent IRLS weight is the
/// derivative. `clusters` holds rgb = r_cluster, w = ω_clustering; it may be empty.
ThesisEnergy thesis_energy(const ThesisLevel& level, const Plane& x, const Plane& clusters,
                           const std::vector<const SampleFrame*>& frames, std::uint32_t stream,
                           std::uint32_t epoch, const ThesisParams& params);

/// Source terms of targets of s, by pixel: weight · target, and weight. Empty: there are none.
struct ShadingSource {
  std::vector<double> target, weight;
};

/// w_u of (4.3).
inline constexpr double kUserWeight = 1000;

/// The auxiliary variable of each stroke where (4.7) is least (4.6.2): the mean over its pixels, by
/// their weights, of r (rgb) and s (w).
std::vector<Vec4> stroke_means(const StrokeMask& strokes, const Plane& x);

/// w_u E_user (4.7) at x with these auxiliary variables.
double user_energy(const StrokeMask& strokes, const std::vector<Vec4>& means, const Plane& x);

/// Adds the source terms of (4.7): those of constant reflectance to `source`, those of constant
/// shading to `shading`.
void add_strokes(const StrokeMask& strokes, const std::vector<Vec4>& means, SourcePlane* source,
                 ShadingSource* shading);

/// w_s E_stab (4.8) at x; `known`: rgb = B r_model, w = B.
double stabilization_energy(const Plane& known, double weight, const Plane& x);

/// Adds the source terms of (4.8).
void add_known(const Plane& known, double weight, SourcePlane* source);

/// A x = b, half the gradient of the reweighted energy E^(k) (3.21), method A and b kept apart as
/// the kernels keep them.
struct ThesisSystem {
  Plane edges;  ///< right and down: a = W · c(d), then V
  Plane node;   ///< ω_l, Σ weights of targets, Σ a, Σ V over the existing neighbors
  Plane b;
  std::vector<double> shading_weight;  ///< of targets of s, by pixel; empty: none
  double w_data = 0;
  double w_chromaticity = 0;
  Vec3 channel_weight;  ///< ω_c
};

/// The system at the linearization point x; `source` sums samples, clusters and strokes.
ThesisSystem assemble(const ThesisLevel& level, const Plane& x, const SourcePlane& source,
                      const ThesisParams& params, const ShadingSource& shading = {});

/// A v, as if the image ended at the borders of the block [x0, x1) × [y0, y1) where v is zero
/// outside it; only pixels of the block are written.
void apply(const ThesisSystem& system, const Plane& v, int x0, int y0, int x1, int y1, Plane* out);

/// The diagonal of A at a pixel.
Vec4 diagonal(const ThesisSystem& system, std::size_t pixel);

}  // namespace inverse::reference
