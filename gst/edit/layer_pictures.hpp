// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <optional>

#include "gst/decompose/light_pictures.hpp"
#include "kernels/edit/compose.hpp"

namespace inverse {

/// What a pad of intrinsicsplit sends.
enum class SplitLayer : uint8_t {
  reflectance,
  shading,
  mask,
  input,
  direct,
  indirect,
  bounced,  ///< off surfaces of one base color
  diffuse,
  specular,
  mirror,
  count
};

/// How layers become video.
struct SplitParams {
  enum class Encoding : uint8_t { linear, srgb };
  Encoding encoding = Encoding::srgb;
  float reflectance_scale = 1.0f;  ///< multiplied before clipping at 1
  float shading_scale = 0.5f;
  float mirror_scale = 1.0f;
};

/// Draws layers as pictures.
class LayerPictures {
 public:
  /// `element` is what messages name. Throws Error(unsupported) if the frame has no such layer.
  Picture draw(gpu::Commands& commands, const Layers& layers, SplitLayer layer,
               const SplitParams& params, const char* element, uint32_t base = 0);

 private:
  Picture mask(gpu::Commands& commands, const Layers& layers, const char* element);

  std::shared_ptr<gpu::Device> device_;  // compose_ is for it and this size
  Extent extent_;
  std::optional<Compose> compose_;  // only needed for masks
  LightPictures light_;
};

}  // namespace inverse
