// SPDX-License-Identifier: LGPL-2.1-or-later
#include "frame_layers.hpp"

#include <algorithm>

#include "tests/lab.hpp"
#include "tests/srgb.hpp"

namespace inverse::bench {

FrameLayers::FrameLayers(const std::shared_ptr<gpu::Device>& device, const Image& frame)
    : device_(device),
      extent_{uint32_t(frame.width), uint32_t(frame.height)},
      commands_(device),
      intrinsic_(device, extent_),
      global_(device, extent_),
      compose_(device, extent_),
      input_(upload(frame)) {}

Layers FrameLayers::two_layers() {
  return watched([&](bool first) {
    return intrinsic_.record(commands_, input_, ScaledIntrinsic::Params{}, {first});
  });
}

Layers FrameLayers::all_layers(float amount) {
  GlobalIntrinsic::Params params;
  params.amount = amount;
  return watched([&](bool first) {
    return global_.record(commands_, input_, params, {first, true});
  });
}

Layers FrameLayers::no_layers() { return intrinsic_layers(input_, input_, nullptr); }

PlanePtr FrameLayers::upload(const Image& image) {
  const auto plane = std::make_shared<Plane>(Plane{
      extent_,
      gpu::Buffer::create(device_, gpu::Element::vec4, extent_.pixels(), gpu::Memory::upload)});
  float* pixel = plane->buffer->map_as<float>();
  const std::size_t channels = std::size_t(image.channels);
  for (std::size_t i = 0; i < extent_.pixels(); ++i) {
    for (std::size_t c = 0; c < 3; ++c)
      pixel[4 * i + c] = image.data[channels * i + std::min(c, channels - 1)];
    pixel[4 * i + 3] = 1;
  }
  return plane;
}

Image FrameLayers::made(Layers& layers, const std::function<void(gpu::Commands&, Layers&)>& edit) {
  commands_.begin();
  edit(commands_, layers);
  const PlanePtr picture = compose_.record(commands_, layers, {});
  commands_.submit();
  commands_.wait();
  return download(picture);
}

Layers FrameLayers::watched(const std::function<Layers(bool)>& record) {
  constexpr int kFrames = 3;
  Layers layers;
  for (int k = 0; k < kFrames; ++k) {
    commands_.begin();
    layers = record(k == 0);
    commands_.submit();
    commands_.wait();
  }
  return layers;
}

Image FrameLayers::download(const PlanePtr& plane) {
  const Pixels pixel = Lab(device_).download(plane->buffer);
  Image image(int(extent_.width), int(extent_.height), 3);
  for (std::size_t i = 0; i < extent_.pixels(); ++i)
    for (std::size_t c = 0; c < 3; ++c) image.data[3 * i + c] = pixel[4 * i + c];
  return image;
}

Image displayed(const Image& linear) {
  Image out = linear;
  for (float& v : out.data) v = srgb_code(std::clamp(v, 0.0F, 1.0F));
  return out;
}

}  // namespace inverse::bench
