// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

namespace inverse {

/// Thresholds up to which work is skipped; 0 never skips. Initializers are shares of kSkipError.
/// Independent errors of half resolution, chroma bins and cycles add up to .64 of it; those of
/// edges and gate are changes of what an error depends on.
struct Tolerances {
  /// The target for the error of all skipping by default, rms log shading.
  static constexpr float kSkipError = 0.1F;

  /// Distance between half and full resolution, rms log shading (LayerDistance), 0…1, below which
  /// half is chosen.
  float half = 0.06F;
  /// Effect of the chroma bins, rms log shading of cell means, weighted by the value prior, 0…1,
  /// below which they are skipped.
  float chroma = 0.02F;
  /// Change by a multigrid cycle, rms log shading, 0…1, below which no other follows.
  float cycle = 0.01F;
  /// Change by the last cycle, rms log shading, 0…0.1, below which a repeated picture has
  /// converged.
  float repeat = 1e-3F;
  /// Change of log intensity or chroma of a 2 x 2 mean, 0…1, from which on the edges of a tile are
  /// evaluated again.
  float edge = 0.05F;
  /// Gate of the temporal anchor, rms over cells, 0…1, below which pixels are not compared with the
  /// frame before.
  float gate = 0.06F;

  /// Makes them the same shares of another error.
  void scale_to(float skip_error) {
    const float factor = skip_error / kSkipError;
    for (float* tolerance : {&half, &chroma, &cycle, &repeat, &edge, &gate}) *tolerance *= factor;
  }
  bool operator==(const Tolerances&) const = default;
};

/// The reason why nothing is skipped: the property `adaptive`, or `skip-error`, which implies it.
inline constexpr const char* kNotAdaptive = "adaptive is off or skip-error is 0";

}  // namespace inverse
