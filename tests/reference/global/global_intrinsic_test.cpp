// SPDX-License-Identifier: LGPL-2.1-or-later
// The gather-tint model on a frame whose light is known, and on frames that have no color to go by.
#include "global_intrinsic.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "global_layers.hpp"
#include "tests/reference/random.hpp"

namespace inverse::reference {
namespace {

using namespace global;

constexpr int kWidth = 96, kHeight = 72;

/// Colored patches under white light with a hard shadow, and indirect light as the model has it:
/// a share of the frame's own radiance, blurred (iterated to a fixed point).
struct Made {
  std::vector<double> image, reflectance, direct, indirect;
};

Made make_frame(double amount) {
  const std::size_t n = std::size_t(kWidth) * kHeight;
  Made m{std::vector<double>(3 * n), std::vector<double>(3 * n), std::vector<double>(n),
         std::vector<double>(3 * n, 0.0)};
  constexpr Vec3 kColors[] = {{.8, .15, .1}, {.75, .75, .75}, {.15, .65, .2}, {.7, .7, .7}};
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const std::size_t i = std::size_t(y) * kWidth + std::size_t(x);
      const Vec3& color = kColors[(x < 24 ? 0 : x >= 72 ? 2 : y < 50 ? 1 : 3)];
      for (std::size_t c = 0; c < 3; ++c) m.reflectance[3 * i + c] = color[c];
      m.direct[i] = (x + y > 90 && x + y < 120) ? 0 : 0.6 + 0.2 * y / kHeight;
    }
  for (int bounce = 0; bounce < 8; ++bounce) {
    for (std::size_t i = 0; i < 3 * n; ++i)
      m.image[i] = m.reflectance[i] * (m.direct[i / 3] + m.indirect[i]);
    const Grid grid = make_grid(m.image, std::vector<double>(n, 1.0), kWidth, kHeight, 2);
    const Gather gather(grid, std::vector<int>(grid.size(), 0), 1, {});
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        const Vec3 light = gather.received(0, x, y, 4);
        for (std::size_t c = 0; c < 3; ++c)
          m.indirect[3 * (std::size_t(y) * kWidth + std::size_t(x)) + c] = amount * light[c];
      }
  }
  return m;
}

/// Root mean square log chroma by which a light or reflectance differs from the truth.
double chroma_error(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); i += 3)
    sum += norm2(chroma_of({a[i], a[i + 1], a[i + 2]}) - chroma_of({b[i], b[i + 1], b[i + 2]}));
  return std::sqrt(3 * sum / double(a.size()));
}

std::vector<double> light_of(const std::vector<double>& direct,
                             const std::vector<double>& indirect) {
  std::vector<double> out = indirect;
  for (std::size_t i = 0; i < out.size(); ++i) out[i] += direct[i / 3];
  return out;
}

/// Every value finite, nothing negative, and the product the frame again.
void expect_sound(const std::vector<double>& image, const GlobalResult& r) {
  const Vec3 white = color_of(r.white);
  for (std::size_t i = 0; i < image.size(); ++i) {
    ASSERT_TRUE(std::isfinite(r.reflectance[i]) && std::isfinite(r.indirect[i]) &&
                std::isfinite(r.direct[i / 3]));
    ASSERT_GE(r.indirect[i], -1e-12);
    ASSERT_GE(r.direct[i / 3], 0);
    const double in = sanitize_linear(image[i]);
    ASSERT_NEAR(r.reflectance[i] * (r.direct[i / 3] + r.indirect[i]) * white[i % 3], in,
                1e-9 + 1e-9 * in);
  }
}

TEST(GlobalIntrinsic, FindsTheColorOfIndirectLight) {
  const Made made = make_frame(0.7);
  const GlobalResult r = decompose_global(made.image.data(), kWidth, kHeight, {}, nullptr);
  expect_sound(made.image, r);
  const std::vector<double> white(made.image.size(), 1.0);
  const auto truth = light_of(made.direct, made.indirect);
  EXPECT_LT(chroma_error(light_of(r.direct, r.indirect), truth), 0.11 * chroma_error(white, truth));
  EXPECT_LT(chroma_error(r.reflectance, made.reflectance),
            0.11 * chroma_error(made.image, made.reflectance));
  EXPECT_NEAR(std::log(r.amount.value / 0.7), 0, 0.05);
  EXPECT_GT(r.amount.confidence, 0.8);
}

TEST(GlobalIntrinsic, KeepsSlotsAndAmountOverTime) {
  const Made made = make_frame(0.7);
  GlobalState state;
  decompose_global(made.image.data(), kWidth, kHeight, {}, &state);
  const GlobalResult first = decompose_global(made.image.data(), kWidth, kHeight, {}, &state);
  GlobalResult last;
  for (int k = 0; k < 4; ++k)
    last = decompose_global(made.image.data(), kWidth, kHeight, {}, &state);
  EXPECT_NEAR(last.amount.value, first.amount.value, 0.09);
  for (std::size_t s = 0; s < last.colors.color.size(); ++s) {
    ASSERT_EQ(first.colors.color[s].has_value(), last.colors.color[s].has_value()) << s;
    if (!first.colors.color[s]) continue;
    EXPECT_LT(norm2(*first.colors.color[s] - *last.colors.color[s]), 0.031 * 0.031);
  }
}

TEST(GlobalIntrinsic, RestartsAtACut) {
  const Made made = make_frame(0.7);
  std::vector<double> other = made.image;  // channels exchanged: nothing is the color that it was
  for (std::size_t i = 0; i < other.size(); i += 3) std::swap(other[i], other[i + 2]);
  for (std::size_t i = 0; i < other.size(); i += 3) std::swap(other[i + 1], other[i + 2]);
  GlobalState state;
  decompose_global(other.data(), kWidth, kHeight, {}, &state);
  EXPECT_FALSE(decompose_global(other.data(), kWidth, kHeight, {}, &state).cut);
  const GlobalResult after = decompose_global(made.image.data(), kWidth, kHeight, {}, &state);
  EXPECT_TRUE(after.cut);
  const GlobalResult fresh = decompose_global(made.image.data(), kWidth, kHeight, {}, nullptr);
  EXPECT_EQ(after.amount.value, fresh.amount.value);
  EXPECT_EQ(after.label, fresh.label);
}

TEST(GlobalIntrinsic, TakesTheAmountThatItIsGiven) {
  const Made made = make_frame(0.7);
  const GlobalParams params{.amount = {.manual = 0.25}};
  const GlobalResult r = decompose_global(made.image.data(), kWidth, kHeight, params, nullptr);
  EXPECT_EQ(r.amount.value, 0.25);
}

TEST(GlobalIntrinsic, TakesOutAColoredIlluminant) {
  Made made = make_frame(0.7);
  for (std::size_t i = 0; i < made.image.size(); ++i) made.image[i] *= Vec3{1, .85, .6}[i % 3];
  const GlobalParams params{.white_balance = 0.8};
  const GlobalResult with = decompose_global(made.image.data(), kWidth, kHeight, params, nullptr);
  expect_sound(made.image, with);
  const GlobalResult without = decompose_global(made.image.data(), kWidth, kHeight, {}, nullptr);
  EXPECT_LT(chroma_error(with.reflectance, made.reflectance),
            0.8 * chroma_error(without.reflectance, made.reflectance));
}

TEST(GlobalIntrinsic, IsSoundOnAnything) {
  const struct {
    int width, height;
    const char* what;
    double (*value)(std::size_t);
  } frames[] = {
      {kWidth, kHeight, "black", [](std::size_t) { return 0.0; }},
      {kWidth, kHeight, "white", [](std::size_t) { return 1.0; }},
      {kWidth, kHeight, "green", [](std::size_t i) { return i % 3 == 1 ? 0.7 : 0.05; }},
      {kWidth, kHeight, "noise", [](std::size_t i) { return double(i * 2654435761U % 997) / 997; }},
      {kWidth, kHeight, "broken",
       [](std::size_t i) {
         return i % 7 == 0   ? std::numeric_limits<double>::quiet_NaN()
                : i % 7 == 1 ? std::numeric_limits<double>::infinity()
                : i % 7 == 2 ? -1.0
                             : 0.3;
       }},
      {1, 1, "one pixel", [](std::size_t) { return 0.4; }},
      {17, 3, "narrow", [](std::size_t i) { return double(i % 5) / 5; }},
      {61, 37, "odd", [](std::size_t i) { return double(i % 11) / 11; }}};
  for (const auto& f : frames) {
    SCOPED_TRACE(f.what);
    std::vector<double> image(3 * std::size_t(f.width) * std::size_t(f.height));
    for (std::size_t i = 0; i < image.size(); ++i) image[i] = f.value(i);
    GlobalState state;
    const GlobalParams params{.white_balance = 1};
    for (int k = 0; k < 3; ++k) {
      const GlobalResult r = decompose_global(image.data(), f.width, f.height, params, &state);
      expect_sound(image, r);
      const IndirectLayers layers = split_indirect(r, f.width, f.height);
      for (const auto& layer : layers.amount)
        for (const double t : layer) ASSERT_TRUE(std::isfinite(t) && t >= 0);
    }
  }
}

TEST(GlobalIntrinsic, GrayFramesHaveGrayLight) {
  std::vector<double> image(3 * std::size_t(kWidth) * kHeight);
  for (std::size_t i = 0; i < image.size(); ++i)
    image[i] = 0.2 + 0.5 * double(i / 3 % kWidth) / kWidth;
  const GlobalResult r = decompose_global(image.data(), kWidth, kHeight, {}, nullptr);
  for (std::size_t i = 0; i < image.size(); i += 3) {
    EXPECT_NEAR(r.indirect[i], r.indirect[i + 1], 1e-6);
    EXPECT_NEAR(r.indirect[i], r.indirect[i + 2], 1e-6);
  }
}

TEST(GlobalIntrinsic, LayersAddUpAndCarryARecoloring) {
  const Made made = make_frame(0.7);
  GlobalState state;
  decompose_global(made.image.data(), kWidth, kHeight, {}, &state);
  const GlobalResult r = decompose_global(made.image.data(), kWidth, kHeight, {}, &state);
  const IndirectLayers layers = split_indirect(r, kWidth, kHeight);
  double rest = 0, all = 0;
  for (std::size_t i = 0; i < r.indirect.size(); ++i) {
    double sum = layers.remainder[i];
    for (std::size_t k = 0; k < layers.base.size(); ++k)
      sum += layers.base[k][i % 3] * layers.amount[k][i / 3];
    ASSERT_NEAR(sum, r.indirect[i], 1e-9);
    rest += layers.remainder[i] * layers.remainder[i];
    all += r.indirect[i] * r.indirect[i];
  }
  EXPECT_LT(std::sqrt(rest / all), 0.25);
  // The red wall, turned blue, throws blue light: its neighborhood loses red and wins blue.
  const auto red = std::size_t(r.label[std::size_t(36 * kWidth + 5)]);
  const Recolored blue =
      recolor(r, layers, red, {layers.base[red][2], layers.base[red][1], layers.base[red][0]});
  const std::size_t near = 3 * std::size_t(36 * kWidth + 28);
  EXPECT_LT(blue.indirect[near], r.indirect[near]);
  EXPECT_GT(blue.indirect[near + 2], r.indirect[near + 2]);
  EXPECT_GT(blue.reflectance[3 * std::size_t(36 * kWidth + 5) + 2],
            blue.reflectance[3 * std::size_t(36 * kWidth + 5)]);
}

TEST(GlobalPalette, SlotsSurviveNewcomersAndLosses) {
  ChromaHistogram h(64, 0.08);
  h.add({0, 0}, 10), h.add({1, 0}, 5), h.add({0, 1}, 3);
  const PaletteParams params;
  const BaseColors first = find_modes(h, {}, params);
  ASSERT_EQ(first.used(), 3);
  const int red = first.label[h.nearest({1, 0})];
  h = ChromaHistogram(64, 0.08);
  h.add({1.05, 0}, 10), h.add({-1, -1}, 8), h.add({0, 1}, 3);
  const BaseColors second = find_modes(h, first, params);
  EXPECT_EQ(second.used(), 3);
  EXPECT_EQ(second.label[h.nearest({1.05, 0})], red);
  EXPECT_EQ(second.label[h.nearest({0, 1})], first.label[h.nearest({0, 1})]);
}

TEST(GlobalPalette, AColorStaysWhereAnothersBasinTookItsMode) {
  const PaletteParams params;
  const auto make = [](double wall) {  // red on the slope of a wall, more or less of it
    ChromaHistogram h(64, 0.08);
    h.add({0, 0}, 10), h.add({-1, 1}, 5);
    for (int k = 1; k < 12; ++k) h.add({0.08 * k, 0}, wall * (12 - k));
    h.add({0.4, 0}, 0.3);
    return h;
  };
  BaseColors colors = find_modes(make(0), {}, params);
  ASSERT_EQ(colors.used(), 3);
  const ChromaHistogram merged = make(0.08);
  const std::size_t at = merged.nearest({0.4, 0});
  const int red = colors.label[at];
  ASSERT_EQ(find_modes(merged, {}, params).used(), 2) << "the wall has to hide the mode";
  for (int frame = 1; frame <= params.keep; ++frame) {
    colors = find_modes(merged, colors, params);
    EXPECT_EQ(colors.label[at], red) << frame;
    EXPECT_NE(colors.label[merged.nearest({0, 0})], red) << frame;
  }
  colors = find_modes(merged, colors, params);
  EXPECT_NE(colors.label[at], red) << "it stays for good";
  EXPECT_EQ(find_modes(make(0), colors, params).label[at], red) << "and finds its slot again";
}

TEST(GlobalPalette, ASlotIsAnothersOnlyAfterLong) {
  PaletteParams params;
  params.most = 3;
  const auto make = [](bool guest, bool other) {
    ChromaHistogram h(64, 0.08);
    h.add({0, 0}, 10), h.add({1, 0}, 5);
    if (guest) h.add({0, 1}, 2);
    if (other) h.add({-1, 0}, 2);
    return h;
  };
  const BaseColors before = find_modes(make(true, false), {}, params);
  const int guest = before.label[make(true, false).nearest({0, 1})];
  BaseColors away = before;
  for (int frame = 1; frame < params.forget; ++frame)
    away = find_modes(make(false, false), away, params);
  EXPECT_EQ(away.used(), 2);
  EXPECT_TRUE(away.memory[std::size_t(guest)]);
  // Where there is no other slot it goes to what comes, else not before it is forgotten.
  const std::size_t place = make(false, true).nearest({-1, 0});
  EXPECT_EQ(find_modes(make(false, true), away, params).label[place], guest);
  params.most = 4;
  EXPECT_NE(find_modes(make(false, true), away, params).label[place], guest);
  for (int frame = 0; frame < 2; ++frame) away = find_modes(make(false, false), away, params);
  EXPECT_FALSE(away.memory[std::size_t(guest)]);
}

TEST(GlobalAmount, HasNoConfidenceWithoutColors) {
  const AmountParams params;
  const Amount blind = amount_of({}, 1, params);
  EXPECT_NEAR(blind.value, params.typical_amount, 0.1);
  EXPECT_NEAR(blind.confidence, 0, 1e-9);
  AmountCost sharp{};
  sharp.fill(5);
  sharp[10] = 0;
  const Amount sure = amount_of(sharp, 1, params);
  EXPECT_NEAR(sure.value, candidate(10), 1e-3);
  EXPECT_GT(sure.confidence, 0.99);
}

TEST(GlobalAmount, MutedColorsLowerTheConfidence) {
  const AmountParams params;
  AmountCost cost{};
  for (int i = 0; i < kCandidates; ++i) cost[std::size_t(i)] = 0.05 * std::abs(i - 13);
  const Amount vivid = amount_of(cost, params.full_spread, params),
               muted = amount_of(cost, 0.2 * params.full_spread, params);
  EXPECT_EQ(vivid.value, amount_of(cost, 1, params).value);
  AmountParams less = params;
  less.measurement_weight *= 0.2;
  EXPECT_NEAR(muted.value, amount_of(cost, 1, less).value, 1e-12);
  EXPECT_LT(muted.value, vivid.value);
  EXPECT_LT(muted.confidence, vivid.confidence);
  EXPECT_EQ(muted.color, vivid.color);
}

}  // namespace
}  // namespace inverse::reference
