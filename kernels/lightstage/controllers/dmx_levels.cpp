// SPDX-License-Identifier: LGPL-2.1-or-later
#include "dmx_levels.hpp"

#include <algorithm>
#include <cmath>

#include "common/error.hpp"

namespace inverse {
namespace {

constexpr uint32_t kSlots = 512;
constexpr uint32_t kLastUniverse = 63999;

uint8_t level(float x) {
  return static_cast<uint8_t>(std::lround(255 * std::clamp(x >= 0 ? x : 0, 0.0F, 1.0F)));
}
float light(uint8_t level) { return static_cast<float>(level) / 255; }

}  // namespace

DmxPatch::DmxPatch(const LightProgram& program, uint32_t first) {
  for (size_t i = 0; i < program.lights.size(); ++i) {
    const auto& channels = program.lights[i].channels;
    if (channels.empty())
      throw Error(ErrorKind::unsupported,
                  "light " + std::to_string(i) + " of \"" + program.name +
                      "\" has no channels; give its lights \"channels\" to drive them by DMX");
    auto& slots = lights_.emplace_back();
    for (const uint32_t channel : channels) {
      const uint64_t universe = uint64_t{first} + (channel - 1) / kSlots;
      if (universe > kLastUniverse)
        throw Error(ErrorKind::unsupported, "light " + std::to_string(i) + " of \"" + program.name +
                                                "\": its channel would be in universe " +
                                                std::to_string(universe) + ", the last one is " +
                                                std::to_string(kLastUniverse));
      slots.push_back({static_cast<uint32_t>(universe), (channel - 1) % kSlots});
      uint32_t& used = universes_[slots.back().universe];
      used = std::max(used, slots.back().index + 1);
    }
  }
}

std::map<uint32_t, DmxUniverse> DmxPatch::levels(std::span<const LightColor> colors) const {
  std::map<uint32_t, DmxUniverse> result;
  for (const auto& [universe, used] : universes_) result[universe] = {};
  for (size_t i = 0; i < lights_.size() && i < colors.size(); ++i) {
    const auto& slots = lights_[i];
    const auto [r, g, b] = colors[i];
    const auto set = [&](size_t slot, float x) {
      result[slots[slot].universe][slots[slot].index] = level(x);
    };
    if (slots.size() == 1) {
      set(0, (r + g + b) / 3);
      continue;
    }
    const float white = slots.size() == 4 ? std::min({r, g, b}) : 0;
    set(0, r - white);
    set(1, g - white);
    set(2, b - white);
    if (slots.size() == 4) set(3, white);
  }
  return result;
}

std::vector<LightColor> DmxPatch::colors(const std::map<uint32_t, DmxUniverse>& levels) const {
  std::vector<LightColor> result;
  for (const auto& slots : lights_) {
    const auto get = [&](size_t slot) {
      const auto universe = levels.find(slots[slot].universe);
      return universe == levels.end() ? 0.0F : light(universe->second[slots[slot].index]);
    };
    if (slots.size() == 1) {
      result.push_back({get(0), get(0), get(0)});
      continue;
    }
    const float white = slots.size() == 4 ? get(3) : 0;
    result.push_back({get(0) + white, get(1) + white, get(2) + white});
  }
  return result;
}

}  // namespace inverse
