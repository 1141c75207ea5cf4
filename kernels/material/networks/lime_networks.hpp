// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <cstdint>
#include <memory>

#include "kernels/gpu/commands.hpp"
#include "kernels/image/plane.hpp"
#include "kernels/material/layers/guided_layers.hpp"
#include "kernels/material/layers/under_highlights.hpp"
#include "kernels/material/object/object_tracker.hpp"
#include "kernels/material_layers_layers.spv.hpp"
#include "kernels/material_networks_crop.spv.hpp"
#include "kernels/material_networks_drop_foreign.spv.hpp"
#include "kernels/material_networks_to_exponent.spv.hpp"
#include "kernels/material_networks_to_mirror_and_albedo.spv.hpp"
#include "kernels/material_networks_to_specular.spv.hpp"
#include "kernels/network/network.hpp"
#include "lime_models.hpp"

namespace inverse {

/// The five networks of thesis Fig. 6.3 on a device, applied to a square of a frame, and the
/// frame's layers from their last outputs. LimeMaterial decides which networks run on which square.
class LimeNetworks {
 public:
  /// For frames of this size. Throws as network::Network.
  LimeNetworks(const std::shared_ptr<gpu::Device>& device, Extent extent, LimeModels models);

  /// Records SegmentationNet on a square of the frame.
  void record_mask(gpu::Commands& commands, const Plane& frame, const Square& square);
  /// Records masking out points of other or no objects: a word per point, not 0 to mask it out.
  void record_foreign(gpu::Commands& commands, const gpu::BufferPtr& foreign);
  /// Records the other four networks, for the object found in the square.
  void record_material(gpu::Commands& commands);

  /// `diffuse` is linear RGB without the specular layer, w = mask; `gloss` the specular layer
  /// (gray, linear) in rgb, w = mirror image.
  struct Layers {
    PlanePtr diffuse, gloss;
  };
  /// Records drawing a frame's layers from the results in this square, of the same or an earlier
  /// frame.
  Layers record_layers(gpu::Commands& commands, const Plane& frame, const Square& square);
  /// The same without an object.
  Layers record_bare_layers(gpu::Commands& commands, const Plane& frame);

  uint32_t side() const { return side_; }  ///< points along a side of the square
  /// Bytes of device memory of the networks.
  uint64_t bytes() const;

  /// Of the last analyzed square, one vec4 and then one per point: sRGB; the object's probability
  /// (x); codes of its specular layer and mirror image (x, y).
  const gpu::BufferPtr& picture() const { return segmentation_.input(0); }
  const gpu::BufferPtr& probability() const { return segmentation_.output(0); }
  const gpu::BufferPtr& codes() const { return exponent_.input(0); }
  /// Of its object, after one vec4: diffuse albedo and alpha; probabilities of the bins.
  const gpu::BufferPtr& albedo() const { return albedo_.output(0); }
  const gpu::BufferPtr& bins() const { return exponent_.output(0); }

 private:
  Layers draw(gpu::Commands& commands, const Plane& frame, const Square& square, bool known);

  Extent extent_;
  uint32_t side_;
  network::Network segmentation_, specular_, mirror_, albedo_, exponent_;
  gpu::Program<shaders::material_networks_crop> crop_;
  gpu::Program<shaders::material_networks_drop_foreign> drop_foreign_;
  gpu::Program<shaders::material_networks_to_specular> to_specular_;
  gpu::Program<shaders::material_networks_to_mirror_and_albedo> to_mirror_and_albedo_;
  gpu::Program<shaders::material_networks_to_exponent> to_exponent_;
  GuidedLayers guided_;
  UnderHighlights under_;
  std::array<gpu::Program<shaders::material_layers_layers>, 2>
      layers_;  // without and with an object
  PlanePool planes_;
  bool new_mask_ = false, new_codes_ = false;  // since guided_ took them
};

}  // namespace inverse
