// SPDX-License-Identifier: LGPL-2.1-or-later
// The energy of the global intrinsic decomposition (thesis, chapter 5, Eqs. 5.3–5.13) and the
// linear systems of its Gauss–Newton steps, in double precision. This is the specification of
// kernels/thesis/chapter5.
//
// Unknowns of a pixel: r = ln R (three channels), T_0 (direct light), T_1 … T_K (indirect light,
// one scalar for each base color b_k; b_0 is white).
#pragma once

#include <cstdint>
#include <vector>

#include "intrinsic_thesis_energy.hpp"
#include "tests/reference/plane.hpp"

namespace inverse::reference {

/// Every parameter of the method. The meaning of each is documented in
/// kernels/thesis/chapter5/global_thesis_params.hpp; the fields have the same names.
struct GlobalThesisParams {
  double lambda_data = 5000;
  double lambda_clustering = 200;
  double lambda_r_sparsity = 20;
  double lambda_r_consistency = 10;
  double lambda_monochrome = 10;
  double lambda_i_sparsity = 3;
  double lambda_smoothness = 3;
  double lambda_non_negativity = 1000;
  double lambda_ir = 10;
  double lambda_cr = 100;
  double p = 1;
  double alpha_sr = 50;
  double w_intensity = 0.8;
  double tau_cc = 0.05;
  double epsilon = 0.002;
  double epsilon_r = 5e-3;
  double log_floor = 1e-3;
  double chroma_floor = 3e-3;
  double indirect_start = 0.1;
  bool consistent_irls = true;
  bool line_search = true;
  int steps = 5;
  int pcg_iterations = 16;
  int samples = 9;
  int keyframes = 5;
  int keyframe_spacing = 5;
  bool resample = false;
  std::uint32_t seed = 1;
};

/// 4 + K numbers a pixel, pixel by pixel: r_R, r_G, r_B, T_0, T_1 … T_K.
struct GlobalField {
  int width = 0;
  int height = 0;
  std::size_t unknowns = 4;
  std::vector<double> data;

  GlobalField() = default;
  GlobalField(int field_width, int field_height, std::size_t layers)
      : width(field_width), height(field_height), unknowns(4 + layers) {
    data.assign(pixels() * unknowns, 0.0);
  }
  std::size_t pixels() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  double* at(std::size_t pixel) { return data.data() + pixel * unknowns; }
  const double* at(std::size_t pixel) const { return data.data() + pixel * unknowns; }
};

/// What is known of a frame before anything is solved.
struct GlobalThesisScene {
  Plane image;                  ///< linear light I, sanitized
  ThesisLevel sampling;         ///< what the samples of section 3.4.3 need of it
  std::vector<double> retinex;  ///< w_SR (5.10)
  Plane targets;                ///< r_cluster, w = 1 if the pixel has a cluster, else 0
  std::vector<Vec3> colors;     ///< b_1 … b_K

  GlobalThesisScene(const Plane& linear, const Plane& clusters, std::vector<Vec3> base_colors,
                    const GlobalThesisParams& params);
  std::size_t layers() const { return colors.size(); }
};

/// S = b_0 T_0 + Σ b_k T_k at a pixel.
Vec3 shading(const GlobalThesisScene& scene, const double* unknowns);

/// The frames that samples are drawn from: `frames[0]` is the current one, the others keyframes.
struct GlobalSamples {
  std::vector<const SampleFrame*> frames;
  std::uint32_t epoch = 0;  ///< the frame number where samples are redrawn
};

/// (r, packed chromaticity) of a solution, as samples are drawn from it.
SampleFrame make_sample_frame(const GlobalThesisScene& scene, const GlobalField& x);

/// Energy per term, summed over pixels.
struct GlobalEnergy {
  double data = 0;
  double clustering = 0;
  double r_sparsity = 0;
  double r_consistency = 0;
  double monochrome = 0;
  double i_sparsity = 0;
  double smoothness = 0;
  double non_negativity = 0;
  double total() const {
    return data + clustering + r_sparsity + r_consistency + monochrome + i_sparsity + smoothness +
           non_negativity;
  }
};

/// Eq. 5.3 at x. The norms are smooth near zero, so that the consistent weights of the IRLS are
/// their derivatives: |d|^p → (|d|² + ε²)^(p/2) − ε^p, |T| → √(T² + ε²) − ε and
/// max(−T, 0) → t − ε ln(1 + t/ε), t = max(−T, 0).
GlobalEnergy global_energy(const GlobalThesisScene& scene, const GlobalField& x,
                           const GlobalSamples& samples, const GlobalThesisParams& params);

/// A δ = b of a Gauss–Newton step at x: A = JᵀJ and b = −JᵀF of the reweighted residuals, that is
/// half the energy's negative gradient.
struct GlobalSystem {
  const GlobalThesisScene* scene = nullptr;
  double lambda_data = 0;
  std::vector<Vec3> reflectance;   ///< R
  std::vector<Vec3> product;       ///< R ⊙ S
  std::vector<double> monochrome;  ///< λ w_SR
  std::vector<double> weight;      ///< λ_clustering and samples: Σ weights on r
  GlobalField local;               ///< weights of T_k² by sparsity and non-negativity
  GlobalField right, down;         ///< weights of an unknown's difference to the next pixel
  GlobalField b;
};
GlobalSystem assemble(const GlobalThesisScene& scene, const GlobalField& x,
                      const GlobalSamples& samples, const GlobalThesisParams& params);

/// A v.
void apply(const GlobalSystem& system, const GlobalField& v, GlobalField* out);

/// The diagonal of A.
GlobalField diagonal(const GlobalSystem& system);

/// Σ_x Σ_k≥1 |T_k(x)| over the pixels where `region` is not zero (5.11): what decides between the
/// base colors of a region that was assigned to a wrong one (5.5.2.2).
double sparsity_score(const GlobalField& x, const std::vector<std::uint8_t>& region);

}  // namespace inverse::reference
