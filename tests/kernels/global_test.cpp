// globalintrinsic on the device against its specification.
#include <cmath>

#include "global/global_intrinsic.hpp"
#include "intrinsic_fixture.hpp"
#include "tests/reference/global_layers.hpp"

namespace inverse::testing {
namespace {

/// A red wall on the left, a green one on the right, gray, white and yellow patches between, direct
/// light from above that a shadow cuts, and light that bounced off the walls.
struct Room {
  Pixels frame;
  std::vector<double> reflectance, direct, indirect;  // 3, 1, 3 channels
};

Room room(Extent extent, unsigned seed, float bounced = 0.35F) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0, 1);
  const std::array<std::array<float, 3>, 5> paints{{{0.75F, 0.12F, 0.1F},
                                                    {0.15F, 0.6F, 0.15F},
                                                    {0.7F, 0.7F, 0.7F},
                                                    {0.3F, 0.3F, 0.3F},
                                                    {0.7F, 0.6F, 0.1F}}};
  Room made;
  made.frame.assign(extent.pixels() * 4, 1);
  for (uint32_t y = 0; y < extent.height; ++y)
    for (uint32_t x = 0; x < extent.width; ++x) {
      const float u = (static_cast<float>(x) + 0.5F) / static_cast<float>(extent.width),
                  v = (static_cast<float>(y) + 0.5F) / static_cast<float>(extent.height);
      const bool left = u<0.25F, right = u> 0.75F;
      const size_t patch = static_cast<size_t>(u * 12) + 3 * static_cast<size_t>(v * 5);
      const auto& paint = paints[left ? 0 : right ? 1 : 2 + patch % 3];
      const float shadow = v > 0.5F && u > 0.4F && u < 0.65F ? 0.05F : 1.0F;
      const float direct = shadow * (0.6F - 0.3F * v);
      // A wall does not light itself.
      const float from_red = left ? 0.05F : bounced * 0.6F * std::exp(-3 * (u - 0.25F));
      const float from_green = right ? 0.05F : bounced * 0.6F * std::exp(-3 * (0.75F - u));
      for (size_t c = 0; c < 3; ++c) {
        const float indirect = 0.25F * bounced + (left ? 0 : from_red * paints[0][c]) +
                               (right ? 0 : from_green * paints[1][c]);
        const float light = direct + indirect;
        made.reflectance.push_back(paint[c]);
        made.indirect.push_back(indirect);
        made.frame[4 * (static_cast<size_t>(y) * extent.width + x) + c] =
            paint[c] * light * (0.99F + 0.02F * unit(random));
      }
      made.direct.push_back(direct);
    }
  return made;
}

}  // namespace

class GlobalTest : public IntrinsicTest {
 protected:
  struct Result {
    Layers layers;
    Pixels intrinsic, light;
    GlobalIntrinsic::Findings found;
  };
  Result decompose(GlobalIntrinsic& method, const Pixels& frame, Extent extent,
                   const GlobalIntrinsic::Params& params, GlobalIntrinsic::FrameInfo info) {
    Result result;
    run([&](gpu::Commands& commands) {
      result.layers = method.record(commands, input(extent, frame), params, info);
    });
    result.intrinsic = download(result.layers[Role::intrinsic]->buffer);
    result.light = download(result.layers[Role::light]->buffer);
    result.found = method.findings(method.recorded() - 1);
    return result;
  }
  static GlobalIntrinsic::Params to_the_letter() {
    GlobalIntrinsic::Params params;
    params.adaptive = false;

    return params;
  }
  /// Light's color and direct share, base colors and reflectance against the specification.
  static void expect_agreement(const Result& got, const reference::GlobalResult& expected,
                               const std::string& what) {
    EXPECT_NEAR(got.found.amount, expected.amount.value, 2e-3 * expected.amount.value) << what;
    EXPECT_NEAR(got.found.confidence, expected.amount.confidence, 5e-3) << what;
    EXPECT_EQ(got.found.colors, uint32_t(expected.colors.used())) << what;
    EXPECT_NEAR(got.found.tint, expected.tint, 2e-3 + 2e-3 * expected.tint) << what;
    const size_t n = expected.direct.size();
    double tint2 = 0, direct2 = 0, paint2 = 0;
    for (size_t i = 0; i < n; ++i) {
      double geometric = 0;
      for (size_t c = 0; c < 3; ++c)
        geometric += std::log(expected.direct[i] + expected.indirect[3 * i + c]) / 3;
      for (size_t c = 0; c < 3; ++c) {
        const double tau = std::log(expected.direct[i] + expected.indirect[3 * i + c]) - geometric;
        tint2 += std::pow(std::log(got.light[4 * i + c]) - tau, 2) / double(3 * n);
        paint2 += std::pow(std::log(got.intrinsic[4 * i + c] + 1e-3) -
                               std::log(expected.reflectance[3 * i + c] + 1e-3),
                           2) /
                  double(3 * n);
      }
      direct2 +=
          std::pow(double(got.light[4 * i + 3]) * got.intrinsic[4 * i + 3] - expected.direct[i],
                   2) /
          double(n);
    }
    EXPECT_LT(std::sqrt(tint2), 3e-3) << what;
    EXPECT_LT(std::sqrt(paint2), 1e-2) << what;  // bins of the solve are in fixed point
    EXPECT_LT(std::sqrt(direct2), 5e-3) << what;
  }
};

TEST_F(GlobalTest, AgreesWithReference) {
  for (const Extent extent : {Extent{160, 120}, Extent{97, 61}, Extent{333, 100}, Extent{61, 97}}) {
    const Room made = room(extent, 3);
    GlobalIntrinsic method(device, extent);
    const Result got = decompose(method, made.frame, extent, to_the_letter(), {true});
    const auto expected =
        reference::decompose_global(rgb_of(made.frame).data(), int(extent.width),
                                    int(extent.height), reference::GlobalParams{}, nullptr);
    expect_agreement(got, expected, name_of(extent));
  }
}

TEST_F(GlobalTest, AgreesWithReferenceOverTime) {
  const Extent extent{160, 120};
  GlobalIntrinsic method(device, extent);
  reference::GlobalState state;
  for (unsigned frame = 0; frame < 4; ++frame) {
    const Room made = room(extent, frame, 0.35F + 0.02F * float(frame));
    const Result got = decompose(method, made.frame, extent, to_the_letter(), {false});
    const auto expected =
        reference::decompose_global(rgb_of(made.frame).data(), int(extent.width),
                                    int(extent.height), reference::GlobalParams{}, &state);
    expect_agreement(got, expected, "frame " + std::to_string(frame));
  }
}

TEST_F(GlobalTest, TakesTheLampsColorOutAsTheReferenceDoes) {
  const Extent extent{160, 120};
  GlobalIntrinsic::Params params = to_the_letter();
  params.white_balance = 0.7F;
  reference::GlobalParams spec;
  spec.white_balance = 0.7;
  GlobalIntrinsic method(device, extent);
  reference::GlobalState state;
  for (unsigned frame = 0; frame < 4; ++frame) {
    Room made = room(extent, frame);
    if (frame == 3)  // another scene: nothing of the lamps before is taken over
      for (size_t i = 0; i < made.frame.size(); i += 4)
        std::swap(made.frame[i], made.frame[i + 2]),
            std::swap(made.frame[i + 1], made.frame[i + 2]);
    for (size_t i = 0; i < made.frame.size(); i += 4)
      for (size_t c = 0; c < 3; ++c) made.frame[i + c] *= std::array{1.0F, 0.8F, 0.55F}[c];
    const Result got = decompose(method, made.frame, extent, params, {false});
    auto expected = reference::decompose_global(rgb_of(made.frame).data(), int(extent.width),
                                                int(extent.height), spec, &state);
    EXPECT_EQ(got.found.cut, frame == 0 || frame == 3);
    EXPECT_EQ(expected.cut, frame == 3);
    // There the lamps' color is beside the light, here it is in it.
    const auto white = reference::global::color_of(expected.white);
    Result plain = got;
    for (size_t i = 0; i < plain.light.size(); ++i)
      if (i % 4 != 3) plain.light[i] /= float(white[i % 4]);
    expect_agreement(plain, expected, "frame " + std::to_string(frame));
  }
}

TEST_F(GlobalTest, SharesAgreeWithReference) {
  const Extent extent{120, 90};
  const Room made = room(extent, 3);
  GlobalIntrinsic method(device, extent);
  const Result got = decompose(method, made.frame, extent, to_the_letter(), {true, true});
  const auto frame =
      reference::decompose_global(rgb_of(made.frame).data(), int(extent.width), int(extent.height),
                                  reference::GlobalParams{}, nullptr);
  expect_agreement(got, frame, "frame");
  const auto expected = reference::split_indirect(frame, int(extent.width), int(extent.height));
  const Pixels bases = download(got.layers[Role::bases]->buffer);
  std::vector<Pixels> shares;
  for (uint32_t n = 0; n < kIndirectPlanes; ++n)
    shares.push_back(download(got.layers[indirect_role(n)]->buffer));
  for (size_t k = 0; k < kMaxBases; ++k) {
    ASSERT_EQ(bases[4 * k + 3], frame.colors.color[k] ? 1.0F : 0.0F) << k;
    double off2 = 0;
    for (size_t i = 0; i < extent.pixels(); ++i)
      off2 += std::pow(double(shares[k / 4][4 * i + k % 4]) * got.intrinsic[4 * i + 3] -
                           expected.amount[k][i],
                       2) /
              double(extent.pixels());
    EXPECT_LT(std::sqrt(off2), 2e-3) << "base color " << k;
    for (size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(bases[4 * k + c], expected.base[k][c], 2e-3) << "base color " << k;
  }
}

TEST_F(GlobalTest, LayersMakeUpTheFrame) {
  const Extent extent{150, 100};
  const Room made = room(extent, 3);
  GlobalIntrinsic method(device, extent);
  const Result got = decompose(method, made.frame, extent, {}, {true, true});
  for (size_t i = 0; i < made.frame.size(); ++i) {
    const size_t pixel = i / 4 * 4;
    if (i % 4 == 3) continue;
    EXPECT_NEAR(got.intrinsic[i] * got.intrinsic[pixel + 3] * got.light[i], made.frame[i], 1e-5);
    EXPECT_GE(got.light[i], got.light[pixel + 3] - 1e-6F) << "direct light is part of all";
  }
}

/// The same frame without color: as black-and-white film, or toned as sepia.
Pixels colorless(Pixels frame, const std::array<float, 3>& tone = {1, 1, 1}) {
  for (size_t i = 0; i < frame.size(); i += 4)
    for (const size_t c : {2, 1, 0}) frame[i + c] = frame[i] * tone[c];
  return frame;
}

TEST_F(GlobalTest, FramesWithoutColorHaveDirectLightAlone) {
  const Extent extent{90, 70};
  for (const auto& tone : {std::array{1.0F, 1.0F, 1.0F}, std::array{1.0F, 0.85F, 0.65F}}) {
    const Pixels frame = colorless(room(extent, 2).frame, tone);
    GlobalIntrinsic method(device, extent);
    ScaledIntrinsic alone(device, extent);
    for (int k = 0; k < 16; ++k) {
      const Result got = decompose(method, frame, extent, {}, {false, true});
      EXPECT_EQ(got.found.colors, 0U);
      EXPECT_EQ(got.found.amount, 0);
      EXPECT_EQ(got.found.confidence, 0);
      EXPECT_LT(got.found.chroma, 0.02F);
      for (const float light : got.light) ASSERT_EQ(light, 1) << "frame " << k;
      const bool plain = method.stats(method.recorded() - 1).plain;
      EXPECT_EQ(plain, k >= 10) << "frame " << k;
      EXPECT_EQ(plain, !got.layers[indirect_role(0)]) << "frame " << k;
      EXPECT_EQ(plain, !got.layers[Role::bases]) << "frame " << k;
      Pixels expected;
      Layers two;
      run([&](gpu::Commands& commands) {
        two = alone.record(commands, input(extent, frame), {}, {false, {}});
      });
      expected = download(two[Role::intrinsic]->buffer);
      for (size_t i = 0; i < expected.size(); ++i)
        ASSERT_NEAR(got.intrinsic[i], expected[i], 1e-4 + 1e-3 * expected[i]) << "frame " << k;
    }
  }
}

TEST_F(GlobalTest, ColorThatComesBackIsSeen) {
  const Extent extent{160, 120};
  const Pixels frame = room(extent, 3).frame, gray = colorless(frame);
  GlobalIntrinsic method(device, extent), fresh(device, extent);
  for (int k = 0; k < 14; ++k) decompose(method, gray, extent, {}, {false, true});
  EXPECT_TRUE(method.stats(method.recorded() - 1).plain);
  Result got, expected;
  for (int k = 0; k < 10; ++k) {
    got = decompose(method, frame, extent, {}, {false, true});
    EXPECT_EQ(method.stats(method.recorded() - 1).plain, k < int(gpu::kFramesInFlight));
    for (size_t i = 0; i < frame.size(); ++i) {
      const size_t pixel = i / 4 * 4;
      if (i == pixel + 3) continue;
      ASSERT_NEAR(got.intrinsic[i] * got.intrinsic[pixel + 3] * got.light[i], frame[i], 1e-5);
    }
  }
  for (int k = 0; k < 7; ++k) expected = decompose(fresh, frame, extent, {}, {false, true});
  EXPECT_NEAR(got.found.amount, expected.found.amount, 0.05F * expected.found.amount);
  EXPECT_EQ(got.found.colors, expected.found.colors);
  EXPECT_TRUE(got.layers[Role::bases]);
}

TEST_F(GlobalTest, ColorFadesWithoutAJump) {
  const Extent extent{160, 120};
  const Room made = room(extent, 3);
  const Pixels gray = colorless(made.frame);
  // Where the spread of chroma goes through both thresholds, each as often as not conditional.
  float before = 0;
  for (int k = 0; k <= 24; ++k) {
    Pixels frame = made.frame;
    const float share = 0.25F * float(k) / 24;
    for (size_t i = 0; i < frame.size(); ++i) frame[i] = gray[i] + share * (frame[i] - gray[i]);
    GlobalIntrinsic method(device, extent);
    const Result got = decompose(method, frame, extent, to_the_letter(), {true});
    const auto expected =
        reference::decompose_global(rgb_of(frame).data(), int(extent.width), int(extent.height),
                                    reference::GlobalParams{}, nullptr);
    EXPECT_NEAR(got.found.amount, expected.amount.value, 5e-3) << share;
    EXPECT_NEAR(got.found.amount, before, 0.25F) << share;
    EXPECT_EQ(got.found.amount > 0, got.found.colors > 0) << share;
    before = got.found.amount;
  }
  EXPECT_GT(before, 0.2F);
}

TEST_F(GlobalTest, LightIsGrayWhereItsAmountIsNotKnown) {
  const Extent extent{160, 120};
  const Room made = room(extent, 3);
  GlobalIntrinsic::Params params = to_the_letter();
  reference::GlobalParams spec;
  // Little trust leaves little more than the prior: confidences below and above what is enough.
  float least = 1, most = 0;
  for (const float trust : {0.0F, 0.05F, 0.1F, 0.2F, 0.4F, 1.0F}) {
    params.trust = trust;
    spec.amount.trust = double(trust);
    GlobalIntrinsic method(device, extent);
    const Result got = decompose(method, made.frame, extent, params, {true});
    const auto expected = reference::decompose_global(rgb_of(made.frame).data(), int(extent.width),
                                                      int(extent.height), spec, nullptr);
    expect_agreement(got, expected, "trust " + std::to_string(trust));
    float color = 0;
    for (size_t i = 0; i < got.light.size(); ++i)
      if (i % 4 != 3) color = std::max(color, std::abs(got.light[i] - 1));
    EXPECT_TRUE(trust > 0 || color < 1e-5F) << color;
    EXPECT_TRUE(trust < 1 || color > 0.05F) << color;
    least = std::min(least, got.found.confidence);
    most = std::max(most, got.found.confidence);
  }
  EXPECT_LT(least, 0.01F);
  EXPECT_GT(most, 0.03F);
}

/// A wall of colored tiles.
Pixels wall(Extent extent) {
  Pixels frame;
  for (uint32_t y = 0; y < extent.height; ++y)
    for (uint32_t x = 0; x < extent.width; ++x) {
      const uint32_t tile = x / 21 * 5 + y / 17 * 3;
      const float light = 1 - 0.6F * float(x + y) / float(extent.width + extent.height);
      for (uint32_t c = 0; c < 3; ++c) frame.push_back(light * float(2 + tile * (c + 2) % 7) / 9);
      frame.push_back(1);
    }
  return frame;
}

/// With a dark square on its way before it.
Pixels passed(Pixels frame, Extent extent, uint32_t left) {
  const uint32_t top = 100;
  for (uint32_t y = top; y < top + 24; ++y)
    for (uint32_t x = left; x < left + 24; ++x)
      for (size_t c = 0; c < 3; ++c) frame[4 * (y * size_t{extent.width} + x) + c] = 0.1F;
  return frame;
}

/// A byte a tile, 1 where two frames differ.
std::vector<uint8_t> changed_tiles(const Pixels& before, const Pixels& now, Extent extent) {
  std::vector<uint8_t> changed(TileList::count(extent));
  for (size_t i = 0; i < now.size(); ++i) {
    const auto x = static_cast<uint32_t>(i / 4 % extent.width),
               y = static_cast<uint32_t>(i / 4 / extent.width);
    if (now[i] != before[i])
      changed[size_t{y / TileList::kTile} * TileList::along(extent.width) + x / TileList::kTile] =
          1;
  }
  return changed;
}

TEST_F(GlobalTest, WhileLightIsHeldTheSolveIsToldOfEveryTileWhoseInputIsAnother) {
  const Extent extent{320, 240};
  const Pixels still = room(extent, 3).frame;
  GlobalIntrinsic method(device, extent);
  ScaledIntrinsic alone(device, extent);  // is told of what changed in its input, as it is
  GlobalIntrinsic::Params params;
  // So that frames are worked on by tiles, and those where it changed alone.
  params.hold_tolerance = params.chroma_tolerance = 0;
  params.still_tolerance = 0.5F;
  params.tile_tolerance = 0.3F;
  Pixels before, plain_before;
  unsigned listed = 0;
  for (unsigned k = 0; k < 60; ++k) {
    const Pixels frame = passed(still, extent, 20 + 3 * k);
    const auto changed = k > 0 ? changed_tiles(before, frame, extent) : std::vector<uint8_t>();
    const Result got = decompose(method, frame, extent, params, {false, false, changed});
    const auto& stats = method.stats(method.recorded() - 1);
    Pixels plain = frame;
    for (size_t i = 0; i < plain.size(); ++i)
      if (i % 4 != 3) plain[i] /= got.light[i];
    const auto truth =
        stats.held ? changed_tiles(plain_before, plain, extent) : std::vector<uint8_t>();
    Layers want;
    run([&](gpu::Commands& commands) {
      want = alone.record(commands, input(extent, plain), params, {false, truth});
    });
    if (stats.solve.listed) {
      ++listed;
      const auto concerned = spread_tiles(truth, TileList::along(extent.width));
      EXPECT_GE(got.found.solve.tiles_active,
                uint32_t(std::count(concerned.begin(), concerned.end(), 1)))
          << k;
    }
    const Pixels expected = download(want[Role::intrinsic]->buffer);
    double apart = 0;
    for (size_t i = 3; i < expected.size(); i += 4)
      apart += std::pow(std::log(got.intrinsic[i] / expected[i]), 2) / double(extent.pixels());
    EXPECT_LT(std::sqrt(apart), 1e-5) << k;
    before = frame;
    plain_before = plain;
  }
  EXPECT_GT(listed, 30U);
}

TEST_F(GlobalTest, LightIsHeldWhereLittleChanges) {
  const Extent extent{320, 240};
  const Pixels still = wall(extent);
  GlobalIntrinsic some(device, extent), all(device, extent);
  Pixels before = still;
  unsigned held = 0, listed = 0, anew_after = 0;
  uint32_t colors = 0;
  for (int k = 0; k < 100; ++k) {
    const Pixels frame = passed(still, extent, 20 + uint32_t(k < 90 ? 2 * k : 180));
    const auto changed = changed_tiles(before, frame, extent);
    before = frame;
    const bool shares = k % 2 == 0;
    const Result got = decompose(some, frame, extent, {}, {false, shares, changed}),
                 want = decompose(all, frame, extent, {}, {false, shares});
    const auto& stats = some.stats(some.recorded() - 1);
    EXPECT_FALSE(all.stats(all.recorded() - 1).held);
    EXPECT_TRUE(k >= 13 || !stats.held) << k;
    anew_after += held > 0 && !stats.held;
    held += stats.held;
    listed += stats.solve.listed;
    EXPECT_TRUE(stats.held || !some.drawn()) << k;
    if (!stats.held) colors = got.found.colors;
    EXPECT_EQ(got.found.colors, colors) << k;
    double apart = 0, light = 0;
    for (size_t i = 0; i < frame.size(); ++i) {
      const size_t pixel = i / 4 * 4;
      if (i == pixel + 3) continue;
      ASSERT_NEAR(got.intrinsic[i] * got.intrinsic[pixel + 3] * got.light[i], frame[i], 1e-5) << k;
      ASSERT_GE(got.light[i], got.light[pixel + 3] - 1e-6F);
      light += std::pow(std::log(got.light[i] / want.light[i]), 2) / double(frame.size());
      apart += std::pow(got.light[pixel + 3] - want.light[pixel + 3], 2) / double(frame.size());
    }
    EXPECT_LT(std::sqrt(light), 0.02) << k;
    EXPECT_LT(std::sqrt(apart), 0.05) << k;
    EXPECT_EQ(shares, bool(got.layers[Role::bases]));
    if (!shares) continue;
    // Base colors and their shares make up bounced light as well as without.
    const Pixels first = download(got.layers[indirect_role(0)]->buffer),
                 expected = download(want.layers[indirect_role(0)]->buffer);
    double share = 0;
    for (size_t i = 0; i < first.size(); ++i)
      share += std::pow(first[i] - expected[i], 2) / double(first.size());
    EXPECT_LT(std::sqrt(share), 0.05) << k;
  }
  EXPECT_GT(held, 70U);
  EXPECT_GT(listed, 50U);
  EXPECT_GT(anew_after, 0U) << "the scene is looked at again";
  // What else the scene becomes concerns everything.
  GlobalIntrinsic::Params params;
  params.reach = 0.3F;
  const std::vector<uint8_t> none(TileList::count(extent));
  decompose(some, before, extent, params, {false, false, none});
  EXPECT_FALSE(some.stats(some.recorded() - 1).held);
}

TEST_F(GlobalTest, HeldLightIsWhatItWasWhereNothingChanges) {
  const Extent extent{150, 100};
  const Pixels frame = room(extent, 3).frame;
  const std::vector<uint8_t> none(size_t{10} * 7);
  GlobalIntrinsic method(device, extent);
  Pixels tint;
  for (int k = 0; k < 24; ++k) {
    const Result got = decompose(method, frame, extent, {}, {false, false, none});
    EXPECT_EQ(method.stats(method.recorded() - 1).held, k >= 13) << k;
    Pixels now = got.light;
    for (size_t i = 3; i < now.size(); i += 4) now[i] = 0;  // the direct share follows shading
    EXPECT_TRUE(k < 13 || now == tint) << k;
    tint = now;
  }
}

TEST_F(GlobalTest, AmountSetByHandGoesWithoutColor) {
  const Extent extent{90, 70};
  const Pixels gray = colorless(room(extent, 2).frame);
  GlobalIntrinsic method(device, extent);
  GlobalIntrinsic::Params params;
  params.amount = 0.6F;
  Result got;
  for (int k = 0; k < 14; ++k) got = decompose(method, gray, extent, params, {false, true});
  EXPECT_EQ(got.found.amount, 0.6F);
  EXPECT_FALSE(method.stats(method.recorded() - 1).plain);
  double direct = 0;
  for (size_t i = 0; i < gray.size(); i += 4) {
    for (size_t c = 0; c < 3; ++c) ASSERT_NEAR(got.light[i + c], 1, 1e-5);
    direct += got.light[i + 3] / double(extent.pixels());
  }
  EXPECT_LT(direct, 0.8);
}

TEST_F(GlobalTest, AnyFrameGivesFiniteLayers) {
  constexpr float kInf = std::numeric_limits<float>::infinity();
  for (const Extent extent : {Extent{1, 1}, Extent{1, 90}, Extent{300, 2}, Extent{64, 48}}) {
    GlobalIntrinsic method(device, extent);
    for (int kind = 0; kind < 7; ++kind) {
      Pixels frame = kind < 4 ? Pixels(extent.pixels() * 4) : random_pixels(extent, 4);
      for (size_t i = 0; i < frame.size(); ++i) {
        if (kind == 1) frame[i] = 1;
        if (kind == 2) frame[i] = i % 4 == 1 ? 1 : 0;
        if (kind == 3) frame[i] = 1e30F;
        if (kind == 5 && i % 11 == 0) frame[i] = std::numeric_limits<float>::quiet_NaN();
        if (kind == 6 && i % 5 == 0) frame[i] = i % 2 ? kInf : -kInf;
      }
      for (int k = 0; k < 2; ++k) {
        const Result got = decompose(method, frame, extent, {}, {k == 0, true});
        for (const float value : got.intrinsic) ASSERT_TRUE(std::isfinite(value)) << kind;
        for (const float value : got.light) ASSERT_TRUE(std::isfinite(value)) << kind;
        for (uint32_t n = 0; n < kIndirectPlanes; ++n)
          if (const PlanePtr& shares = got.layers[indirect_role(n)])
            for (const float value : download(shares->buffer)) {
              ASSERT_TRUE(std::isfinite(value)) << kind;
              ASSERT_GE(value, 0) << kind;
            }
        ASSERT_TRUE(std::isfinite(got.found.amount));
      }
    }
  }
}

TEST_F(GlobalTest, AForgottenFrameIsLikeNone) {
  const Extent extent{80, 60};
  GlobalIntrinsic used(device, extent), fresh(device, extent);
  decompose(used, random_pixels(extent, 1), extent, {}, {false});
  const Pixels frame = room(extent, 5).frame;
  const Result a = decompose(used, frame, extent, {}, {true}),
               b = decompose(fresh, frame, extent, {}, {true});
  EXPECT_EQ(a.intrinsic, b.intrinsic);
  EXPECT_EQ(a.light, b.light);
}

}  // namespace inverse::testing
