// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstdint>
#include <memory>

#include "kernels/camera/camera.hpp"
#include "kernels/depth/volume_data.hpp"
#include "kernels/depth_allocate.spv.hpp"
#include "kernels/depth_approach.spv.hpp"
#include "kernels/depth_integrate.spv.hpp"
#include "kernels/depth_list.spv.hpp"
#include "kernels/depth_march.spv.hpp"
#include "kernels/depth_normals.spv.hpp"
#include "kernels/depth_outdated.spv.hpp"
#include "kernels/depth_ranges.spv.hpp"
#include "kernels/gpu/commands.hpp"
#include "kernels/image/plane.hpp"

namespace inverse {

/// Surfaces of a static scene in a sparse grid of voxels (Nießner et al. 2013): truncated signed
/// distance, ln reflectance, and a stroke. docs/reference/methods/volume.md.
class Volume {
 public:
  struct Params {
    float voxel = 0.01F;                    ///< side of a voxel, meters
    float truncation = 4;                   ///< of distances, voxels
    uint32_t blocks = 32'768;               ///< of 8 x 8 x 8 voxels, kBlockBytes each
    float min_depth = 0.1F, max_depth = 5;  ///< of the camera, meters
    float memory = 32;  ///< frames of full confidence that the mean of reflectance remembers
  };
  /// Of one block in all buffers, beside two to four entries of the hash table.
  static constexpr uint32_t kBlockBytes = 512 * 12;

  /// Throws Error(limit) and Error(out_of_memory).
  Volume(const std::shared_ptr<gpu::Device>& device, const Params& params);

  /// Forgets all.
  void record_clear(gpu::Commands& commands);

  /// What a camera sees. `pose`: two vec4; `depth`: a scalar a pixel, meters along the optical
  /// axis, 0 where unknown; `surface`: a vec4 a pixel, unit normal toward the camera in its axes, 0
  /// where unknown, and depth without noise.
  struct Frame {
    Lens lens;
    Extent extent;
    gpu::BufferPtr pose, depth, surface;
  };
  /// What of a frame is added.
  struct Added {
    bool geometry = true, reflectance = true;
  };
  /// Adds a frame, with the reflectance that `layers` have (R.rgb, S).
  void record_integrate(gpu::Commands& commands, const Frame& frame, const gpu::BufferPtr& layers,
                        Added added);

  /// What the volume looks like from a camera.
  struct View {
    Extent extent;
    gpu::BufferPtr depth;        ///< a scalar a pixel: meters, 0 where nothing is
    gpu::BufferPtr surface;      ///< as Frame::surface
    gpu::BufferPtr reflectance;  ///< rgb: ln reflectance, w: confidence, 0…1
    gpu::BufferPtr strokes;      ///< a word a pixel, 0: none
    gpu::BufferPtr pose;         ///< two vec4: where the camera was when it was rendered
    gpu::BufferPtr outdated;     ///< a word: 1 if the last record_march rendered it, else 0
    /// Throws Error(out_of_memory).
    View(const std::shared_ptr<gpu::Device>& device, Extent extent);
    /// Of 8 x 8 pixels: the depths between which there are blocks.
    Extent tiles() const { return {(extent.width + 7) / 8, (extent.height + 7) / 8}; }
    gpu::BufferPtr nearest, farthest;
    /// Of every second pixel: the depth in front of the surface.
    Extent rays() const { return {(extent.width + 1) / 2, (extent.height + 1) / 2}; }
    gpu::BufferPtr start;
    Lens lens;
    uint64_t version = 0;  ///< of the volume when it was rendered; 0: it was not
  };
  /// Renders the view of a camera at `pose`, unless nothing was added since and the camera is still
  /// where the view was rendered from: turned by less than half a pixel, and moved by less than
  /// a third of a voxel.
  void record_march(gpu::Commands& commands, const Lens& lens, const gpu::BufferPtr& pose,
                    View& view);
  /// What others wrote into its buffers changes views.
  void changed() { ++version_; }

  /// All that it has, or takes the place of that; waits for the device. `restore` throws
  /// Error(limit) if it has not enough blocks, or voxels of another size.
  VolumeData data() const;
  void restore(const VolumeData& data);

  const Params& params() const { return params_; }
  /// Words of state.glsl.
  const gpu::BufferPtr& state() const { return state_; }
  /// The hash table; its entries less one.
  const gpu::BufferPtr& table() const { return table_; }
  uint32_t table_mask() const { return entries_ - 1; }
  /// A word a block; one and two words a voxel.
  const gpu::BufferPtr& keys() const { return keys_; }
  const gpu::BufferPtr& voxels() const { return voxels_; }
  const gpu::BufferPtr& colors() const { return colors_; }
  /// A stack of places, of which the first kFree (state.glsl) are free.
  const gpu::BufferPtr& free_blocks() const { return free_; }
  /// A word a block: its voxels that have a reflectance.
  const gpu::BufferPtr& colored() const { return colored_; }

 private:
  void record_list(gpu::Commands& commands, const Lens& lens, Extent extent,
                   const gpu::BufferPtr& pose);

  std::shared_ptr<gpu::Device> device_;
  Params params_;
  uint32_t entries_;
  uint64_t version_ = 1;  // what it has changes with it
  gpu::Program<shaders::depth_allocate> allocate_;
  gpu::Program<shaders::depth_list> list_blocks_;
  gpu::Program<shaders::depth_integrate> integrate_;
  gpu::Program<shaders::depth_ranges> ranges_;
  gpu::Program<shaders::depth_approach> approach_;
  gpu::Program<shaders::depth_march> march_;
  gpu::Program<shaders::depth_normals> normals_;
  gpu::Program<shaders::depth_outdated> outdated_;
  gpu::BufferPtr table_, keys_, fresh_, free_, state_, start_, list_, colored_, voxels_, colors_;
};

}  // namespace inverse
