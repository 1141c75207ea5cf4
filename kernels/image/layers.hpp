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
  count
};

/// The layers of one frame; absent roles are null. Copying copies references, not pixels.
struct Layers {
  Extent extent;
  std::array<PlanePtr, static_cast<size_t>(Role::count)> planes;

  PlanePtr& operator[](Role role) { return planes[static_cast<size_t>(role)]; }
  const PlanePtr& operator[](Role role) const { return planes[static_cast<size_t>(role)]; }
};

/// The layers of a frame that was decomposed and not edited yet: the model is what it is made of.
inline Layers intrinsic_layers(const PlanePtr& input, const PlanePtr& intrinsic) {
  Layers layers{input->extent, {}};
  layers[Role::input] = input;
  layers[Role::model] = intrinsic;
  layers[Role::intrinsic] = intrinsic;
  return layers;
}

}  // namespace inverse
