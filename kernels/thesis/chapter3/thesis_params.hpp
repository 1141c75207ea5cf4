// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstdint>

namespace inverse {

/// Parameters of the thesis' intrinsic decomposition. Defaults are those of section 3.6 where it
/// gives them; set_chapter4 changes them. Values outside their range are clamped. Equation numbers
/// are the thesis'.
struct ThesisParams {
  enum class Formulation : uint8_t {
    chapter3,  ///< perceptual weights of channels and intensities (3.5, 3.6, 3.11)
    chapter4,  ///< none in the data term (4.4) and in sums of priors (4.5)
  };
  enum class Irls : uint8_t {
    consistent,  ///< weight (p/2)(|d|² + ε²)^(p/2−1): each step minimizes a bound of the energy
    printed,     ///< (3.19) as printed, without p/2: in effect a sparsity weight 2/p times larger
  };
  enum class Solver : uint8_t {
    pcg,      ///< Jacobi-preconditioned conjugate gradients over the whole level (3.5.1)
    schwarz,  ///< additive Schwarz on 16×16 blocks, shifted by a Halton sequence (3.5.2)
  };

  Formulation formulation = Formulation::chapter3;
  float w_data = 10.0f;          ///< weight of the data term (3.5), 0…1e6
  float w_intensity = 0.8f;      ///< how much less dark pixels count (3.6), 0…1
  float w_reflectance = 0.5f;    ///< weight of reflectance sparsity (3.8), 0…1e6
  float w_shading = 10.0f;       ///< weight of shading smoothness (3.9), 0…1e6
  float w_chromaticity = 10.0f;  ///< weight of the chromaticity prior (3.10), 0…1e6
  float w_non_local = 10.0f;     ///< weight of the spatio-temporal samples (3.12), 0…1e6
  float w_clustering = 10.0f;    ///< weight of the cluster prior (3.15), 0…1e6
  float w_cs = 1.0f;             ///< scale of chromaticity similarity ω_cs (3.7), 0…1
  float p = 0.8f;                ///< exponent of reflectance sparsity (3.8), 0…2
  float alpha_cs = 15.0f;  ///< fall-off of ω_cs with chromaticity distance, mean 1 (3.7), 0…1e4
  float alpha_clustering = 0.4f;  ///< fall-off of the cluster prior with |I| (3.15), 0…1e3
  float tau_cc = 0.05f;   ///< chromaticity distance up to which samples bind (3.13) and clusters
                          ///< merge, 0…3; not printed in the thesis
  float epsilon = 5e-3f;  ///< floor of |d| in the IRLS weight, log units, 1e-6…1; not printed in
                          ///< the thesis: smaller ones let rounding decide edges
  float log_floor = 1e-3f;     ///< floor of I before the logarithm, full scale 1, 1e-6…0.5
  float chroma_floor = 3e-3f;  ///< ε_c of c = (I + ε_c)/mean(I + ε_c), full scale 1, 1e-6…0.5
  Irls irls = Irls::consistent;  ///< form of the IRLS weight
  Solver solver = Solver::pcg;   ///< what solves the system of an IRLS step
  int levels = 0;  ///< of the Gaussian pyramid, 1…12; 0: three to five by resolution (3.5.4)
  int irls_iterations = 4;  ///< reweightings a level, 1…64
  int pcg_iterations = 8;  ///< conjugate-gradient steps a reweighting, globally or a block, 1…256
  /// Conjugate gradients end at this residual, in the preconditioner's norm and relative to that of
  /// the level's first system, 0…1; 0: all iterations run, as in the thesis.
  float residual_tolerance = 0;
  int samples = 9;           ///< N_s a pixel (3.12), 0…64
  int keyframes = 5;         ///< past frames to sample from, 0…5; 0 for stills
  int keyframe_spacing = 5;  ///< frames from one keyframe to the next, 1…1000
  bool resample = false;     ///< draw new sample positions every frame instead of the same ones
  bool energy = false;       ///< evaluate the energy at the finest level, for stats
  bool trace = false;        ///< evaluate it at every IRLS step of every level
  uint32_t seed = 1;         ///< of samples and clusters
  bool operator==(const ThesisParams&) const = default;
};

/// Turns chapter 3's defaults into chapter 4's: the energy (4.3) to (4.6), without clusters, and
/// five levels. 4 reweightings of 8 steps become 7 of 7 (sections 4.6.2 and 4.7), and others in
/// proportion.
inline void set_chapter4(ThesisParams& params) {
  params.formulation = ThesisParams::Formulation::chapter4;
  params.w_data = 1;
  params.w_clustering = 0;
  params.levels = 5;
  params.irls_iterations = params.irls_iterations * 7 / 4;
  params.pcg_iterations = params.pcg_iterations * 7 / 8;
}

}  // namespace inverse
