// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "kernels/gpu/commands.hpp"
#include "kernels/image/format/primaries.hpp"
#include "kernels/image/layers.hpp"

namespace inverse {

/// A picture of a layer before and after an effect changed it, both linear RGB of the same size.
struct ReturnedPicture {
  /// What it shows: R; S in the color of its light; the direct and the indirect part of that; the x
  /// of the mask.
  enum class Layer : uint8_t { reflectance, shading, direct, indirect, mask };
  Layer layer = Layer::shading;
  const Plane& sent;
  const Plane& returned;
  float gain = 1;     ///< of the picture: it shows min(gain · layer, 1)
  bool gray = false;  ///< what came back cannot have a color
  Gamut gamut = {};   ///< from the primaries of the picture to those of the layers
};

/// Applies the change between the two to the layers (returned.comp): pixels that came back as they
/// were sent keep every bit of their layer, however few bits the picture has.
///
/// Where shading changes its color, or light that has one changes at all, Role::light gets it, so
/// that R·S·light is what the effect made. Light without that layer then gets one, white before.
class ReturnedEdit {
 public:
  ReturnedEdit(const std::shared_ptr<gpu::Device>& device, Extent extent);

  /// Records the edit; planes that others hold are not written. `strength` 0…1 is its share, times
  /// the x of `matte`, if given. Nothing is recorded if that share or the gain is 0. The layers
  /// must have what the picture shows.
  void record(gpu::Commands& commands, Layers& layers, const ReturnedPicture& picture,
              float strength, const PlanePtr& matte);
  /// A mask that selects nothing.
  const PlanePtr& no_mask(gpu::Commands& commands) { return filled(no_mask_, commands, 0); }

 private:
  /// `plane` with one value throughout; made when it is first needed.
  const PlanePtr& filled(PlanePtr& plane, gpu::Commands& commands, float value);

  std::shared_ptr<gpu::Device> device_;
  PlanePool planes_;
  PlanePtr white_, no_mask_;  // white: light without a color
};

}  // namespace inverse
