// SPDX-License-Identifier: LGPL-2.1-or-later
// The solver of section 5.7 in double precision: Gauss–Newton steps, each solved by 16
// Jacobi-preconditioned conjugate gradients, and the refinement of the base colors that alternates
// with them.
#pragma once

#include <Eigen/Core>
#include <deque>
#include <functional>
#include <vector>

#include "global_thesis_energy.hpp"

namespace inverse::reference {

/// b_k of a chromaticity or reflectance: its largest channel becomes 1; black becomes white.
Vec3 base_color(const Vec3& color);

/// Every pixel's cluster: the nearest of `centers` (ln chromaticity) to ln c(I), written as
/// (ln `colors`, 1); w = 0 if there are no clusters. Ties go to the lowest index.
Plane cluster_targets(const Plane& linear, const std::vector<Vec3>& centers,
                      const std::vector<Vec3>& colors, double chroma_floor);

/// The start of the iterations: r = r_cluster (without clusters: I/max I), indirect layers that
/// share `indirect_start` of the direct one, and T_0 the least-squares fit of I.
GlobalField global_start(const GlobalThesisScene& scene, const GlobalThesisParams& params);

/// Bounds that keep extreme input from overflowing; a Gauss–Newton step changes r by at most
/// kLargestStep.
constexpr double kLargestStep = 1;
constexpr double kSmallestLog = -12;
constexpr double kLargestLog = 6;
constexpr double kLargestLight = 65504;

/// Solves A δ = b from δ = 0 by at most `iterations` preconditioned conjugate gradients, or until
/// rᵀM⁻¹r is below tolerance² of its start.
GlobalField conjugate_gradients(const GlobalSystem& system, int iterations, double tolerance = 0);

/// x + δ within the bounds above.
void take_step(const GlobalField& delta, GlobalField* x);

/// Whether a step that leads to `after` may be taken as it is: without samples, which follow, and
/// without the penalty of negative light, which bounds nothing, energy must not rise by more than
/// 1e-5 of it; where there are samples by 5 %, but not beyond 5 % above `start`, where the frame
/// started.
bool step_is_good(const GlobalEnergy& start, const GlobalEnergy& before, const GlobalEnergy& after,
                  bool samples);

/// The dense system of (5.14) for Δb, K colors of three channels each: unknown 3 k + c.
struct RefinementSystem {
  Eigen::MatrixXd matrix;  ///< symmetric
  Eigen::VectorXd b;       ///< right-hand side
};
/// `initial` are the base colors as they were estimated: the chromaticity of b_k + Δb_k is drawn to
/// theirs. C is linearized at the present b_k.
RefinementSystem refinement_system(const GlobalThesisScene& scene, const GlobalField& x,
                                   const std::vector<Vec3>& initial,
                                   const GlobalThesisParams& params);
/// (5.14) with that linearization.
double refinement_energy(const GlobalThesisScene& scene, const GlobalField& x,
                         const std::vector<Vec3>& initial, const std::vector<Vec3>& delta,
                         const GlobalThesisParams& params);
/// The solution of a symmetric positive definite system.
std::vector<Vec3> solve_refinement(const RefinementSystem& system);
/// b + Δb, kept within kDarkestColor … 1.
constexpr double kDarkestColor = 1e-3;
std::vector<Vec3> refined(const std::vector<Vec3>& colors, const std::vector<Vec3>& delta);

/// Decomposes frame after frame and keeps keyframes between them.
class GlobalThesis {
 public:
  /// Called after every step from 0 (−1: the start).
  using Trace = std::function<void(int step, const GlobalEnergy& energy)>;

  explicit GlobalThesis(const GlobalThesisParams& params) : params_(params) {}
  void set_trace(Trace trace) { trace_ = std::move(trace); }
  /// Packed chromaticities (w) for the next frames instead of their own: which samples agree is
  /// decided on a grid, and single precision may fall on its other side.
  void set_chromaticities(Plane plane) { chromaticities_ = std::move(plane); }

  /// targets: as cluster_targets gives them; colors: b_1 … b_K.
  GlobalField decompose(const Plane& linear, const Plane& targets, std::vector<Vec3> colors);

  /// Steps of the last frame that were shortened: to a quarter, a sixteenth, or nothing.
  int shortened() const { return shortened_; }
  /// Energy of any x with the scene and the samples of the last frame.
  GlobalEnergy energy(const GlobalField& x) const;
  /// What the last frame was solved with.
  const GlobalThesisScene& scene() const { return scenes_.back(); }

 private:
  GlobalSamples samples(const SampleFrame& current) const;

  GlobalThesisParams params_;
  Trace trace_;
  Plane chromaticities_;
  std::uint32_t frame_ = 0;
  int shortened_ = 0;
  std::deque<SampleFrame> keyframes_;        // newest last
  std::vector<SampleFrame> used_keyframes_;  // those that the last frame was solved with
  std::vector<GlobalThesisScene> scenes_;    // of the last frame, one
};

}  // namespace inverse::reference
