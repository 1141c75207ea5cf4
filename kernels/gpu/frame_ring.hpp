// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

namespace inverse::gpu {

/// How many frames an element may have in flight.
inline constexpr size_t kFramesInFlight = 3;

/// What belongs to a frame in flight, by the frame's number: a frame takes the place of that
/// kFramesInFlight before it.
template <typename T>
class FrameRing {
 public:
  T& operator[](uint64_t frame) { return slots_[frame % kFramesInFlight]; }
  const T& operator[](uint64_t frame) const { return slots_[frame % kFramesInFlight]; }
  static constexpr size_t size() { return kFramesInFlight; }
  auto begin() { return slots_.begin(); }
  auto end() { return slots_.end(); }
  auto begin() const { return slots_.begin(); }
  auto end() const { return slots_.end(); }

 private:
  std::array<T, kFramesInFlight> slots_{};
};

}  // namespace inverse::gpu
