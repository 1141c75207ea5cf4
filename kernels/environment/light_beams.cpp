// SPDX-License-Identifier: LGPL-2.1-or-later
#include "light_beams.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace inverse {
namespace {

constexpr double kBright = 3;               // times the mean radiance
constexpr double kSameLamp = 0.9063077870;  // cosine of 25 degrees

struct Cell {
  std::array<double, 3> direction{};
  double flux = 0, radiance = 0;
};

struct Sum {
  std::array<double, 3> moment{};
  double flux = 0;
  void add(const Cell& cell) {
    flux += cell.flux;
    for (size_t c = 0; c < 3; ++c) moment[c] += cell.flux * cell.direction[c];
  }
  LightBeam beam() const {
    LightBeam result{{}, static_cast<float>(flux)};
    for (size_t c = 0; c < 3; ++c) result.mean[c] = static_cast<float>(moment[c] / flux);
    return result;
  }
};

double cosine(const Cell& a, const Cell& b) {
  double dot = 0, aa = 0, bb = 0;
  for (size_t c = 0; c < 3; ++c) {
    dot += a.direction[c] * b.direction[c];
    aa += a.direction[c] * a.direction[c];
    bb += b.direction[c] * b.direction[c];
  }
  return dot / std::sqrt(std::max(aa * bb, 1e-30));
}

std::vector<Cell> cells_of(std::span<const PrefilteredLight::Vec4> table) {
  constexpr uint32_t kRows = PrefilteredLight::kCellRows, kColumns = 2 * kRows;
  std::vector<Cell> cells;
  for (size_t i = 0; i + 1 < table.size(); i += 2) {
    const auto row = static_cast<double>(i / 2 / kColumns);
    const auto polar = [](double at) { return std::cos(std::numbers::pi * at / kRows); };
    const double area = 2 * std::numbers::pi / kColumns * (polar(row) - polar(row + 1));
    const double flux = (double{table[i][0]} + double{table[i][1]} + double{table[i][2]}) / 3;
    cells.push_back({{double{table[i + 1][0]}, double{table[i + 1][1]}, double{table[i + 1][2]}},
                     flux,
                     flux / area});
  }
  return cells;
}

}  // namespace

LightBeams divided_light(std::span<const PrefilteredLight::Vec4> table) {
  std::vector<Cell> cells = cells_of(table);
  double total = 0;
  for (const Cell& cell : cells) total += cell.flux;
  const double bright = kBright * total / (4 * std::numbers::pi);
  LightBeams result;
  while (result.lamps < LightBeams::kMaxLamps) {
    const auto peak = std::ranges::max_element(cells, {}, &Cell::radiance);
    if (peak == cells.end() || !(peak->radiance > bright)) break;
    const Cell middle = *peak;
    Sum lamp;
    std::erase_if(cells, [&](const Cell& cell) {
      const bool in = cell.radiance > bright && cosine(cell, middle) > kSameLamp;
      if (in) lamp.add(cell);
      return in;
    });
    // A peak whose direction is unknown cannot be: it has light.
    if (!(lamp.flux > 0)) break;
    result.beams.push_back(lamp.beam());
    ++result.lamps;
  }
  std::array<Sum, 8> octants;
  for (const Cell& cell : cells) {
    const auto& d = cell.direction;
    octants[(d[0] > 0 ? 1U : 0U) + (d[1] > 0 ? 2U : 0U) + (d[2] > 0 ? 4U : 0U)].add(cell);
  }
  for (const Sum& octant : octants)
    if (octant.flux > 0) result.beams.push_back(octant.beam());
  return result;
}

}  // namespace inverse
