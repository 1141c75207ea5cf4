// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <functional>
#include <memory>

#include "kernels/edit/compose.hpp"
#include "kernels/global/global_intrinsic.hpp"
#include "tests/bench/metrics/image.hpp"

namespace inverse::bench {

/// The layers of an image, to edit and compose again.
class FrameLayers {
 public:
  FrameLayers(const std::shared_ptr<gpu::Device>& device, const Image& frame);

  /// Uses a video that repeats the image `kFrames` times.
  Layers two_layers();
  /// `amount` of indirect light; 0: measured.
  Layers all_layers(float amount = 0);
  /// The image itself as reflectance, under white light.
  Layers no_layers();

  Image reflectance(const Layers& layers) { return download(layers[Role::model]); }
  PlanePtr upload(const Image& image);
  /// What is composed of edited layers.
  Image made(Layers& layers, const std::function<void(gpu::Commands&, Layers&)>& edit);
  Extent extent() const { return extent_; }
  const std::shared_ptr<gpu::Device>& device() const { return device_; }

 private:
  Layers watched(const std::function<Layers(bool)>& record);
  Image download(const PlanePtr& plane);

  std::shared_ptr<gpu::Device> device_;
  Extent extent_;
  gpu::Commands commands_;
  ScaledIntrinsic intrinsic_;
  GlobalIntrinsic global_;
  Compose compose_;
  PlanePtr input_;
};

/// Display codes 0…1, in which pictures are compared.
Image displayed(const Image& linear);

}  // namespace inverse::bench
