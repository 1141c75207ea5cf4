// SPDX-License-Identifier: LGPL-2.1-or-later
// Transfers frames to the device and back, for methods of kernels/.
#pragma once

#include <functional>
#include <memory>

#include "kernels/gpu/commands.hpp"
#include "kernels/image/layers.hpp"
#include "method.hpp"

namespace inverse::bench {

/// One device for all methods of a program.
class DeviceSession {
 public:
  /// `select` as in gpu::Device::open.
  explicit DeviceSession(const std::string& select);
  const std::shared_ptr<gpu::Device>& device() const { return device_; }

  /// A frame (3 channels) as a new plane, w = 1.
  PlanePtr upload(const Image& frame) const;

  /// Uploads a frame, records a method's work on it, submits, waits and downloads the layers
  /// Role::intrinsic and, if the method separates direct and indirect light, Role::light. The cost
  /// is from the first recorded command to the layers in host-readable memory, without conversion
  /// to and from the benchmark's images.
  using Record = std::function<Layers(gpu::Commands&, const PlanePtr&)>;
  Decomposition run(const Image& frame, const Record& record, Cost& cost);

 private:
  static void fill(const Image& frame, const Plane& plane);

  std::shared_ptr<gpu::Device> device_;
  gpu::Commands commands_;
  PlanePtr input_;
  gpu::BufferPtr output_, light_;
};

/// The same method on a frame halved `times` times: log shading is upsampled bilinearly, and
/// reflectance is the remainder of the full frame. The cost includes both.
std::unique_ptr<Solver> at_lower_resolution(
    Size size, int times, const std::function<std::unique_ptr<Solver>(Size)>& make);

}  // namespace inverse::bench
