// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "kernels/environment/environment_fit.hpp"
#include "kernels/environment/normal_map.hpp"
#include "kernels/material/estimate/material.hpp"
#include "kernels/material/object/object_tracker.hpp"

namespace inverse {

/// Estimates the light around the object from the networks' inputs and outputs: combines their
/// images with the object's normals for EnvironmentFit. Runs on the host: a view has 128 x 128
/// points.
class ObjectLight {
 public:
  struct Params {
    EnvironmentFit::Params fit;
    bool inflate = true;  ///< normals from the object's outline if there is no normal map
  };
  /// Data of one frame, at side x side points of a square.
  struct View {
    std::span<const float> image;   ///< sRGB, four values per point
    std::span<const float> codes;   ///< codes of specular layer and mirror image, four values per
                                    ///< point
    std::span<const uint8_t> mask;  ///< not 0 on the object
    uint32_t side = 0;
    Square square;
    Extent frame;
  };

  /// Adds a frame. `map`, which may be null, has the normals of the whole frame. Ignored without
  /// normals.
  void add(const View& view, const std::shared_ptr<const NormalMap>& map, const Params& params);
  /// The light, given this material and all added frames; null if undetermined.
  std::shared_ptr<const Environment> light(const Material& material, const Params& params) const;
  void reset() { fit_.reset(); }
  /// As EnvironmentFit's.
  void shorten(uint64_t views) { fit_.shorten(views); }
  uint64_t views() const { return fit_.count(); }
  /// Whether the object of the last frame had no normals.
  bool lacks_normals() const { return lacks_normals_; }

 private:
  const std::vector<Normal>& normals(const View& view, const std::shared_ptr<const NormalMap>& map);

  EnvironmentFit fit_;
  // The last normals, and what they are of.
  std::vector<Normal> normals_;
  std::vector<uint8_t> mask_;
  Square square_;
  std::shared_ptr<const NormalMap> map_;
  bool lacks_normals_ = false;
};

}  // namespace inverse
