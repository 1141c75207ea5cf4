// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>

#include "kernels/edit_bases.spv.hpp"
#include "kernels/edit_retint.spv.hpp"
#include "kernels/gpu/commands.hpp"
#include "kernels/image/layers.hpp"

namespace inverse {

/// Changes base colors of indirect light and thereby the color of light everywhere:
///
///   b'_k = b_k + strength · w_k · (s_k · target − b_k)        L' = max(L + matte Σ_k t_k (b'_k −
///   b_k), 0)
///
/// (bases.comp, retint.comp). Reflectance and S stay. Recolored surfaces reflect the changed light
/// again: L changes 1 / (1 − p) times as much, p the share of bounced light in the frame.
class LightEdit {
 public:
  /// Surfaces that were repainted.
  struct Surfaces {
    /// Its x = 0…1 says how much of each surface was repainted: w_k is their share of the light
    /// that surfaces of base color k send.
    const Plane& selection;
    /// Their color before (linear RGB) …
    std::array<float, 3> key{};
    /// … or of which cluster of a palette, −1: none …
    int cluster = -1;
    /// … or of the color in `keys`.
    bool by_base = false;
    /// Palette::colors(), with a cluster; a vec4, with `by_base`.
    gpu::BufferPtr keys = nullptr;
  };
  /// Base colors with a chromaticity c = b / mean b near to the key's.
  struct Key {
    std::array<float, 3> color;
    float tolerance = 0.6f, softness = 0.4f;  ///< distances of chromaticity, as in RecolorParams
  };

  LightEdit(const std::shared_ptr<gpu::Device>& device, Extent extent);

  /// Records that surfaces now have the color `target`. `layers` must be global and have a model;
  /// planes that others hold are not written.
  void repaint(gpu::Commands& commands, Layers& layers, const Surfaces& surfaces,
               const std::array<float, 3>& target, float strength);
  /// Records that base colors become `target` times their mean: a gray of 1 keeps their brightness
  /// and removes their color, 0 removes their light. The x of `matte`, if given, is the place of
  /// the change; the base colors themselves then stay.
  void change(gpu::Commands& commands, Layers& layers, const Key& key,
              const std::array<float, 3>& target, float strength, const Plane* matte);
  /// The same for one base color, 0…kMaxBases − 1.
  void change(gpu::Commands& commands, Layers& layers, uint32_t base,
              const std::array<float, 3>& target, float strength, const Plane* matte);

 private:
  using Push = shaders::edit_bases::Push;
  struct Inputs {
    const Plane *selection = nullptr, *matte = nullptr;
    gpu::BufferPtr keys;
  };
  void run(gpu::Commands& commands, Layers& layers, uint32_t by, const Push& push,
           const Inputs& inputs);

  std::shared_ptr<gpu::Device> device_;
  PlanePool planes_, bases_;
  gpu::BufferPtr change_;
};

}  // namespace inverse
