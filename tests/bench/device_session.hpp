// Frames' way to the device and back, for methods of kernels/.
#pragma once

#include <functional>
#include <memory>
#include <utility>

#include "kernels/gpu/commands.hpp"
#include "kernels/image/plane.hpp"
#include "tests/bench/method.hpp"

namespace inverse::bench {

/// One device for all methods of a program.
class DeviceSession {
 public:
  /// `select` as gpu::Device::open takes it.
  explicit DeviceSession(const std::string& select);
  const std::shared_ptr<gpu::Device>& device() const { return device_; }

  /// What a method makes of a frame: the plane R.rgb, S, and, of a method that tells direct from
  /// indirect light, one plane of RGB shading for each.
  struct Recorded {
    Recorded(PlanePtr both, PlanePtr straight = nullptr, PlanePtr bounced = nullptr)
        : intrinsic(std::move(both)), direct(std::move(straight)), indirect(std::move(bounced)) {}
    PlanePtr intrinsic, direct, indirect;
  };
  /// Uploads a frame, records a method's work on it, submits, waits and downloads. The cost is from
  /// the first command recorded to the layers in memory that the host can read; to and from the
  /// bench's images is not part of it. Shading of three layers is the luminance of their sum.
  using Record = std::function<Recorded(gpu::Commands&, const PlanePtr&)>;
  Decomposition run(const Image& frame, const Record& record, Cost& cost);

 private:
  std::shared_ptr<gpu::Device> device_;
  gpu::Commands commands_;
  PlanePtr input_;
  gpu::BufferPtr output_, direct_, indirect_;
};

/// The same method on a frame halved `times` times: shading is enlarged again (bilinearly, its
/// logarithm), and reflectance is what it leaves of the full frame. The cost includes both.
std::unique_ptr<Solver> at_lower_resolution(
    Size size, int times, const std::function<std::unique_ptr<Solver>(Size)>& make);

}  // namespace inverse::bench
