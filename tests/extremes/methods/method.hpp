// SPDX-License-Identifier: LGPL-2.1-or-later
// All methods behind one interface for frame sequences.
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "kernels/global/global_intrinsic.hpp"
#include "kernels/thesis/chapter3/thesis_decomposition.hpp"
#include "kernels/thesis/chapter5/global_thesis.hpp"
#include "tests/extremes/support/inputs.hpp"

namespace inverse::extremes {

/// The layers of a frame, as an editor receives them. All but `intrinsic` and `slope` are those of
/// methods that find direct and indirect light.
struct Output {
  Pixels intrinsic;            ///< R.rgb times the color of light, S
  Pixels slope;                ///< of the color of light (Role::slope), if it is not gray
  Pixels light;                ///< color, direct share
  std::vector<Pixels> shares;  ///< four base colors a plane; as many planes as were made
  Pixels bases;                ///< kMaxBases
  /// Number of base colors.
  uint32_t colors() const;
  bool operator==(const Output&) const = default;
};

/// A decomposer of one size with the operations of the tests.
class Method {
 public:
  Method(const Lab& lab, Solver solver, Extent extent);
  void set(const IntrinsicDecomposition::Params& params) {
    static_cast<IntrinsicDecomposition::Params&>(params_) = params;
  }
  /// Makes intrinsicdecomp one of several resolutions.
  void set(const ScaledIntrinsic::Params& params);
  void set(const GlobalIntrinsic::Params& params) { params_ = params; }
  /// All but `solver`, which the constructor sets.
  void set(ThesisParams params);
  void set(const GlobalThesisParams& params) { global_thesis_->set_params(params); }
  /// With the parameters of a case.
  void set(const Case& one);

  /// The next frame of a video. globalintrinsicthesis finds the colors of its first frame before.
  Output decompose(const Pixels& frame);
  /// The same in the solver's own scale.
  Output decompose_unscaled(const Pixels& frame);
  void reset();

  /// Of the last frame of intrinsicdecomp or, what globalintrinsic solves, globalintrinsic.
  const ScaledIntrinsic::Stats& solve_stats() const { return stats_.solve; }
  /// Of the last frame of globalintrinsic.
  const GlobalIntrinsic::Stats& stats() const { return stats_; }
  const GlobalIntrinsic::Findings& found() const { return found_; }
  /// Of the last frame of the thesis' methods.
  const ThesisDecomposition::Stats& thesis_stats() const { return thesis_stats_; }
  const GlobalThesis::Stats& global_thesis_stats() const { return global_thesis_stats_; }
  ThesisDecomposition& thesis() { return *thesis_; }
  GlobalThesis& global_thesis() { return *global_thesis_; }

 private:
  const Lab& lab_;
  Solver solver_;
  Extent extent_;
  GlobalIntrinsic::Params params_;
  std::unique_ptr<IntrinsicDecomposition> intrinsic_;
  std::unique_ptr<ScaledIntrinsic> scaled_;
  std::unique_ptr<GlobalIntrinsic> global_;
  std::unique_ptr<ThesisDecomposition> thesis_;
  std::unique_ptr<GlobalThesis> global_thesis_;
  GlobalIntrinsic::Findings found_;
  GlobalIntrinsic::Stats stats_;
  ThesisDecomposition::Stats thesis_stats_;
  GlobalThesis::Stats global_thesis_stats_;
  float scale_ = 0;  // ln of the factor from the solver's R to the layer's, of the last frame
  bool first_ = true;
};

/// Maximum light that a method takes, full scale 1.
float max_light(Solver solver);

/// Linear light of a frame as the references take it: interleaved RGB, +Inf as 1.
std::vector<double> rgb_of(const Pixels& pixels);

}  // namespace inverse::extremes
