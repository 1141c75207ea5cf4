// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "kernels/reuse/repeat_planner.hpp"
#include "layer_view.hpp"
#include "method.hpp"
#include "rate_controller.hpp"

namespace inverse {

/// A decomposer of reflectance and shading: runs a method at the level of work that `target-fps`
/// and `latency-budget` allow, reuses the layers of repeated pictures, and draws what `show` asks
/// for.
///
/// To reuse them it keeps the planes of the last frame, which editors then have to copy; so it does
/// only while repeats are frequent (FrameContext::keep_planes).
class Decomposer final : public Filter {
 public:
  explicit Decomposer(std::unique_ptr<DecompositionMethod> method);
  DecompositionMethod& method() { return *method_; }

  PropertyStore& parameters() override { return method_->settings().store(); }
  bool compares_frames() const override { return method_->settings().adaptive(); }
  std::span<const char* const> shows_frame() const override {
    static constexpr std::array kFrames{"input"};
    return kFrames;
  }
  void configure(const std::shared_ptr<gpu::Device>& device, Extent extent) override;
  void release() override;
  void reset() override;
  void process(FrameContext& frame) override;
  void completed(uint64_t number, double milliseconds) override;
  void late(double milliseconds) override;
  void describe(GstStructure* stats, uint64_t number) const override;
  std::vector<Setting> navigate(const MouseEvent& event) override;
  void flushed() override { method_->flushed(); }
  void ended() override { method_->ended(); }

 private:
  RepeatPlanner::Decision decide(const FrameContext& frame, const FrameSettings& settings);
  void draw(FrameContext& frame, const FrameSettings& settings, bool reused);

  /// One of the last frames.
  struct Past {
    uint64_t method_frame = 0;  // the method's number of the frame whose layers it has
    bool reused = false;
    const char* reason = "";  // of RepeatPlanner
    size_t level = 0;         // of RateController
    uint64_t reused_so_far = 0;
  };

  std::unique_ptr<DecompositionMethod> method_;
  RateController rate_controller_;
  RepeatPlanner repeats_;
  LayerView view_;
  gpu::FrameRing<Past> past_;
  std::optional<Layers> kept_;       // of the frame before
  uint64_t method_frame_ = 0;        // the method's number of the last frame
  uint64_t reused_ = 0;              // frames since `configure`
  std::optional<ShowParams> drawn_;  // how the frame before was drawn
  size_t logged_level_;
};

}  // namespace inverse
