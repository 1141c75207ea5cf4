// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <optional>

#include "gst/base/frames/picture.hpp"
#include "kernels/image/view/light_picture.hpp"

namespace inverse {

/// Draws what can be seen of a frame's light. Its kernels are made when they are first needed.
class LightPictures {
 public:
  /// Light of the kinds that only frames with layers of light have; throws Error(unsupported),
  /// which names `element`, if this is none.
  Picture draw(gpu::Commands& commands, const Layers& layers, LightPicture::What what,
               const char* element, uint32_t base = 0);
  /// Shading: in color if light has color, else as gray.
  Picture shading(gpu::Commands& commands, const Layers& layers);

 private:
  Picture drawn(gpu::Commands& commands, const Layers& layers, LightPicture::What what,
                uint32_t base);

  std::shared_ptr<gpu::Device> device_;  // those below belong to it
  std::optional<PlanePool> planes_;
  std::optional<LightPicture> light_;
};

}  // namespace inverse
