// SPDX-License-Identifier: LGPL-2.1-or-later
// Systems of an IRLS step of intrinsicdecompthesis
// (tests/thesis/reference/intrinsic_thesis_energy.hpp), put to the kernels as they are.
#pragma once
#include <array>
#include <bit>
#include <vector>

#include "kernels/thesis_chapter3_direction.spv.hpp"
#include "kernels/thesis_chapter3_reweight.spv.hpp"
#include "kernels/thesis_chapter3_schwarz.spv.hpp"
#include "kernels/thesis_chapter3_setup.spv.hpp"
#include "kernels/thesis_chapter3_update.spv.hpp"
#include "kernels/thesis_shared_scalars.spv.hpp"
#include "tests/extremes/support/problem.hpp"
#include "tests/thesis/reference/intrinsic_thesis_energy.hpp"

namespace inverse::extremes {

/// Push constants that are all 0, nothing sampled and nothing clustered.
template <typename Push>
Push zero_push() {
  return std::bit_cast<Push>(std::array<std::byte, sizeof(Push)>{});
}

/// The kernels of intrinsicdecompthesis on one level of the pyramid, driven one by one: for frozen
/// systems and for IRLS with frozen samples and clusters, which the method as a whole never shows.
class ThesisLab {
 public:
  /// `image` is linear light that a float holds; `w_…` and the floors are taken from `params`.
  ThesisLab(const Lab& lab, const reference::Plane& image, const reference::ThesisParams& params);

  /// Edges from the image, as the method does (setup.comp).
  void set_up() const;
  /// The edges of a frozen system instead (ThesisSystem): every IRLS step finds the same ones.
  void set_edges(const reference::Plane& edges);
  void set_sources(const reference::SourcePlane& sources);
  void set_solution(const reference::Plane& x);
  reference::Plane solution() const;

  /// One IRLS step: reweighting, then so many iterations of the solver. `step` shifts the blocks of
  /// Schwarz. `inner` counts its conjugate gradients within a block.
  void step(bool schwarz, int iterations, int step);

 private:
  using Push = shaders::thesis_chapter3_setup::Push;
  Push push() const;
  void conjugate_gradients(gpu::Commands& commands, int iterations) const;

  const Lab& lab_;
  Extent extent_;
  reference::ThesisParams params_;
  bool frozen_ = false;
  gpu::Program<shaders::thesis_chapter3_setup> setup_;
  gpu::Program<shaders::thesis_chapter3_reweight> reweight_;
  gpu::Program<shaders::thesis_chapter3_direction> direction_;
  gpu::Program<shaders::thesis_chapter3_update> update_;
  gpu::Program<shaders::thesis_shared_scalars> scalars_kernel_;
  gpu::Program<shaders::thesis_chapter3_schwarz> schwarz_;
  gpu::BufferPtr image_, links_, sources_, edges_, nodes_, preconditioned_, products_;
  gpu::BufferPtr solution_, spare_, directions_[2], partials_, scalars_;
};

/// Rounded to what a float holds, every number of it.
reference::Plane in_single_precision(reference::Plane plane);

/// The frozen system's unknowns in the order of the matrix: pixel · 4 + channel.
Eigen::MatrixXd matrix_of(const reference::ThesisSystem& system);

}  // namespace inverse::extremes
