// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstdint>
#include <span>
#include <vector>

namespace inverse {

/// Change of an object's image relative to a stored one. Compares means over blocks of points,
/// which averages camera noise but shows moving highlights.
class CropChange {
 public:
  static constexpr uint32_t kBlock = 8;  ///< points along a block's side

  /// Stores the reference image: side x side points of sRGB 0…1, row by row, four floats each, and
  /// the object's `mask`, one byte per point (empty: all points).
  void keep(std::span<const float> image, std::span<const uint8_t> mask, uint32_t side);
  void reset() { kept_.clear(); }
  bool kept() const { return !kept_.empty(); }

  /// Differences of block means (largest channel) between this image and the reference: their
  /// maximum, which a single highlight raises, and their mean, which lamps raise. Only blocks with
  /// at least an eighth of their points on the object. `moved`: points on the object in only one of
  /// the images, relative to the object. All 0 without a reference.
  struct Difference {
    float largest = 0, mean = 0, moved = 0;
  };
  Difference since(std::span<const float> image, std::span<const uint8_t> mask,
                   uint32_t side) const;

 private:
  std::vector<float> kept_;
  std::vector<uint8_t> kept_mask_;
};

}  // namespace inverse
