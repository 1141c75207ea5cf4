// SPDX-License-Identifier: LGPL-2.1-or-later
// Random numbers of one sample: a function of (seed, index, stream) alone, so that sample i of seed
// k is always the same, whichever thread draws it and whatever was drawn before.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

namespace inverse::lime {

/// splitmix64 (Steele, Lea and Flood 2014), started at a hash of the sample's name.
class Random {
 public:
  Random(std::uint64_t seed, std::uint64_t index, std::uint64_t stream)
      : state_(mix(mix(mix(seed) + index) + stream)) {}

  std::uint64_t bits() { return mix(state_ += kStep); }
  /// In [0, 1).
  float uniform() { return float(bits() >> 40) * 0x1p-24f; }
  float uniform(float low, float high) { return low + (high - low) * uniform(); }
  /// Logarithmically uniform, both bounds positive.
  float log_uniform(float low, float high) {
    return std::exp(uniform(std::log(low), std::log(high)));
  }
  /// One of 0 … count − 1.
  int below(int count) { return int((bits() >> 32) * std::uint64_t(count) >> 32); }
  bool chance(float p) { return uniform() < p; }
  float sign() { return chance(0.5f) ? 1.f : -1.f; }
  /// Standard normal (Box and Muller; the second number is not kept).
  float normal() {
    const float radius = std::sqrt(-2 * std::log(1 - uniform()));
    return radius * std::cos(6.2831853f * uniform());
  }
  /// Nearly standard normal: the sum of four 16-bit uniforms, of bounded tails; cheap enough for
  /// every pixel.
  float rough_normal() {
    const std::uint64_t b = bits();
    const int sum = int(b & 0xffff) + int(b >> 16 & 0xffff) + int(b >> 32 & 0xffff) + int(b >> 48);
    return float(sum - 131070) * (1.7320508f / 65536);
  }
  /// A uniformly distributed rotation, as a quaternion.
  std::array<float, 4> quaternion() { return {normal(), normal(), normal(), normal()}; }

 private:
  static constexpr std::uint64_t kStep = 0x9e3779b97f4a7c15u;
  static std::uint64_t mix(std::uint64_t z) {
    z += kStep;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return z ^ z >> 31;
  }
  std::uint64_t state_;
};

}  // namespace inverse::lime
