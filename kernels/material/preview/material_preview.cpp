// SPDX-License-Identifier: LGPL-2.1-or-later
#include "material_preview.hpp"

#include <algorithm>

namespace inverse {
namespace {

constexpr uint32_t kRows = shaders::material_preview_preview::kRows;
constexpr float kMargin = 0.06F;   // to the frame's borders, of the diameter
constexpr float kSmallest = 2.0F;  // pixels across

}  // namespace

MaterialPreview::MaterialPreview(const std::shared_ptr<gpu::Device>& device)
    : kernel_(device), sphere_(device) {}

void MaterialPreview::record(gpu::Commands& commands, const Plane& frame, const Material& material,
                             const std::shared_ptr<const Environment>& light, float size,
                             const Plane& picture) {
  const bool same_light =
      light_ && (*light_ == light || (*light_ && light && alike(**light_, *light)));
  if (!same_light) {
    sphere_.set_light(light ? *light : Environment::studio());
    light_ = light;
  }
  const Surface surface{material.diffuse, material.specular, material.shininess()};
  if (!surface_ || !alike(*surface_, surface)) surface_ = surface;
  sphere_.record(commands, *surface_, {});
  const auto width = static_cast<float>(frame.extent.width);
  const auto height = static_cast<float>(frame.extent.height);
  const float diameter = std::max(size * std::min(width, height), kSmallest);
  const float off = diameter * (0.5F + kMargin * (1 - size));
  commands.dispatch_rows(kernel_,
                         {.frame = frame.buffer,
                          .LIT_TABLE = sphere_.table().buffer,
                          .picture = gpu::by_rows(picture.buffer)},
                         {.size = frame.extent,
                          .middle = {width - off, height - off},
                          .radius = diameter / 2,
                          .side = sphere_.table().extent.width,
                          .first_row = 0},
                         {frame.extent.width, frame.extent.height, kRows});
  commands.stage("preview");
}

}  // namespace inverse
