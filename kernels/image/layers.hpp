#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "plane.hpp"

namespace inverse {

/// What a plane of a decomposed frame holds.
enum class Role : uint8_t {
  input,  ///< linear RGB of the frame, 1 = full scale; w = alpha
  model,  ///< R.rgb and S as the decomposer made them, before any edit: lets compose keep what R·S
          ///< does not explain
  intrinsic,  ///< reflectance R.rgb (may exceed 1) and shading S, edited along the chain; R·S ≈
              ///< input
  mask,       ///< x = matte 0…1 that the next editor may use
  model_light,  ///< light as the decomposer made it
  light,        ///< of frames with more than one bounce of light: rgb = the light's color, so that
          ///< R·S·rgb ≈ input (of mean or geometric mean 1 where nothing was edited), edited along
          ///< the chain; w = share of S that is direct, 0…1
  indirect,  ///< the first of kIndirectPlanes: shares of S that bounced off the surfaces of base
             ///< color 4n, 4n + 1, 4n + 2, 4n + 3; what they and the direct share do not explain
             ///< of light.rgb is a remainder without a layer of its own
  bases = indirect + 4,  ///< kMaxBases × 1: the color that light has after bouncing off surfaces of
                         ///< base color k (linear, largest channel 1, edited along the chain);
                         ///< w = 1, or 0 where there is no such color
  model_bases,  ///< bases as the decomposer made them
  lamp,  ///< 1 × 1: the color of direct light, linear, geometric mean 1; absent where it is white
  diffuse,     ///< of frames whose object's highlights were taken off: linear RGB without them;
               ///< w = mask of the object, 0…1
  specular,    ///< of the same frames: the highlights, linear RGB, so that diffuse + specular =
               ///< input; w = what the object would reflect if it were a mirror of its specular
               ///< albedo
  gradient_a,  ///< of pairs from a light stage: linear RGB under gradient A, 1 = full scale;
               ///< w = alpha
  gradient_b,  ///< the same under gradient B: A + B is the subject under all lights
  count
};

/// Base colors of a frame at most: a plane of Role::indirect holds four.
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

  PlanePtr& operator[](Role role) { return planes[static_cast<size_t>(role)]; }
  const PlanePtr& operator[](Role role) const { return planes[static_cast<size_t>(role)]; }
  /// One of them, all of which are on one device; null where there is none.
  PlanePtr any() const {
    for (const PlanePtr& plane : planes)
      if (plane) return plane;
    return nullptr;
  }
  /// Whether the light has color and layers of its own.
  bool global() const { return (*this)[Role::light] && (*this)[Role::model_light]; }
  /// Whether it is of highlights and what is under them, in place of reflectance and shading.
  bool material() const { return (*this)[Role::diffuse] && (*this)[Role::specular]; }
  /// Whether it is of a subject under the two gradients of a light stage.
  bool gradients() const { return (*this)[Role::gradient_a] && (*this)[Role::gradient_b]; }
  /// Whether an editor has been at reflectance, shading or light.
  bool edited() const {
    return (*this)[Role::intrinsic] != (*this)[Role::model] ||
           (*this)[Role::light] != (*this)[Role::model_light];
  }
};

/// The layers of a frame that was taken apart into highlights and the rest.
inline Layers material_layers(const PlanePtr& input, const PlanePtr& diffuse,
                              const PlanePtr& specular) {
  Layers layers{input->extent, {}};
  layers[Role::input] = input;
  layers[Role::diffuse] = diffuse;
  layers[Role::specular] = specular;
  return layers;
}

/// The layers of a pair of frames of a light stage.
inline Layers gradient_layers(const PlanePtr& a, const PlanePtr& b) {
  Layers layers{a->extent, {}};
  layers[Role::gradient_a] = a;
  layers[Role::gradient_b] = b;
  return layers;
}

/// The layers of a frame that was decomposed and not edited yet: the model is what it is made of.
inline Layers intrinsic_layers(const PlanePtr& input, const PlanePtr& intrinsic) {
  Layers layers{input->extent, {}};
  layers[Role::input] = input;
  layers[Role::model] = intrinsic;
  layers[Role::intrinsic] = intrinsic;
  return layers;
}

}  // namespace inverse
