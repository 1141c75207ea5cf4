// SPDX-License-Identifier: LGPL-2.1-or-later
// Smooth random textures.
#pragma once

#include <vector>

#include "random.hpp"

namespace inverse::lime {

/// Octaves of bilinearly interpolated random lattices, values about 0 … 1 around 0.5; wraps with
/// period `cells` in x and y.
class Noise {
 public:
  Noise(Random& random, int cells, int octaves) : cells_(cells), octaves_(octaves) {
    for (int i = 0; i < kTable; ++i) table_.push_back(random.uniform());
  }
  /// x and y in lattice cells of the first octave.
  float operator()(float x, float y) const {
    float sum = 0, size = 1, total = 0;
    int period = cells_;
    for (int octave = 0; octave < octaves_; ++octave) {
      sum += size * lattice(x, y, period, octave);
      total += size;
      x *= 2;
      y *= 2;
      period *= 2;
      size *= 0.5f;
    }
    return sum / total;
  }

 private:
  static constexpr int kTable = 1024;
  float lattice(float x, float y, int period, int octave) const {
    const float fx = std::floor(x), fy = std::floor(y), u = x - fx, v = y - fy;
    const auto wrap = [&](int i) { return ((i % period) + period) % period; };
    const int x0 = wrap(int(fx)), x1 = wrap(int(fx) + 1), y0 = wrap(int(fy)),
              y1 = wrap(int(fy) + 1);
    const auto at = [&](int i, int j) {
      return table_[std::size_t((i * 73 + j * 157 + octave * 311 + i * j * 31) & (kTable - 1))];
    };
    return (1 - v) * ((1 - u) * at(x0, y0) + u * at(x1, y0)) +
           v * ((1 - u) * at(x0, y1) + u * at(x1, y1));
  }
  int cells_, octaves_;
  std::vector<float> table_;
};

}  // namespace inverse::lime
