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

/// The five networks of thesis Fig. 6.3 on a device, one after the other on a square of a frame,
/// and the layers of the frame by what they gave last. Decides nothing: where frames are looked at,
/// and by which networks, is for LimeMaterial to say.
class LimeNetworks {
 public:
  /// For frames of this size. Throws as network::Network.
  LimeNetworks(const std::shared_ptr<gpu::Device>& device, Extent extent, LimeModels models);

  /// Records SegmentationNet, on a square of the frame.
  void record_mask(gpu::Commands& commands, const Plane& frame, const Square& square);
  /// Records that points of it are of no object, or of another one: a word for each, not 0 of such.
  void record_foreign(gpu::Commands& commands, const gpu::BufferPtr& foreign);
  /// Records the other four, of the object that was found in the square.
  void record_material(gpu::Commands& commands);

  /// `diffuse` has linear RGB without the specular layer, w = mask; `gloss` the specular layer
  /// (gray, linear) in rgb, w = mirror image.
  struct Layers {
    PlanePtr diffuse, gloss;
  };
  /// Records drawing a frame's layers by what was found in a square of it, or of one before.
  Layers record_layers(gpu::Commands& commands, const Plane& frame, const Square& square);
  /// The same where no object is known.
  Layers record_bare_layers(gpu::Commands& commands, const Plane& frame);

  /// Records each of these once on a black frame, so that no kernel is built while frames come.
  void warm_up(gpu::Commands& commands);

  uint32_t side() const { return side_; }  ///< points along a side of the square
  /// Bytes of device memory that the networks take.
  uint64_t bytes() const;

  /// Of the square that was looked at last, a vec4 in front and then one for each point: sRGB; the
  /// object's probability (x); codes of its specular layer and mirror image (x, y).
  const gpu::BufferPtr& picture() const { return segmentation_.input(0); }
  const gpu::BufferPtr& probability() const { return segmentation_.output(0); }
  const gpu::BufferPtr& codes() const { return exponent_.input(0); }
  /// Of its object, behind a vec4: diffuse albedo and alpha; probabilities of the bins.
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
