// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>

namespace inverse {

/// CIE 1931 chromaticities of red, green, blue and white.
struct Primaries {
  struct Chromaticity {
    double x, y;
    bool operator==(const Chromaticity&) const = default;
  };
  Chromaticity red, green, blue, white;
  bool operator==(const Primaries&) const = default;
  static constexpr Primaries bt709() {
    return {{0.64, 0.33}, {0.30, 0.60}, {0.15, 0.06}, {0.3127, 0.3290}};
  }
  static constexpr Primaries bt2020() {
    return {{0.708, 0.292}, {0.170, 0.797}, {0.131, 0.046}, {0.3127, 0.3290}};
  }
};

/// A 3 x 3 matrix on linear RGB, row by row.
struct Gamut {
  std::array<float, 9> matrix{1, 0, 0, 0, 1, 0, 0, 0, 1};
  bool operator==(const Gamut&) const = default;
  bool is_identity() const { return *this == Gamut{}; }
};

/// Linear RGB of primaries `from` as linear RGB of primaries `to` (SMPTE RP 177), white as white:
/// adapted by the Bradford transform where their whites differ. Colors outside `to` get negative
/// components. Chromaticities must span a triangle.
Gamut gamut_between(const Primaries& from, const Primaries& to);

}  // namespace inverse
