// SPDX-License-Identifier: LGPL-2.1-or-later
#include "primaries.hpp"

#include <cstddef>

namespace inverse {
namespace {

using Vector = std::array<double, 3>;
using Matrix3 = std::array<Vector, 3>;

Vector operator*(const Matrix3& m, const Vector& v) {
  Vector result{};
  for (size_t i = 0; i < 3; ++i)
    for (size_t j = 0; j < 3; ++j) result[i] += m[i][j] * v[j];
  return result;
}

Matrix3 operator*(const Matrix3& a, const Matrix3& b) {
  Matrix3 result{};
  for (size_t i = 0; i < 3; ++i)
    for (size_t j = 0; j < 3; ++j)
      for (size_t k = 0; k < 3; ++k) result[i][j] += a[i][k] * b[k][j];
  return result;
}

Matrix3 diagonal(const Vector& v) { return {{{v[0], 0, 0}, {0, v[1], 0}, {0, 0, v[2]}}}; }

Matrix3 inverse_of(const Matrix3& m) {
  Matrix3 result;
  const auto minor = [&](size_t i, size_t j) {
    const size_t a = (i + 1) % 3, b = (i + 2) % 3, c = (j + 1) % 3, d = (j + 2) % 3;
    return m[a][c] * m[b][d] - m[a][d] * m[b][c];
  };
  const double determinant = m[0][0] * minor(0, 0) + m[0][1] * minor(0, 1) + m[0][2] * minor(0, 2);
  for (size_t i = 0; i < 3; ++i)
    for (size_t j = 0; j < 3; ++j) result[j][i] = minor(i, j) / determinant;
  return result;
}

/// XYZ of a chromaticity with Y = 1.
Vector xyz(const Primaries::Chromaticity& c) { return {c.x / c.y, 1, (1 - c.x - c.y) / c.y}; }

/// Linear RGB to XYZ, white with Y = 1.
Matrix3 to_xyz(const Primaries& p) {
  const Vector r = xyz(p.red), g = xyz(p.green), b = xyz(p.blue);
  const Matrix3 columns{{{r[0], g[0], b[0]}, {r[1], g[1], b[1]}, {r[2], g[2], b[2]}}};
  return columns * diagonal(inverse_of(columns) * xyz(p.white));
}

/// Bradford's matrix from XYZ to the responses of cones.
constexpr Matrix3 kCones{
    {{0.8951, 0.2664, -0.1614}, {-0.7502, 1.7135, 0.0367}, {0.0389, -0.0685, 1.0296}}};

Matrix3 adapted(const Primaries& from, const Primaries& to) {
  const Vector a = kCones * xyz(from.white), b = kCones * xyz(to.white);
  return inverse_of(kCones) * diagonal({b[0] / a[0], b[1] / a[1], b[2] / a[2]}) * kCones;
}

}  // namespace

Gamut gamut_between(const Primaries& from, const Primaries& to) {
  if (from == to) return {};
  const Matrix3 product = inverse_of(to_xyz(to)) * adapted(from, to) * to_xyz(from);
  Gamut gamut;
  for (size_t i = 0; i < 9; ++i) gamut.matrix[i] = static_cast<float>(product[i / 3][i % 3]);
  return gamut;
}

}  // namespace inverse
