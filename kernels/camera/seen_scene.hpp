// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "kernels/camera/camera.hpp"
#include "kernels/gpu/buffer.hpp"
#include "kernels/image/plane.hpp"

namespace inverse {

/// What a frame sees of a remembered scene, and the scene itself, on the device. It shows what the
/// frame shows, in a size of its own.
///
/// `surface` and `pose` are this frame's: nothing writes them while a reference to them is held.
/// `table` and `voxels` are those of the volume, which goes on: work that is recorded now sees all
/// that was submitted before it, which is this frame or some later ones, each as a whole, since
/// work on a device runs in the order of its submits. They stay if the scene is forgotten.
struct SeenScene {
  Extent extent;
  Lens lens;
  PlanePtr surface;  ///< unit normal toward the camera in its axes, 0 where unknown; w: depth,
                     ///< meters along the optical axis, 0 where unknown
  PlanePtr pose;     ///< kPoseRows vec4: Pose, and in x of the third 1, or 0 if it is not known
  gpu::BufferPtr table, voxels;  ///< Volume::table, Volume::voxels
  uint32_t table_mask = 0;       ///< entries of `table` less one
  float voxel = 0;               ///< side of a voxel, meters
  float truncation = 0;          ///< of distances, meters
};

}  // namespace inverse
