// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "gst/base/filter.hpp"
#include "kernels/image/view/mosaic.hpp"
#include "kernels/palette/scene_palette.hpp"
#include "light_pictures.hpp"

namespace inverse {

/// What a decomposer shows if pixels go out.
enum class Show {
  reflectance,
  shading,
  input,
  mosaic,
  clusters,
  direct,  ///< the last three: of decomposers that make layers of light
  indirect,
  layer,
};

/// How it shows it.
struct ShowParams {
  Show show = Show::reflectance;
  int layer = 0;               ///< base color, of Show::layer
  float shading_scale = 0.5F;  ///< of all kinds of light
  bool operator==(const ShowParams&) const = default;
};

/// The layers that a decomposer makes.
enum class Makes { intrinsic, global };

/// The values of `show`, of a decomposer that makes these layers.
std::vector<Choice> show_choices(Makes makes);

/// Draws the layers of a frame as ordinary video.
class LayerView {
 public:
  /// Draws every pixel of the frame in the color of its reflectance cluster.
  using DrawClusters = std::function<void(FrameContext& frame, const Plane& target)>;

  void configure(const std::shared_ptr<gpu::Device>& device, Extent extent);
  void release() { *this = {}; }
  /// Forgets the clusters of earlier frames.
  void reset();
  /// Sets `frame.picture` from `frame.layers`.
  void draw(FrameContext& frame, const ShowParams& params, const DrawClusters& clusters);
  /// Clusters of the reflectance plane `Role::model`, followed over time.
  void draw_palette(FrameContext& frame, const Plane& target);

 private:
  std::shared_ptr<gpu::Device> device_;
  std::optional<PlanePool> planes_;
  // Made on first use.
  std::optional<Mosaic> mosaic_;
  std::optional<ScenePalette> palette_;
  LightPictures light_;
};

}  // namespace inverse
