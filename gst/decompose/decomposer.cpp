#include "decomposer.hpp"

namespace inverse {

void Decomposer::configure(const std::shared_ptr<gpu::Device>& device, Extent extent) {
  device_ = device;
  mosaic_.reset();
  palette_.reset();
  planes_.emplace(device, extent);
}

void Decomposer::release() {
  mosaic_.reset();
  palette_.reset();
  planes_.reset();
  device_.reset();
}

void Decomposer::reset() {
  if (palette_) palette_->reset();
}

PlanePtr Decomposer::draw_clusters(FrameWork& frame) {
  const Plane& model = *frame.layers[Role::model];
  if (!palette_) palette_.emplace(device_, model.extent);
  palette_->record_update(frame.commands, model);
  PlanePtr painted = planes_->acquire();
  palette_->record_paint(frame.commands, model, *painted);
  return painted;
}

void Decomposer::process(FrameWork& frame) {
  const Show show = decompose(frame);
  if (!frame.draw) return;
  const PlanePtr& intrinsic = frame.layers[Role::intrinsic];
  const PlanePtr& input = frame.layers[Role::input];
  switch (show) {
    case Show::reflectance:
      frame.picture = {intrinsic};
      break;
    case Show::shading:
      frame.picture = {intrinsic, true};
      break;
    case Show::input:
      frame.picture = {input};
      break;
    case Show::clusters:
      frame.picture = {draw_clusters(frame)};
      break;
    case Show::mosaic: {
      if (!mosaic_) mosaic_.emplace(device_);
      frame.picture = {planes_->acquire()};
      using Source = Drawing::Source;
      const PlanePtr clusters = draw_clusters(frame);
      mosaic_->record(frame.commands,
                      {{{input.get()},
                        {intrinsic.get()},
                        {intrinsic.get(), Source::shading},
                        {clusters.get()}}},
                      *frame.picture.plane);
      break;
    }
  }
}

std::vector<Choice> Decomposer::show_choices() {
  const auto choice = [](Show show, const char* nick, const char* description) {
    return Choice{static_cast<int>(show), nick, description};
  };
  return {choice(Show::reflectance, "reflectance", "Reflectance: color without light and shadow"),
          choice(Show::shading, "shading", "Shading: light and shadow without color, as gray"),
          choice(Show::input, "input", "The frame as it came in"),
          choice(Show::mosaic, "mosaic",
                 "Input, reflectance, shading and clusters at half size, side by side"),
          choice(Show::clusters, "clusters", "Each pixel in the color of its reflectance cluster")};
}

std::vector<Choice> Decomposer::quality_choices() {
  return {{static_cast<int>(Quality::low), "low",
           "The least work that still looks like a decomposition"},
          {static_cast<int>(Quality::medium), "medium", "The best error for its time"},
          {static_cast<int>(Quality::high), "high", "More iterations, for files"},
          {static_cast<int>(Quality::best), "best", "Many iterations, for reference"}};
}

}  // namespace inverse
