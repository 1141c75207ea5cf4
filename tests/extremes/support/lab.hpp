// SPDX-License-Identifier: LGPL-2.1-or-later
// A device with transfer functions, for tests and for the report.
#pragma once
#include <cstring>
#include <memory>
#include <vector>

#include "kernels/gpu/commands.hpp"
#include "kernels/image/plane.hpp"

namespace inverse::extremes {

using Pixels = std::vector<float>;  ///< vec4 pixels, row by row

/// INVERSE_PORTABLE and INVERSE_WORKGROUP choose the variant.
class Lab {
 public:
  Lab() : device_(gpu::Device::open()) {}

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

}  // namespace inverse::extremes
