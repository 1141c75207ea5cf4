// SPDX-License-Identifier: LGPL-2.1-or-later
// The image type of the double-precision references.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace inverse::reference {

using Vec3 = std::array<double, 3>;
using Vec4 = std::array<double, 4>;

inline double dot(const Vec3& a, const Vec3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// width × height pixels of four doubles, row by row without padding.
struct Plane {
  int width = 0;
  int height = 0;
  std::vector<Vec4> data;

  Plane() = default;
  Plane(int plane_width, int plane_height)
      : width(plane_width),
        height(plane_height),
        data(static_cast<std::size_t>(plane_width) * static_cast<std::size_t>(plane_height),
             Vec4{}) {}

  std::size_t size() const { return data.size(); }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  }
  Vec4& at(int x, int y) { return data[index(x, y)]; }
  const Vec4& at(int x, int y) const { return data[index(x, y)]; }
};

}  // namespace inverse::reference
