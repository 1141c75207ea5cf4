// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

#include "kernels/depth/volume.hpp"
#include "kernels/depth_streaming_insert.spv.hpp"
#include "kernels/depth_streaming_leave.spv.hpp"
#include "kernels/depth_streaming_move_in.spv.hpp"
#include "kernels/depth_streaming_move_out.spv.hpp"
#include "kernels/gpu/frame_ring.hpp"

namespace inverse {

/// Blocks of a volume that the device has no memory for, on the host (thesis 4.4; Nießner et al.
/// 2013). Blocks out of the camera's sight leave when few are free, those farthest away first; they
/// come back when the camera is to see them. At most kMoves of them a frame each way. None leave
/// while kMaxPools times what the device has room for are here.
/// docs/reference/methods/volume.md. Not thread-safe.
class HostBlocks {
 public:
  static constexpr uint32_t kMoves = shaders::depth_streaming_leave::kMoves;
  static constexpr size_t kMaxPools = 8;

  explicit HostBlocks(const std::shared_ptr<gpu::Device>& device) : device_(device) {}

  /// A camera, as it is on the device.
  struct Camera {
    Lens lens;
    Extent extent;
    gpu::BufferPtr pose;
  };
  /// What the host knows of it: of the last frame that is done.
  struct Known {
    Pose pose;
    uint32_t free_blocks;
  };
  /// Records moves of blocks for frame `number`, and takes in what frame number - kFramesInFlight
  /// moved, which must be done. `strokes`: changes with the strokes; those of blocks that left
  /// under others are dropped.
  void record(gpu::Commands& commands, uint64_t number, Volume& volume, const Camera& camera,
              const Known& known, uint64_t strokes);

  /// Blocks that are here.
  size_t size() const { return blocks_.size(); }
  /// Appends them to what the device has; or keeps what the device has no room for, and cuts it
  /// off. The device is idle.
  void append_to(VolumeData& data);
  void take_rest(VolumeData& data, uint32_t room);

 private:
  using Words = std::vector<uint32_t>;
  struct Block {
    Words words;  // voxels, then colors
    uint64_t strokes = 0;
    bool sent = false;  // and not known to be taken
  };
  struct InFlight {
    gpu::BufferPtr entering, moved;  // moved: how many left, who was taken, what left
    Words sent;                      // keys
    uint64_t strokes = 0;
    bool moves = false;
  };
  void make();
  void hear(uint64_t number);
  void record_out(gpu::Commands& commands, InFlight& frame, Volume& volume, const Camera& camera);
  void record_in(gpu::Commands& commands, InFlight& frame, Volume& volume, const Camera& camera,
                 const Known& known);

  std::shared_ptr<gpu::Device> device_;
  std::unordered_map<uint32_t, Block> blocks_;
  struct Kernels {
    explicit Kernels(const std::shared_ptr<gpu::Device>& device);
    gpu::Program<shaders::depth_streaming_leave> count, pick;
    gpu::Program<shaders::depth_streaming_move_out> move_out;
    gpu::Program<shaders::depth_streaming_insert> insert;
    gpu::Program<shaders::depth_streaming_move_in> move_in;
  };
  std::unique_ptr<Kernels> kernels_;  // made when the first block is to leave
  gpu::BufferPtr none_leaving_, leaving_, moved_, taken_;
  gpu::FrameRing<InFlight> frames_;
  uint64_t last_ = 0;  // frame
};

}  // namespace inverse
