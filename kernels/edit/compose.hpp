#pragma once
#include <array>

#include "kernels/gpu/commands.hpp"
#include "kernels/image/layers.hpp"

namespace inverse {

/// What becomes of the light that the model does not explain, input − R S.
///
/// Decomposers with one unknown a pixel leave next to none; others leave highlights, colored light
/// and noise. `add` is right for highlights: what mirrors off a surface does not care for its
/// paint, so a red car painted blue keeps white glints. It also leaves the noise of a bright
/// surface on the dark one that takes its place, and what the model overestimated can turn black
/// there; `ratio` scales noise and texture with the edit and keeps them in proportion, but tints
/// highlights and, for dark surfaces that become bright, multiplies noise.
enum class Residual : uint8_t {
  add,    ///< input + R' S' − R S
  ratio,  ///< input · (R' S' + ε) / (R S + ε), ε = 0.002 of full scale
  none,   ///< R' S': the model alone
};

/// How to put a frame together again.
struct ComposeParams {
  Residual residual = Residual::add;
  /// 0: the input as it came, 1: the edit.
  float strength = 1.0f;
};

/// Makes pictures out of layers; R S stands for R S L where light has a color L of its own
/// (Layers::global), and for diffuse + specular where the frame was taken apart into these
/// (Layers::material), which leave no residual. All are linear RGB, finite and not negative, with
/// the input's alpha in w.
class Compose {
 public:
  Compose(const std::shared_ptr<gpu::Device>& device, Extent extent);

  /// The frame with its edits. Where nothing was edited (Layers::edited, or strength is 0), this is
  /// the input's plane itself and nothing is recorded, unless the residual is to be left out. Needs
  /// input, model and intrinsic, or input, diffuse and specular, of which nobody says whether they
  /// were edited.
  PlanePtr record(gpu::Commands& commands, const Layers& layers, const ComposeParams& params);

  /// What the edits changed: R' S' − R S, halved, on middle gray (linear 0.214); brighter is more
  /// light.
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
