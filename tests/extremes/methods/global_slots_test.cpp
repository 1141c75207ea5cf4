// SPDX-License-Identifier: LGPL-2.1-or-later
// Base colors over time: each keeps its slot while its surface changes slowly, a new saturated
// object gets one, and gives it back when it is gone.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <optional>

#include "pictures.hpp"

namespace inverse::extremes {
namespace {

constexpr Extent kExtent{64, 48};
using Rgb = std::array<float, 3>;
using Slots = std::array<std::optional<Rgb>, kMaxBases>;

Slots slots_of(Solver solver, const Output& got, Method& method) {
  Slots slots;
  if (solver == Solver::global) {
    for (size_t k = 0; k < kMaxBases; ++k)
      if (got.bases[4 * k + 3] > 0)
        slots[k] = Rgb{got.bases[4 * k], got.bases[4 * k + 1], got.bases[4 * k + 2]};
  } else {
    for (const auto& color : method.global_thesis().colors().colors())
      slots[static_cast<size_t>(color.slot)] = color.initial;
  }
  return slots;
}

/// Distance of log chroma.
double apart(const Rgb& a, const Rgb& b) {
  double mean = 0, sum = 0;
  double d[3];
  for (size_t c = 0; c < 3; ++c) {
    d[c] = std::log(static_cast<double>(a[c]) + 0.01) - std::log(static_cast<double>(b[c]) + 0.01);
    mean += d[c] / 3;
  }
  for (const double v : d) sum += (v - mean) * (v - mean);
  return std::sqrt(sum);
}

std::optional<size_t> slot_near(const Slots& slots, const Rgb& color, double largest) {
  std::optional<size_t> best;
  for (size_t k = 0; k < slots.size(); ++k)
    if (slots[k] && apart(*slots[k], color) < largest) {
      best = k;
      largest = apart(*slots[k], color);
    }
  return best;
}

class BaseColorSlots : public testing::TestWithParam<Solver> {};

TEST_P(BaseColorSlots, AreStableOverSlowChangeAndFollowNewColors) {
  const Lab lab;
  const Solver solver = GetParam();
  Method method(lab, solver, kExtent);
  if (solver == Solver::global_thesis) {
    GlobalThesisParams params;
    params.steps = 1;  // colors do not depend on the solution
    params.keyframes = 0;
    params.refine_rounds = 0;
    method.set(params);
  }
  const Rgb kGuest{0.75F, 0.05F, 0.7F};
  constexpr unsigned kComes = 40, kGoes = 70;
  // The histograms: a fifth of each frame and modes of four thousandths of it; a tenth, and what
  // fades below a thousandth of a pixel.
  const unsigned fades = solver == Solver::global ? 20 : 120;
  const unsigned frames = kGoes + fades + 15;
  std::array<std::optional<size_t>, 4> own;
  std::optional<size_t> guest;
  unsigned came = 0, gone = 0;
  for (unsigned frame = 0; frame < frames; ++frame) {
    // Hues drift, light rises and falls, the walls' noise is another one each time.
    const float drift = 0.12F * std::sin(0.06F * static_cast<float>(frame));
    const std::vector<Rgb> paints{{0.8F, 0.12F + 0.2F * std::max(drift, 0.0F), 0.1F},
                                  {0.15F, 0.6F, 0.2F * (1 + drift)},
                                  {0.2F * (1 - drift), 0.3F, 0.9F},
                                  {0.7F, 0.68F, 0.65F}};
    Pixels picture = walls(kExtent, paints, 0.03F, frame,
                           0.7F + 0.2F * std::cos(0.1F * static_cast<float>(frame)));
    if (frame >= kComes && frame < kGoes)
      for (uint32_t y = 18; y < 34; ++y)
        for (uint32_t x = 0; x < 14; ++x)
          for (size_t c = 0; c < 3; ++c)
            picture[4 * (size_t{y} * kExtent.width + x + frame - kComes) + c] = 0.8F * kGuest[c];
    const Output got = method.decompose(picture);
    const Slots slots = slots_of(solver, got, method);
    if (frame == 1)
      for (size_t k = 0; k < own.size(); ++k) {
        own[k] = slot_near(slots, paints[k], 0.5);
        ASSERT_TRUE(own[k]) << "color " << k << " has no slot";
      }
    if (frame >= 1)
      for (size_t k = 0; k < own.size(); ++k) {
        ASSERT_TRUE(slots[*own[k]]) << "color " << k << " lost its slot in frame " << frame;
        ASSERT_LT(apart(*slots[*own[k]], paints[k]), 0.5) << "color " << k << ", frame " << frame;
      }
    const auto found = slot_near(slots, kGuest, 0.5);
    ASSERT_TRUE(frame >= kComes || !found) << frame;
    if (found && !came) came = frame, guest = found;
    ASSERT_TRUE(!found || frame >= kGoes || *found == *guest) << frame;
    if (frame >= kGoes && !found && !gone) gone = frame;
    ASSERT_TRUE(!gone || !found) << frame;
  }
  printf("  the new color had a slot after %u frames, and for %u more\n", came - kComes,
         gone - kGoes);
  ASSERT_GT(came, 0U) << "the new color got no slot";
  ASSERT_GT(gone, 0U) << "and it did not give it back";
  EXPECT_LE(came - kComes, 5U);
  EXPECT_LE(gone - kGoes, fades);
}

TEST(GlobalSlots, AReturningColorGetsItsSlot) {
  const Lab lab;
  Method method(lab, Solver::global, kExtent);
  const std::vector<Rgb> paints{
      {0.8F, 0.12F, 0.1F}, {0.15F, 0.6F, 0.2F}, {0.2F, 0.3F, 0.9F}, {0.7F, 0.68F, 0.65F}};
  const Rgb guest{0.75F, 0.05F, 0.7F}, other{0.8F, 0.75F, 0.04F};
  std::optional<size_t> own;
  unsigned others = 0;
  for (unsigned frame = 0; frame < 100; ++frame) {
    Pixels picture = walls(kExtent, paints, 0.03F, frame, 0.8F);
    const auto put = [&](const Rgb& color, uint32_t left) {
      for (uint32_t y = 18; y < 34; ++y)
        for (uint32_t x = left; x < left + 14; ++x)
          for (size_t c = 0; c < 3; ++c)
            picture[4 * (size_t{y} * kExtent.width + x) + c] = 0.8F * color[c];
    };
    if (frame >= 10 && (frame < 25 || frame >= 85)) put(guest, 20);
    if (frame >= 55 && frame < 80) put(other, 38);
    const Slots slots = slots_of(Solver::global, method.decompose(picture), method);
    const auto found = slot_near(slots, guest, 0.5), new_one = slot_near(slots, other, 0.4);
    if (frame == 20) own = found;
    if (frame > 20 && found) {
      ASSERT_EQ(*found, *own) << "frame " << frame;
    }
    if (new_one) {
      ASSERT_NE(*new_one, own.value_or(kMaxBases)) << "frame " << frame;
      ++others;
    }
    if (frame >= 90) {
      ASSERT_TRUE(found) << "frame " << frame;
    }
  }
  ASSERT_TRUE(own);
  EXPECT_GT(others, 15U);
}

INSTANTIATE_TEST_SUITE_P(All, BaseColorSlots, testing::ValuesIn(kGlobalSolvers), solver_name);

}  // namespace
}  // namespace inverse::extremes
