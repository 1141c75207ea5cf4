// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <memory>

#include "kernels/camera/seen_scene.hpp"
#include "kernels/edit_relight_apply.spv.hpp"
#include "kernels/edit_relight_place.spv.hpp"
#include "kernels/edit_relight_scene_light.spv.hpp"
#include "kernels/edit_relight_scene_shadows.spv.hpp"
#include "kernels/edit_relight_share.spv.hpp"
#include "kernels/gpu/commands.hpp"
#include "kernels/image/layers.hpp"
#include "lamps.hpp"
#include "relief.hpp"
#include "surface_file.hpp"

namespace inverse {

/// Distance of the picture plane from the camera in a remembered scene, if none is given; meters.
constexpr float kScenePlane = 2;

/// Light that is added to a frame.
struct RelightParams {
  /// Positions in pixels of the frame, or in the scene (Lamp::room). Those after the first
  /// kMaxLamps are not lit, nor those in the room of layers without a scene.
  std::vector<Lamp> lamps;
  /// Share of the light of the frame that stays: 1: lamps are added to it, 0: only they light.
  float ambient = 1;
  /// Factor on the power of all lamps.
  float strength = 1;
  /// Of normals that are estimated from shading: factor on slopes.
  float relief = 0.5F;
  enum class Surface : uint8_t {
    automatic,  ///< the picture's (Relight::set_surface); without one, from shading
    shading,    ///< estimated (Relief)
    flat,       ///< all faces the viewer
    scene,  ///< the remembered scene's (Layers::scene); without one as automatic. Lamps over the
            ///< picture follow the camera through it
  };
  Surface surface = Surface::automatic;
  /// Of the picture, if it is of depth: codes a meter; field of view along the width of the frame,
  /// degrees; distance of the picture plane, from which lamps are measured, from the camera, 0: the
  /// median of the picture. In a scene 0 is kScenePlane.
  float depth_units = 1000, field_of_view = 60, plane_depth = 0;
  /// Lamps in a scene cast shadows.
  bool shadows = true;
  /// Draw where lamps are.
  bool markers = false;
  /// Multiply the change by the mask layer if there is one.
  bool use_mask = true;
};

/// Relights a frame by its geometry (thesis 4.8): light of virtual lamps is added to shading. In
/// layers whose light is white and lamps too, S alone changes. Else the color of all light that
/// there is then becomes Role::light, so that R S' C(S') L' is exact; layers that had none get a
/// white model light. Lamps count as direct light: shares of bounced light in S shrink. Lamps in a
/// remembered scene light what the frame sees of it (scene_light.comp), and cast shadows
/// (scene_shadows.comp).
class Relight {
 public:
  Relight(const std::shared_ptr<gpu::Device>& device, Extent extent);

  /// Geometry for Surface::automatic; null: none.
  void set_surface(std::shared_ptr<const SurfaceFile> file);

  /// Records the edit of `layers`, which must have Role::intrinsic. Planes that others hold are not
  /// written. Does nothing if no lamp has an effect and ambient is 1. Values that are not finite
  /// count as 0 (infinity: as 65504); `params` are clamped to their ranges.
  void record(gpu::Commands& commands, Layers& layers, const RelightParams& params);

  /// Forgets earlier frames.
  void reset() { relief_.reset(); }

  /// Of the picture plane in the last frame that was edited, meters; 0: no depth is known.
  float plane_depth() const { return view_.plane_depth; }

 private:
  uint32_t prepare_surface(gpu::Commands& commands, const Layers& layers,
                           const RelightParams& params);
  /// Records the light of lamps in the scene; `first` and `count` are of the table.
  void record_scene(gpu::Commands& commands, const SeenScene& scene, int first, int count,
                    bool shadows);

  std::shared_ptr<gpu::Device> device_;
  Extent extent_;
  PlanePool planes_;
  gpu::BufferPtr nothing_, no_light_, no_share_, kept_, lamps_, placed_, normals_, shares_,
      scene_light_;
  PlanePtr white_;
  Relief relief_;
  std::shared_ptr<const SurfaceFile> file_;
  gpu::BufferPtr map_;  // of file_, with
  float map_focal_ = 0, map_units_ = 0;
  View view_;
  std::array<gpu::Program<shaders::edit_relight_apply>, 2> apply_;  // by COLOR
  gpu::Program<shaders::edit_relight_share> share_;
  gpu::Program<shaders::edit_relight_place> place_;
  gpu::Program<shaders::edit_relight_scene_shadows> shadows_;
  gpu::Program<shaders::edit_relight_scene_light> light_scene_;
};

}  // namespace inverse
