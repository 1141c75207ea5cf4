// SPDX-License-Identifier: LGPL-2.1-or-later
// A device with transfer functions, for tests, reports and benchmarks.
#pragma once
#include <cmath>
#include <cstring>
#include <memory>
#include <utility>
#include <vector>

#include "kernels/gpu/commands.hpp"
#include "kernels/image/plane.hpp"
#include "tests/reference/plane.hpp"

namespace inverse {

using Pixels = std::vector<float>;  ///< vec4 pixels, row by row

/// INVERSE_TEXEL_VIEWS, INVERSE_SUBGROUPS and INVERSE_WORKGROUP choose the variant.
class Lab {
 public:
  explicit Lab(std::shared_ptr<gpu::Device> device = gpu::Device::open())
      : device_(std::move(device)) {}

  const std::shared_ptr<gpu::Device>& device() const { return device_; }

  /// A plane of so many vec4, undefined.
  gpu::BufferPtr buffer(uint64_t count) const {
    return gpu::Buffer::create(device_, gpu::Element::vec4, count);
  }
  gpu::BufferPtr upload(const Pixels& values) const {
    auto buffer =
        gpu::Buffer::create(device_, gpu::Element::vec4, values.size() / 4, gpu::Memory::upload);
    memcpy(buffer->map(), values.data(), values.size() * sizeof(float));
    return buffer;
  }
  PlanePtr plane(Extent extent, const Pixels& pixels) const {
    return std::make_shared<Plane>(Plane{extent, upload(pixels)});
  }
  /// Records with `record(commands)`, submits and waits.
  template <typename Record>
  void run(Record record) const {
    gpu::Commands commands(device_);
    commands.begin();
    record(commands);
    commands.submit();
    commands.wait();
  }
  Pixels download(const gpu::BufferPtr& buffer) const {
    auto host =
        gpu::Buffer::create(device_, buffer->element(), buffer->count(), gpu::Memory::readback);
    run([&](gpu::Commands& commands) { commands.copy(buffer, host, buffer->bytes()); });
    const float* data = host->map_as<float>();
    return {data, data + buffer->bytes() / sizeof(float)};
  }

 private:
  std::shared_ptr<gpu::Device> device_;
};

inline reference::Vec4 pixel_of(const Pixels& pixels, size_t n) {
  return {pixels[4 * n], pixels[4 * n + 1], pixels[4 * n + 2], pixels[4 * n + 3]};
}

/// ln S of (R, S).
inline std::vector<double> log_shading_of(const Pixels& layers) {
  std::vector<double> log_shading;
  for (size_t i = 3; i < layers.size(); i += 4)
    log_shading.push_back(std::log(static_cast<double>(layers[i])));
  return log_shading;
}

/// The same for the double-precision references.
inline reference::Plane to_reference(Extent extent, const Pixels& pixels) {
  reference::Plane plane(static_cast<int>(extent.width), static_cast<int>(extent.height));
  for (size_t n = 0; n < plane.size(); ++n) plane.data[n] = pixel_of(pixels, n);
  return plane;
}

}  // namespace inverse
