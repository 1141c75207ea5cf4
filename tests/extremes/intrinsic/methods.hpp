// SPDX-License-Identifier: LGPL-2.1-or-later
// Both methods behind one interface for frame sequences.
#pragma once
#include <memory>

#include "kernels/thesis/chapter3/thesis_decomposition.hpp"
#include "tests/extremes/support/inputs.hpp"

namespace inverse::extremes {

/// A decomposer of one size with the operations of the tests.
class Method {
 public:
  Method(const Lab& lab, Solver solver, Extent extent);
  void set(const IntrinsicDecomposition::Params& params) { intrinsic_params_ = params; }
  void set(const ThesisParams& params) { thesis_->set_params(params); }
  /// With the parameters of a case.
  void set(const Case& one);

  /// (R.rgb, S) of the next frame of a video, in the output's scale.
  Pixels decompose(const Pixels& frame);
  /// The same in the solver's own scale.
  Pixels decompose_unscaled(const Pixels& frame);
  /// ln of the factor from the solver's R to the layer's, of the last frame.
  float scale() const { return scale_; }
  ThesisDecomposition& thesis() { return *thesis_; }
  const ThesisDecomposition::Stats& thesis_stats() const { return stats_; }

 private:
  const Lab& lab_;
  Extent extent_;
  IntrinsicDecomposition::Params intrinsic_params_;
  std::unique_ptr<IntrinsicDecomposition> intrinsic_;
  std::unique_ptr<ThesisDecomposition> thesis_;
  ThesisDecomposition::Stats stats_;
  float scale_ = 0;
};

/// The most light that a method takes, full scale 1.
float most_light(Solver solver);

/// Linear light of a frame as the references take it: interleaved RGB, +Inf as 1.
std::vector<double> rgb_of(const Pixels& pixels);

}  // namespace inverse::extremes
