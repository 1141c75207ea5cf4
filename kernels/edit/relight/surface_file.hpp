// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <string>
#include <variant>

#include "depth_map.hpp"
#include "kernels/environment/normal_map.hpp"

namespace inverse {

/// Geometry of a still scene, read from a PNG of 8 or 16 bits a channel that covers the frame: gray
/// is depth (DepthMap), RGB are normals (NormalMap).
class SurfaceFile {
 public:
  explicit SurfaceFile(std::variant<DepthMap, NormalMap> map) : map_(std::move(map)) {}
  /// Throws Error(file) with the cause. `warning` is set if the normals look like something else.
  static SurfaceFile load(const std::string& path, std::string& warning);

  bool has_depth() const { return std::holds_alternative<DepthMap>(map_); }
  /// Median code of depth; 0 for normals.
  float median() const;
  /// Surface of each pixel of a frame. Where there is no normal, it faces the viewer; depth is then
  /// 0, as with all normals. The numbers are those of DepthMap::surface.
  std::vector<SurfacePixel> surface(Extent frame, float focal_length, float units) const;

 private:
  std::variant<DepthMap, NormalMap> map_;
};

}  // namespace inverse
