// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstdint>

namespace inverse {

/// Parameters of the thesis' global intrinsic decomposition. Defaults are those of section 5.8
/// where it gives them. Values outside their range are clamped. Equation numbers are the thesis'.
/// Light and images are linear, full scale 1.
struct GlobalThesisParams {
  enum class Irls : uint8_t {
    consistent,  ///< weights (p/2)(|d|² + ε²)^(p/2−1): each step minimizes a bound of the norms
    printed,     ///< (5.16) as printed, without p/2: in effect ℓ1 weights twice as large
  };

  float lambda_data = 5000.0f;         ///< weight of the data term (5.4), 0…1e6
  float lambda_clustering = 200.0f;    ///< of the distance to clustered reflectance (5.6), 0…1e6
  float lambda_r_sparsity = 20.0f;     ///< of reflectance sparsity (5.7), 0…1e6
  float lambda_r_consistency = 10.0f;  ///< of spatio-temporal samples (3.12), 0…1e6
  float lambda_monochrome = 10.0f;     ///< of gray shading (5.9), 0…1e6
  float lambda_i_sparsity = 3.0f;      ///< of few indirect layers a pixel (5.11), 0…1e6
  float lambda_smoothness = 3.0f;      ///< of piecewise constant light (5.12), 0…1e6
  float lambda_non_negativity = 1000.0f;  ///< of light that is not negative (5.13), 0…1e6
  /// Weight of small changes of the base colors (5.14), 1e-3…1e9. Unlike the data term, this weight
  /// and lambda_cr do not scale with the number of pixels: at usual frame sizes they have little
  /// effect.
  float lambda_ir = 10.0f;
  float lambda_cr = 100.0f;  ///< weight of constant chromaticity of base colors (5.14), 0…1e9
  float p = 1.0f;            ///< exponent of reflectance sparsity (5.7), 0…2
  float alpha_sr = 50.0f;    ///< rise of w_SR with chromaticity steps, mean 1 (5.10), 0…1e4; 1e4
                             ///< makes nearly every pixel count: without the soft Retinex weight
  float w_intensity = 0.8f;  ///< how much less dark pixels' samples count (3.6), 0…1
  float tau_cc = 0.05f;      ///< chromaticity distance up to which samples bind (3.13), 0…3; not
                             ///< printed in the thesis
  float tau_merge = 0.3f;    ///< chromaticity distance up to which clusters merge, so that four to
                             ///< eight of ten remain (5.7.1), 0…3; not printed in the thesis
  float tau_neutral =
      0.05f;  ///< base colors this near to white in chromaticity get no indirect
              ///< layer, as it could not be distinguished from direct light, 0…3; 0: all do
  float epsilon = 0.002f;       ///< floor of |T| and |∇T| in the weights (5.6.4.1), 1e-4…1
  float epsilon_r = 5e-3f;      ///< floor of |∇r| in its weight, log units, 1e-4…1
  float log_floor = 1e-3f;      ///< smallest reflectance that a pixel without a cluster starts with
                                ///< and smallest light, 1e-6…0.5
  float chroma_floor = 3e-3f;   ///< ε_c of c = (I + ε_c)/mean(I + ε_c), 1e-6…0.5
  float indirect_start = 0.1f;  ///< all indirect layers together start as this share of the direct
                                ///< light, 0…1; not printed in the thesis
  Irls irls = Irls::consistent;  ///< form of the weights
  int clusters = 10;             ///< maximum K: duplicates are removed (5.5.1), 1…16
  int steps = 5;                 ///< Gauss–Newton steps a frame, 1…64
  int pcg_iterations = 16;       ///< conjugate-gradient steps for each (5.7.1), 1…256
  bool line_search = true;       ///< shorten steps that would raise the energy, see search.comp
  bool warm_start = false;       ///< start from the last frame's solution instead of the clusters
  int samples = 9;               ///< N_s a pixel (3.12), 0…64
  int keyframes = 5;             ///< past frames to sample from, 0…5; 0 for stills
  int keyframe_spacing = 5;      ///< frames from one keyframe to the next, 1…1000
  bool resample = false;         ///< draw new sample positions every frame instead of the same ones
  int refine_rounds = 10;        ///< maximum refinements of the base colors after a reset, 0…100
  float refine_tolerance = 1e-3f;  ///< refinements end if no channel changes by more, 0…1
  /// Mean change of chroma, in units of 0.5 in ln chroma, above which a frame is a scene cut, 0…1;
  /// 0: no cuts. Within three videos it is at most .05, and .34, .75 and .77 between them.
  float cut_chroma = 0.2f;
  bool energy = false;  ///< evaluate the energy of the result, for stats
  bool trace = false;   ///< evaluate it at every step
  uint32_t seed = 1;    ///< of samples and clusters
  bool operator==(const GlobalThesisParams&) const = default;
};

}  // namespace inverse
