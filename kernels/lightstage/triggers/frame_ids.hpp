// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstdint>
#include <optional>

namespace inverse {

/// Follows the frame ids of a camera. With 16 bits they wrap from 65535 to 1, and 0 is invalid
/// (GigE Vision 1.x). If a camera sends 0 nevertheless, its ids wrap to 0.
class FrameIds {
 public:
  explicit FrameIds(uint32_t bits) : bits_(bits) {}

  /// Exposures between the last accepted id and `id`: 1 for the next one, 0 or less for a repeated
  /// or late one. Empty before the first `accept`.
  std::optional<int64_t> after_last(uint64_t id) const {
    if (!known_) return std::nullopt;
    const uint64_t mask = bits_ >= 64 ? ~uint64_t{0} : (uint64_t{1} << bits_) - 1;
    const uint64_t ahead = (id - last_) & mask, behind = (last_ - id) & mask;
    const bool zero = !skips_zero_ || id == 0;
    if (ahead <= behind) return static_cast<int64_t>(ahead - (!zero && id < last_ ? 1 : 0));
    return -static_cast<int64_t>(behind - (!zero && id > last_ ? 1 : 0));
  }
  void accept(uint64_t id) {
    if (id == 0) skips_zero_ = false;
    last_ = id;
    known_ = true;
  }
  /// Accepts the next id; returns the number of ids missing before it.
  uint64_t missed_before(uint64_t id) {
    const int64_t step = after_last(id).value_or(1);
    accept(id);
    return step > 1 ? static_cast<uint64_t>(step - 1) : 0;
  }
  std::optional<uint64_t> last() const { return known_ ? std::optional(last_) : std::nullopt; }

 private:
  uint32_t bits_ = 16;
  bool skips_zero_ = bits_ < 64;
  bool known_ = false;
  uint64_t last_ = 0;
};

}  // namespace inverse
