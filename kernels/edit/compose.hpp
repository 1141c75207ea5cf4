// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>

#include "kernels/gpu/commands.hpp"
#include "kernels/image/layers.hpp"

namespace inverse {

/// How to treat the residual of the model, input − R S.
///
/// Decomposers with one unknown per pixel leave nearly none; others leave highlights, colored light
/// and noise. `add` is right for highlights, which do not depend on the paint: a red car painted
/// blue keeps white glints. But it keeps the noise of a bright surface on the dark one that
/// replaces it, and overestimated values can turn black. `ratio` scales noise and texture with the
/// edit, but tints highlights and amplifies noise on dark surfaces that become bright.
enum class Residual : uint8_t {
  add,    ///< input + R' S' − R S
  ratio,  ///< input · (R' S' + ε) / (R S + ε), ε = 0.002 of full scale
  none,   ///< R' S': the model alone
};

/// How to recombine the layers of a frame.
struct ComposeParams {
  Residual residual = Residual::add;
  /// 0: the input, 1: the edit.
  float strength = 1.0f;
};

/// Recombines layers into images. R S stands for R S L if the light has a color L of its own
/// (Layers::global), and for diffuse + specular in frames of these layers (Layers::material), which
/// have no residual. All are linear RGB, finite and not negative, with the input's alpha in w.
class Compose {
 public:
  Compose(const std::shared_ptr<gpu::Device>& device, Extent extent);

  /// The edited frame. Without an edit (Layers::edited is false, or strength is 0) it returns the
  /// input plane and records nothing, unless the residual is `none`. Needs input, model and
  /// intrinsic; or input, diffuse and specular, which always count as edited.
  PlanePtr record(gpu::Commands& commands, const Layers& layers, const ComposeParams& params);

  /// The change made by the edits: (R' S' − R S) / 2 added to middle gray (linear 0.214).
  PlanePtr record_difference(gpu::Commands& commands, const Layers& layers);

  /// The mask layer as gray. Needs Role::mask, and model and intrinsic.
  PlanePtr record_mask(gpu::Commands& commands, const Layers& layers);

 private:
  PlanePtr run(gpu::Commands& commands, uint32_t mode, const Layers& layers, Role now,
               float strength);

  PlanePtr recombine(gpu::Commands& commands, bool difference, const Layers& layers,
                     float strength);

  std::shared_ptr<gpu::Device> device_;
  PlanePool planes_;
};

}  // namespace inverse
