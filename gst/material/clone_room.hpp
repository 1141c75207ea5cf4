// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "gst/base/filter.hpp"
#include "kernels/material/raster/room_insertion.hpp"

namespace inverse {

/// What the camera of a frame sees of a remembered scene, on the host.
struct CloneView {
  Extent extent;
  Lens lens;
  Pose pose;
  std::vector<float> surface;  ///< SeenScene::surface; empty if it was not asked for

  /// The surface under a pixel of a frame, in the world; empty: none is known there.
  std::optional<std::array<float, 3>> place(double x, double y, Extent frame) const;
};

/// An object in the remembered scene of layers.
class CloneRoom {
 public:
  CloneRoom(const std::shared_ptr<gpu::Device>& device, Extent frame, const Mesh& mesh)
      : reads_(device), insertion_(device, frame) {
    insertion_.set_mesh(mesh);
  }

  /// What this frame's camera sees; empty: it is lost. Waits for the decomposer's work on the
  /// frame: the host needs the pose.
  std::optional<CloneView> see(const FrameContext& frame, bool with_surface);
  RoomInsertion& insertion() { return insertion_; }
  const RoomInsertion& insertion() const { return insertion_; }
  void forget() { insertion_.forget(); }

 private:
  gpu::Commands reads_;
  gpu::BufferPtr pose_, surface_;
  RoomInsertion insertion_;
};

}  // namespace inverse
