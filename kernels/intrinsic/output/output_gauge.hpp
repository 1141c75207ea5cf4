#pragma once
#include <array>
#include <memory>

#include "kernels/intrinsic/guide/guide.hpp"

namespace inverse {

/// The scale in which reflectance and shading go out (gauge.glsl). Found on the device, frame by
/// frame; steady over time, fresh at cuts.
class OutputGauge {
 public:
  struct Params {
    /// Quantile of max_c R over the frame, 0…1, that …
    float quantile = 0.98F;
    /// … comes to this value, 0.05…1 (1 = the brightest that a display shows).
    float value = 0.9F;
    /// Share of the newest frame, 0…1; 1 follows every frame, 0 never moves until a cut.
    float share = 0.1F;
    bool operator==(const Params&) const = default;
  };
  explicit OutputGauge(const std::shared_ptr<gpu::Device>& device);

  /// What is known of the frame before.
  enum class History : uint32_t { none, judged, taken_on };
  /// Records finding the gauge for `shading`, the solution in quads. `verdict`, which is
  /// TemporalAnchor's, counts where the frame before was judged by it. Where it `stays`, what is
  /// known is not changed, but what the frame would have is told.
  void record(gpu::Commands& commands, const Guide& guide, const gpu::BufferPtr& shading,
              const gpu::BufferPtr& verdict, History history, const Params& params,
              bool stays = false);
  /// Records taking over what another has come to.
  void take(gpu::Commands& commands, const OutputGauge& other);
  /// One vec4: ln c in x; in z what the last frame with light would have, in w
  /// how much ln c moved by the last frame.
  const gpu::BufferPtr& value() const { return gauge_; }

 private:
  void clear_once(gpu::Commands& commands);

  gpu::KernelPtr count_, gauge_kernel_;
  gpu::BufferPtr counts_, gauge_;
  bool cleared_ = false;
};

}  // namespace inverse
