#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "stage/program/light_program.hpp"

namespace inverse {

/// The 512 slots of a DMX universe.
using DmxUniverse = std::array<uint8_t, 512>;

/// Where the lights of a program are in DMX universes, both ways. A level is linear in light:
/// round(255 x) of x, what is emitted. Gray lights take the mean of red, green and blue; of those
/// with white, white takes what red, green and blue have in common.
class DmxPatch {
 public:
  /// `first` is the number of the universe that channel 1 is in. Throws Error(unsupported) where
  /// lights have no channels, or universes beyond 63999.
  DmxPatch(const LightProgram& program, uint32_t first);

  /// Universes in which lights are, rising, and how many slots of each are in use.
  const std::map<uint32_t, uint32_t>& universes() const { return universes_; }
  /// The levels of all universes for these colors, one for each light. Slots of nobody are 0.
  std::map<uint32_t, DmxUniverse> levels(std::span<const LightColor> colors) const;
  /// What lights emit at these levels; black where a universe is missing.
  std::vector<LightColor> colors(const std::map<uint32_t, DmxUniverse>& levels) const;

 private:
  struct Slot {
    uint32_t universe, index;
  };
  std::vector<std::vector<Slot>> lights_;
  std::map<uint32_t, uint32_t> universes_;
};

}  // namespace inverse
