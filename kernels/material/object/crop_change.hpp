#pragma once
#include <cstdint>
#include <span>
#include <vector>

namespace inverse {

/// How much the picture of an object has changed since one that was kept. The mean over blocks of
/// points is what counts, so that a camera's noise does not, and a highlight that moves does.
class CropChange {
 public:
  static constexpr uint32_t kBlock = 8;  ///< points along a block's side

  /// The picture to compare with: side x side points of sRGB 0…1, row by row, four floats each, and
  /// which of them are on the object (`mask`, a byte each; empty: all are).
  void keep(std::span<const float> image, std::span<const uint8_t> mask, uint32_t side);
  void reset() { kept_.clear(); }
  bool kept() const { return !kept_.empty(); }

  /// Differences of means, in the channel that differs most, between blocks of this picture and of
  /// the kept one: the largest, which one highlight makes, and their mean, which lamps make. Of
  /// blocks that have at least an eighth of their points on the object. `moved`: points that are on
  /// it in one of the pictures alone, over those that it has. All 0 where none was kept.
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
