// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "plane.hpp"

namespace inverse {

struct SeenScene;  // kernels/camera/seen_scene.hpp

/// Content of a plane of a decomposed frame.
enum class Role : uint8_t {
  input,  ///< linear RGB of the frame, 1 = full scale; w = alpha
  model,  ///< R.rgb and S of the decomposer, before any edit; needed for the residual of the input
  intrinsic,  ///< reflectance R.rgb (may exceed 1) and shading S, changed by editors; R·S, times
              ///< the colors of `light` and `slope` where there are any, ≈ input
  mask,  ///< x = matte 0…1 for the next editor; yzw = reflectance of what is behind the selected
         ///< minus that of the pixel, where both share a pixel; else 0
  model_light,  ///< light of the decomposer, before any edit
  light,  ///< of frames with indirect light: rgb = color of the light, with R·S·rgb ≈ input (mean
          ///< or geometric mean 1 before edits), changed by editors; w = direct share of S, 0…1
  indirect,  ///< the first of kIndirectPlanes: shares of S that bounced off surfaces of base color
             ///< 4n…4n + 3; the rest of light.rgb has no layer
  bases = indirect + 4,  ///< kMaxBases × 1: color of light after bouncing off surfaces of base
                         ///< color k (linear, largest channel 1, changed by editors); w = 1, or 0
                         ///< if there is no such color
  model_bases,           ///< bases of the decomposer, before any edit
  lamp,      ///< 1 × 1: color of direct light, linear, geometric mean 1; absent if white
  diffuse,   ///< of frames with separated highlights: linear RGB without them; w = mask of the
             ///< object, 0…1
  specular,  ///< of the same frames: highlights, linear RGB, diffuse + specular = input; w = mirror
             ///< image: what a mirror of the object's specular albedo would reflect
  gradient_a,  ///< of pairs from a light stage: linear RGB under gradient A, 1 = full scale; w =
               ///< alpha
  gradient_b,  ///< the same under gradient B: A + B is the subject under all lights
  slope,  ///< 1 × 1: the color of light by its shading (light_color.glsl); absent if that is white.
          ///< `light`, if there is one, is beside it: both multiply R·S
  count
};

/// Maximum number of base colors of a frame: a plane of Role::indirect holds four.
constexpr uint32_t kMaxBases = 16;
constexpr uint32_t kIndirectPlanes = kMaxBases / 4;

/// Role::indirect of the base colors 4n…4n + 3.
constexpr Role indirect_role(uint32_t n) {
  return static_cast<Role>(static_cast<uint32_t>(Role::indirect) + n);
}

/// The layers of one frame; absent roles are null. Copying copies references, not pixels.
struct Layers {
  Extent extent;
  std::array<PlanePtr, static_cast<size_t>(Role::count)> planes;
  /// What the frame sees of a remembered scene; null: no scene is remembered.
  std::shared_ptr<const SeenScene> scene = nullptr;

  PlanePtr& operator[](Role role) { return planes[static_cast<size_t>(role)]; }
  const PlanePtr& operator[](Role role) const { return planes[static_cast<size_t>(role)]; }
  /// Any one of the planes, all on one device; null if there is none.
  PlanePtr any() const {
    for (const PlanePtr& plane : planes)
      if (plane) return plane;
    return nullptr;
  }
  /// Device memory of the planes, each counted once.
  size_t bytes() const {
    size_t bytes = 0;
    for (auto plane = planes.begin(); plane != planes.end(); ++plane)
      if (*plane && std::find(planes.begin(), plane, *plane) == plane)
        bytes += (*plane)->extent.pixels() * gpu::element_bytes(gpu::Element::vec4);
    return bytes;
  }
  /// Whether the light has a color and layers of its own.
  bool global() const { return (*this)[Role::light] && (*this)[Role::model_light]; }
  /// Whether the layers are diffuse and specular instead of reflectance and shading.
  bool material() const { return (*this)[Role::diffuse] && (*this)[Role::specular]; }
  /// Whether the layers are images under the two gradients of a light stage.
  bool gradients() const { return (*this)[Role::gradient_a] && (*this)[Role::gradient_b]; }
  /// Whether an editor has changed reflectance, shading or light.
  bool edited() const {
    return (*this)[Role::intrinsic] != (*this)[Role::model] ||
           (*this)[Role::light] != (*this)[Role::model_light];
  }
};

/// The layers of a frame separated into diffuse and specular light.
inline Layers material_layers(const PlanePtr& input, const PlanePtr& diffuse,
                              const PlanePtr& specular) {
  Layers layers{input->extent, {}};
  layers[Role::input] = input;
  layers[Role::diffuse] = diffuse;
  layers[Role::specular] = specular;
  return layers;
}

/// The layers of a pair of frames from a light stage.
inline Layers gradient_layers(const PlanePtr& a, const PlanePtr& b) {
  Layers layers{a->extent, {}};
  layers[Role::gradient_a] = a;
  layers[Role::gradient_b] = b;
  return layers;
}

/// The layers of a decomposed frame before any edit: `model` serves as `intrinsic`, too. `slope`
/// may be null.
inline Layers intrinsic_layers(const PlanePtr& input, const PlanePtr& intrinsic,
                               const PlanePtr& slope) {
  Layers layers{input->extent, {}};
  layers[Role::slope] = slope;
  layers[Role::input] = input;
  layers[Role::model] = intrinsic;
  layers[Role::intrinsic] = intrinsic;
  return layers;
}

}  // namespace inverse
