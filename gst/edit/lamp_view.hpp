// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <optional>
#include <vector>

#include "kernels/camera/seen_scene.hpp"
#include "kernels/edit/relight/lamps.hpp"
#include "kernels/gpu/commands.hpp"

namespace inverse {

/// What the camera of a frame saw of a remembered scene, on the host: for lamps that the mouse
/// moves in the room.
struct LampView {
  Extent extent;
  Lens lens;
  Pose pose;
  std::vector<float> depth;  ///< meters along the optical axis, 0 where unknown; or empty

  /// The lamp as it is over a frame of this size: z of its place is its depth, meters. Empty: it is
  /// behind the camera.
  std::optional<Lamp> over(const Lamp& in_room, Extent frame) const;
  /// The inverse of `over`.
  Lamp in_room(const Lamp& over, Extent frame) const;
  /// At a place of such a frame; 0: unknown.
  float depth_at(Place place, Extent frame) const;
};

/// Reads views from the device.
class LampViews {
 public:
  explicit LampViews(std::shared_ptr<gpu::Device> device) : device_(std::move(device)) {}
  /// Records reading the view of frame `number`; null: there is none.
  void record(gpu::Commands& commands, uint64_t number, const SeenScene* scene, bool with_depth);
  /// Of one of the last kFramesInFlight frames, once it is completed; empty: it had none, or its
  /// camera was not found.
  std::optional<LampView> view(uint64_t number) const;

 private:
  struct Read {
    bool any = false, has_depth = false;
    Extent extent;
    Lens lens;
    gpu::BufferPtr pose, surface;
  };
  std::shared_ptr<gpu::Device> device_;
  gpu::FrameRing<Read> reads_;
};

}  // namespace inverse
