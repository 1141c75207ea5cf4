#include "decomposer.hpp"

namespace inverse {

void Decomposer::configure(const std::shared_ptr<gpu::Device>& device, Extent extent) {
  device_ = device;
  mosaic_.reset();
  planes_.emplace(device, extent);
}

void Decomposer::release() {
  mosaic_.reset();
  planes_.reset();
  device_.reset();
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
    case Show::mosaic: {
      if (!mosaic_) mosaic_.emplace(device_);
      frame.picture = {planes_->acquire()};
      using Source = Drawing::Source;
      mosaic_->record(frame.commands,
                      {{{input.get()}, {intrinsic.get()}, {intrinsic.get(), Source::shading}, {}}},
                      *frame.picture.plane);
      break;
    }
  }
}

std::vector<Choice> Decomposer::show_choices() {
  return {{static_cast<int>(Show::reflectance), "reflectance",
           "Reflectance: color without light and shadow"},
          {static_cast<int>(Show::shading), "shading",
           "Shading: light and shadow without color, as gray"},
          {static_cast<int>(Show::input), "input", "The frame as it came in"},
          {static_cast<int>(Show::mosaic), "mosaic",
           "Input, reflectance and shading at half size, side by side"}};
}

std::vector<Choice> Decomposer::quality_choices() {
  return {{static_cast<int>(Quality::low), "low",
           "The least work that still looks like a decomposition"},
          {static_cast<int>(Quality::medium), "medium", "The best error for its time"},
          {static_cast<int>(Quality::high), "high", "More iterations, for files"},
          {static_cast<int>(Quality::best), "best", "Until nothing changes any more"}};
}

}  // namespace inverse
