// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <list>
#include <span>
#include <vector>

#include "kernels/gpu/commands.hpp"
#include "kernels/image/plane.hpp"
#include "kernels/lightstage/program/light_program.hpp"
#include "kernels/lightstage_virtual_stage_weigh.spv.hpp"

namespace inverse {

/// Images of a scene under one light at a time (OLAT), linear RGB as half floats on the device, and
/// frames under any mixture of the lights. Light adds up: a frame is the sum of the lights' colors
/// times their images, exact except for float rounding of the sum.
class OlatStack {
 public:
  /// Bytes of this number of images.
  static uint64_t bytes(Extent extent, uint64_t lights);
  /// `max_bytes`: limit of all images. Throws Error(limit) with the size and a remedy if they
  /// exceed it, and Error(out_of_memory).
  OlatStack(std::shared_ptr<gpu::Device> device, Extent extent, uint32_t lights,
            uint64_t max_bytes);

  Extent extent() const { return extent_; }
  uint32_t lights() const { return lights_; }

  /// A part of the images in a buffer of its own, because devices limit the size of a binding.
  struct Chunk {
    uint32_t first, count;
    gpu::BufferPtr images;  ///< two words per pixel: r and g, b and 0
  };
  const std::vector<Chunk>& chunks() const { return chunks_; }
  /// Uploads one image of width × height RGB; values that are not finite or negative become 0.
  void load(uint32_t light, std::span<const float> rgb);

  /// Records the sum for these colors, one per light, and returns its plane: rgb, w = 1. Sums of
  /// many lights are cached by color. A plane is not overwritten while it is referenced.
  PlanePtr record(gpu::Commands& commands, std::span<const LightColor> colors);
  /// Number of computed sums of many lights, and of cache hits.
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
  gpu::Program<shaders::lightstage_virtual_stage_weigh> weigh_;
  PlanePool planes_;
  gpu::BufferPtr table_;  // colors of the lights that are on
  std::list<Sum> sums_;   // the latest used first
  uint64_t made_ = 0, taken_again_ = 0;
};

}  // namespace inverse
