// SPDX-License-Identifier: LGPL-2.1-or-later
#include "layer_view.hpp"

namespace inverse {

void LayerView::configure(const std::shared_ptr<gpu::Device>& device, Extent extent) {
  device_ = device;
  mosaic_.reset();
  palette_.reset();
  planes_.emplace(device, extent);
}

void LayerView::reset() {
  if (palette_) palette_->reset();
}

void LayerView::draw_palette(FrameContext& frame, const Plane& target) {
  const Plane& model = *frame.layers[Role::model];
  if (!palette_) palette_.emplace(device_, model.extent);
  palette_->record_update(frame.commands, model);
  palette_->record_paint(frame.commands, model, target);
}

void LayerView::draw(FrameContext& frame, const ShowParams& params, const DrawClusters& clusters) {
  const PlanePtr& intrinsic = frame.layers[Role::intrinsic];
  const PlanePtr& input = frame.layers[Role::input];
  const auto scaled = [&](Picture picture) {
    picture.gain = params.shading_scale;
    return picture;
  };
  const auto light = [&](LightPicture::What what) {
    return scaled(light_.draw(frame.commands, frame.layers, what, "a decomposer",
                              static_cast<uint32_t>(params.layer)));
  };
  switch (params.show) {
    case Show::reflectance:
      frame.picture = {intrinsic};
      break;
    case Show::shading:
      frame.picture = scaled(light_.shading(frame.commands, frame.layers));
      break;
    case Show::direct:
      frame.picture = light(LightPicture::What::direct);
      break;
    case Show::indirect:
      frame.picture = light(LightPicture::What::indirect);
      break;
    case Show::layer:
      frame.picture = light(LightPicture::What::layer);
      break;
    case Show::input:
      frame.picture = {input};
      break;
    case Show::clusters:
      frame.picture = {planes_->acquire()};
      clusters(frame, *frame.picture.plane);
      break;
    case Show::mosaic: {
      if (!mosaic_) mosaic_.emplace(device_);
      frame.picture = {planes_->acquire()};
      using Source = Drawing::Source;
      if (frame.layers.global()) {
        const PlanePtr direct = light(LightPicture::What::direct).plane;
        const PlanePtr indirect = light(LightPicture::What::indirect).plane;
        mosaic_->record(frame.commands,
                        {{{input.get()},
                          {intrinsic.get()},
                          {direct.get(), Source::color, params.shading_scale},
                          {indirect.get(), Source::color, params.shading_scale}}},
                        *frame.picture.plane);
        break;
      }
      const PlanePtr drawn_clusters = planes_->acquire();
      const Picture shading = light_.shading(frame.commands, frame.layers);
      clusters(frame, *drawn_clusters);
      mosaic_->record(frame.commands,
                      {{{input.get()},
                        {intrinsic.get()},
                        {shading.plane.get(), shading.scalar ? Source::shading : Source::color,
                         params.shading_scale},
                        {drawn_clusters.get()}}},
                      *frame.picture.plane);
      break;
    }
  }
}

std::vector<Choice> show_choices(Makes makes) {
  const auto choice = [](Show show, const char* nick, const char* description) {
    return Choice{static_cast<int>(show), nick, description};
  };
  const bool global = makes == Makes::global;
  std::vector<Choice> choices{
      choice(Show::reflectance, "reflectance", "Reflectance: color without light and shadow"),
      choice(Show::shading, "shading",
             global ? "Shading: all light, direct and indirect, in color"
                    : "Shading: light and shadow, in color if light has one"),
      choice(Show::input, "input", "The frame as it came in"),
      choice(Show::mosaic, "mosaic",
             global ? "Input, reflectance, direct and indirect light at half size, side by side"
                    : "Input, reflectance, shading and clusters at half size, side by side"),
      choice(Show::clusters, "clusters",
             global ? "Each pixel in the color of its reflectance cluster or base color"
                    : "Each pixel in the color of its reflectance cluster")};
  if (global) {
    choices.push_back(choice(Show::direct, "direct", "Light that comes straight from the lamps"));
    choices.push_back(
        choice(Show::indirect, "indirect", "Light that bounced off surfaces, in color"));
    choices.push_back(choice(Show::layer, "layer",
                             "Light that bounced off surfaces of one base color, see layer"));
  }
  return choices;
}

}  // namespace inverse
