// SPDX-License-Identifier: LGPL-2.1-or-later
// Both global methods behind one interface for frame sequences.
#pragma once
#include <memory>
#include <span>
#include <vector>

#include "kernels/global/global_intrinsic.hpp"
#include "kernels/thesis/chapter5/global_thesis.hpp"
#include "tests/extremes/support/inputs.hpp"

namespace inverse::extremes {

/// The layers of a frame, as an editor receives them.
struct GlobalLayers {
  Pixels intrinsic;            ///< R.rgb, S
  Pixels light;                ///< color, direct share
  std::vector<Pixels> shares;  ///< four base colors a plane; as many planes as were made
  Pixels bases;                ///< kMaxBases
  /// Base colors that there are.
  uint32_t colors() const;
};

/// A decomposer of one size with the operations of the tests.
class GlobalMethod {
 public:
  GlobalMethod(const Lab& lab, Solver solver, Extent extent);
  /// With the parameters of a case.
  void set(const Case& one);
  void set(const GlobalIntrinsic::Params& params) { params_ = params; }
  void set(const GlobalThesisParams& params) { thesis_->set_params(params); }

  /// The next frame of a video. The thesis' method finds the colors of its first frame before.
  /// globalintrinsic may receive the changed tiles (GlobalIntrinsic::FrameInfo::changed).
  GlobalLayers decompose(const Pixels& frame, std::span<const uint8_t> changed = {});
  void reset();

  /// Of globalintrinsic's last frame.
  const GlobalIntrinsic::Findings& found() const { return found_; }
  const GlobalIntrinsic::Stats& last_stats() const { return last_stats_; }
  GlobalThesis& thesis() { return *thesis_; }
  /// Of the thesis' method's last frame.
  const GlobalThesis::Stats& stats() const { return stats_; }

 private:
  const Lab& lab_;
  Extent extent_;
  GlobalIntrinsic::Params params_;
  std::unique_ptr<GlobalIntrinsic> global_;
  std::unique_ptr<GlobalThesis> thesis_;
  GlobalIntrinsic::Findings found_;
  GlobalIntrinsic::Stats last_stats_;
  GlobalThesis::Stats stats_;
  bool first_ = true;
};

/// What is wrong with layers, whatever the frame was: values that are not finite, negative light,
/// reflectance or shares, a direct share outside 0…1 or, unless the lamps have a color of their
/// own, above the light; globalintrinsic's must multiply to its input, and the thesis' direct and
/// indirect layers sum to the light.
std::optional<std::string> wrong_global_layers(Solver solver, uint32_t frame, const Pixels& input,
                                               const GlobalLayers& layers,
                                               bool colored_lamps = false);

/// The check of `Case`s whose solver is one of kGlobalMethods. `lab` must outlive it.
Check check_global_with(const Lab& lab);

}  // namespace inverse::extremes
