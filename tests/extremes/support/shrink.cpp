// SPDX-License-Identifier: LGPL-2.1-or-later
#include "shrink.hpp"

#include <algorithm>
#include <cstdio>
#include <stdexcept>

#include "inputs.hpp"
#include "tests/reference/random.hpp"

namespace inverse::extremes {

std::string Case::text() const {
  char text[128];
  snprintf(text, sizeof text, "%s %ux%u frames=%u seed=%u faults=0x%x knobs=0x%x", name_of(solver),
           width, height, frames, seed, faults, knobs);
  return text;
}

Case parse_case(const std::string& text) {
  Case one;
  char solver[32] = "";
  if (sscanf(text.c_str(), "%31s %ux%u frames=%u seed=%u faults=0x%x knobs=0x%x", solver,
             &one.width, &one.height, &one.frames, &one.seed, &one.faults, &one.knobs) == 7 &&
      one.width > 0 && one.height > 0 && one.frames > 0)
    for (const Solver kind : kSolvers)
      if (name_of(kind) == std::string(solver)) {
        one.solver = kind;
        return one;
      }
  throw std::invalid_argument("not a case: " + text);
}

Case random_case(Solver solver, uint32_t seed, uint32_t largest) {
  const auto a = reference::pcg3d(seed, static_cast<uint32_t>(solver), 0);
  const auto b = reference::pcg3d(seed, static_cast<uint32_t>(solver), 1);
  Case one{solver};
  one.seed = seed;
  one.width = 1 + reference::random_below(a[0], largest);
  one.height = 1 + reference::random_below(a[1], largest);
  if (seed % 4 == 1) one.width = 1 + one.width % 3;    // a needle
  if (seed % 4 == 2) one.height = 1 + one.height % 3;  // and one that lies
  one.frames = 1 + reference::random_below(a[2], 4);
  // Each with one chance in three.
  for (uint32_t bit = 0; bit < faults_for(solver); ++bit)
    if (reference::random_below(reference::pcg3d(seed, bit, 2)[0], 3) == 0) one.faults |= 1U << bit;
  if (seed % 3 == 0)
    for (uint32_t bit = 0; bit < kKnobs; ++bit)
      if (reference::random_below(b[0] ^ reference::pcg3d(seed, bit, 3)[1], 3) == 0)
        one.knobs |= 1U << bit;
  return one;
}

Shrunk shrink(const Case& failing, const std::string& reason, const Check& check, int most) {
  Shrunk result{failing, reason, 0};
  const auto fails = [&](const Case& smaller) {
    if (smaller == result.smallest || result.runs >= most) return false;
    ++result.runs;
    const auto why = check(smaller);
    if (!why) return false;
    result.smallest = smaller;
    result.reason = *why;
    return true;
  };
  for (bool moved = true; moved && result.runs < most;) {
    moved = false;
    const auto attempt = [&](auto change) {
      Case smaller = result.smallest;
      change(smaller);
      moved = fails(smaller) || moved;
    };
    attempt([](Case& c) { c.frames = 1; });
    attempt([](Case& c) { c.frames = std::max(c.frames - 1, 1U); });
    for (const uint32_t parts : {2U, 1U}) {  // half, or one pixel less
      const auto less = [&](uint32_t side) { return parts == 2 ? (side + 1) / 2 : side - 1; };
      attempt([&](Case& c) { c.width = std::max(less(c.width), 1U); });
      attempt([&](Case& c) { c.height = std::max(less(c.height), 1U); });
    }
    for (uint32_t bit = 0; bit < 32; ++bit) {
      attempt([&](Case& c) { c.faults &= ~(1U << bit); });
      attempt([&](Case& c) { c.knobs &= ~(1U << bit); });
    }
    if (!moved) attempt([](Case& c) { c.seed = 1; });
  }
  return result;
}

std::optional<std::string> first_failure(Solver solver, uint32_t first, uint32_t count,
                                         uint32_t largest, const Check& check) {
  for (uint32_t seed = first; seed < first + count; ++seed) {
    const Case one = random_case(solver, seed, largest);
    const auto reason = check(one);
    if (!reason) continue;
    const Shrunk small = shrink(one, *reason, check);
    return one.text() + ": " + *reason + "\n  shrunk in " + std::to_string(small.runs) +
           " runs to\n  extremes --case \"" + small.smallest.text() + "\"\n  " + small.reason;
  }
  return {};
}

}  // namespace inverse::extremes
