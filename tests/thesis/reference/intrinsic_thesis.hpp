// SPDX-License-Identifier: LGPL-2.1-or-later
// The solver of sections 3.5 and 4.6.2 in double precision: Gaussian pyramid, IRLS, and per IRLS
// step either Jacobi-preconditioned conjugate gradients over the level or additive Schwarz on 16×16
// blocks.
#pragma once

#include <deque>
#include <functional>
#include <optional>
#include <vector>

#include "intrinsic_thesis_energy.hpp"
#include "tests/reference/palette/palette.hpp"

namespace inverse::reference {

/// Levels that `levels = 0` stands for: three to five, so that the shorter side of the coarsest is
/// about 24 to 48 pixels. Any request is cut where a level would be 1×1 already.
int thesis_levels(int width, int height, int levels);

/// 5×5 binomial filter and every second pixel; borders repeat. Gives ⌈w/2⌉ × ⌈h/2⌉.
Plane downsample(const Plane& fine);

/// Bilinear interpolation from ⌈w/2⌉ × ⌈h/2⌉; coarse pixel X lies on fine pixel 2X.
Plane prolong(const Plane& coarse, int width, int height);

/// The strokes of a level from those of the finer one, of `width` x `height` pixels: a coarse pixel
/// belongs to the stroke with the largest sum of weights over the 3 x 3 fine pixels around its own,
/// by (1 2 1)/4 along each axis; borders repeat. That sum is its weight.
StrokeMask coarse_strokes(const StrokeMask& fine, int width, int height);

/// Offset of the Schwarz blocks at an iteration: ⌊16 · Halton(iteration; 2, 3)⌋.
std::array<int, 2> schwarz_shift(int iteration);

/// Jacobi-preconditioned conjugate gradients on a block of the image, with its work space.
class ConjugateGradients {
 public:
  /// single: rounds x and the search vectors to single precision wherever a device would store
  /// them.
  ConjugateGradients(int width, int height, bool single = false);

  /// `iterations` steps on A x = b from `start`, on the block [x0, x1) × [y0, y1) with the values
  /// outside it held fixed; only the block of `x` (equal to `start` there on entry) is written.
  /// Stops early where rᵀM⁻¹r falls below tolerance² times its start or a direction has no
  /// curvature.
  void run(const ThesisSystem& system, int iterations, double tolerance, int x0, int y0, int x1,
           int y1, const Plane& start, Plane* x);

 private:
  Plane residual_;
  Plane z_;
  Plane direction_;
  Plane product_;
  bool single_;
};

/// Decomposes frame after frame and keeps keyframes and the palette between them.
class IntrinsicThesis {
 public:
  /// Called after every IRLS step: level (0 is the finest), step from 0 (−1: the start), energy.
  using Trace = std::function<void(int level, int step, const ThesisEnergy& energy)>;

  explicit IntrinsicThesis(const ThesisParams& params) : params_(params), palette_({}) {
    const PaletteParams palette{
        .tau_cc = params.tau_cc, .chroma_floor = params.chroma_floor, .seed = params.seed};
    palette_ = Palette(palette);
  }

  /// Iterates each level until the energy's relative change is below 1e-10 (at most 400 IRLS steps,
  /// each solved to 1e-8): the converged decomposition for the same samples.
  void set_converged(bool converged) { converged_ = converged; }
  /// Rounds what a device would store to single precision: shows how far rounding alone leads.
  void set_single_precision(bool single) { single_ = single; }
  void set_trace(Trace trace) { trace_ = std::move(trace); }

  /// Uses this clustered reflectance r_cluster (w < 0: no cluster) instead of its own palette from
  /// the next frame on; an empty plane: no cluster prior.
  void set_clusters(Plane clusters) { clusters_ = std::move(clusters); }

  /// The user's strokes, from the next frame on; without kinds: none. An auxiliary variable is
  /// fixed while an IRLS step is solved, and follows after it (4.6.2).
  void set_strokes(StrokeMask strokes) { drawn_strokes_ = std::move(strokes); }

  /// What is known of reflectance from the next frame on (4.8), rgb = B r_model, w = B, and w_s; an
  /// empty plane: nothing.
  void set_known(Plane known, double weight) {
    known_ = std::move(known);
    known_weight_ = weight;
  }

  /// Packed chromaticities (w) by level, finest first, for the next frame instead of its own: which
  /// samples agree is decided on a grid, and single precision may fall on its other side.
  void set_chromaticities(std::vector<Plane> planes) { chromaticities_ = std::move(planes); }

  /// What the last frame's levels knew before they were solved.
  const std::vector<ThesisLevel>& levels() const { return levels_; }

  /// linear: RGB in linear light, any values. Gives (r, s) for every pixel.
  Plane decompose(const Plane& linear);

  /// Energy of any (r, s) at the finest level with the samples and clusters of the last frame.
  ThesisEnergy energy(const Plane& x) const;

  const Palette& palette() const { return palette_; }

 private:
  struct Keyframe {
    std::vector<SampleFrame> levels;
  };

  void solve_level(int index);
  ThesisEnergy energy_of(int index, const Plane& x, const Plane& clusters,
                         const std::vector<const SampleFrame*>& sources, std::uint32_t epoch) const;
  std::vector<const SampleFrame*> frames(int index, const SampleFrame& current) const;
  std::uint32_t epoch() const { return params_.resample ? frame_ : 0; }
  void irls_step(const ThesisSystem& system, int step, Plane* x) const;

  ThesisParams params_;
  Palette palette_;
  std::optional<Plane> clusters_;
  std::vector<Plane> chromaticities_;
  StrokeMask drawn_strokes_;
  Plane known_;
  double known_weight_ = 0;
  Trace trace_;
  bool converged_ = false;
  bool single_ = false;
  std::uint32_t frame_ = 0;
  std::deque<Keyframe> keyframes_;        // newest last
  std::vector<Keyframe> used_keyframes_;  // those that the last frame was solved with
  std::vector<ThesisLevel> levels_;
  std::vector<StrokeMask> strokes_;  // by level; empty: none
  std::vector<Plane> known_levels_;  // the same
  std::vector<Plane> solutions_;
  Plane cluster_plane_;
};

}  // namespace inverse::reference
