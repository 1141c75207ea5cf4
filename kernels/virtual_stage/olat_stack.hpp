#pragma once
#include <list>
#include <span>
#include <vector>

#include "kernels/gpu/commands.hpp"
#include "kernels/image/plane.hpp"
#include "kernels/virtual_stage_weigh.spv.hpp"
#include "stage/program/light_program.hpp"

namespace inverse {

/// Images of a scene under one light at a time (OLAT), linear RGB as half floats on the device, and
/// frames under any mixture of them: light adds up, so that a frame is the sum of the lights'
/// colors times their images, exact but for the rounding of that sum in float.
class OlatStack {
 public:
  /// Bytes that so many images take.
  static uint64_t bytes(Extent extent, uint64_t lights);
  /// `most_bytes`: what they may take. Throws Error(limit) where they would take more, saying how
  /// much and what to do, and Error(out_of_memory).
  OlatStack(std::shared_ptr<gpu::Device> device, Extent extent, uint32_t lights,
            uint64_t most_bytes);

  Extent extent() const { return extent_; }
  uint32_t lights() const { return lights_; }

  /// A part of the images, in a buffer of its own: no device binds all at once.
  struct Chunk {
    uint32_t first, count;
    gpu::BufferPtr images;  ///< two words a pixel: r and g, b and 0
  };
  const std::vector<Chunk>& chunks() const { return chunks_; }
  /// Fills one image from width × height RGB; what is not finite or negative becomes 0.
  void load(uint32_t light, std::span<const float> rgb);

  /// Records the sum for these colors, one for each light, and gives the plane it is in: rgb, w 1.
  /// Sums of many lights are kept for when the same colors come again: planes are not written
  /// again while somebody holds them.
  PlanePtr record(gpu::Commands& commands, std::span<const LightColor> colors);
  /// How many sums of many lights were made, and how many taken again.
  uint64_t made() const { return made_; }
  uint64_t taken_again() const { return taken_again_; }

 private:
  struct Sum {
    std::vector<LightColor> colors;
    PlanePtr plane;
  };

  std::shared_ptr<gpu::Device> device_;
  Extent extent_;
  uint32_t lights_;
  std::vector<Chunk> chunks_;
  gpu::Program<shaders::virtual_stage_weigh> weigh_;
  PlanePool planes_;
  std::list<Sum> sums_;  // the latest used first
  uint64_t made_ = 0, taken_again_ = 0;
};

}  // namespace inverse
