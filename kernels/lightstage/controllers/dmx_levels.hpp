// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "kernels/lightstage/program/light_program.hpp"

namespace inverse {

/// The 512 slots of a DMX universe.
using DmxUniverse = std::array<uint8_t, 512>;

/// Maps the lights of a program to DMX slots and back. Levels are linear: round(255 x) for emitted
/// light x in 0…1. A gray light takes the mean of red, green and blue. On an RGBW light, white
/// takes min(r, g, b), and the other channels take the difference.
class DmxPatch {
 public:
  /// `first`: universe of channel 1. Throws Error(unsupported) if lights have no channels or need a
  /// universe above 63999.
  DmxPatch(const LightProgram& program, uint32_t first);

  /// Universes with lights, in rising order, and the number of slots in use of each.
  const std::map<uint32_t, uint32_t>& universes() const { return universes_; }
  /// Levels of all universes for one color per light. Unused slots are 0.
  std::map<uint32_t, DmxUniverse> levels(std::span<const LightColor> colors) const;
  /// Colors that the lights emit at these levels; black for lights of missing universes.
  std::vector<LightColor> colors(const std::map<uint32_t, DmxUniverse>& levels) const;

 private:
  struct Slot {
    uint32_t universe, index;
  };
  std::vector<std::vector<Slot>> lights_;
  std::map<uint32_t, uint32_t> universes_;
};

}  // namespace inverse
