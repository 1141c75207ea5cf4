// SPDX-License-Identifier: LGPL-2.1-or-later
// globalintrinsic on the device against its specification.
#include <cmath>

#include "global_fixture.hpp"
#include "tests/update_max.hpp"

namespace inverse::testing {

TEST_F(GlobalTest, AgreesWithReference) {
  for (const Extent extent : {Extent{160, 120}, Extent{97, 61}, Extent{333, 100}, Extent{61, 97}}) {
    const Room made = room(extent, 3);
    GlobalIntrinsic method(device, extent);
    const Result got = decompose(method, made.frame, extent, to_the_letter(), {true});
    const auto expected = expected_of(made.frame, extent);
    expect_agreement(got, expected, name_of(extent));
  }
}

TEST_F(GlobalTest, AgreesWithReferenceInColoredLight) {
  const Extent extent{160, 120};
  const Pixels frame = room(extent, 1).frame;
  GlobalIntrinsic::Params params = to_the_letter();
  params.light.slope = -0.7F;
  GlobalIntrinsic method(device, extent);
  const Result got = decompose(method, frame, extent, params, {.reset = true});
  const Pixels slope = download(got.layers[Role::slope]);
  reference::LightColor light{double(slope[0]), 0, double(slope[1])};
  EXPECT_EQ(slope[0], -0.7F);
  for (size_t i = 0; i < frame.size(); i += 4) {
    const float* layers = &got.intrinsic[i];
    const auto gray = reference::in_gray_light({layers[0], layers[1], layers[2], layers[3]}, light);
    for (size_t c = 0; c < 3; ++c)
      ASSERT_NEAR(gray[c] * gray[3] * got.light[i + c], frame[i + c], 1e-5) << i;
  }
  // By the specification, from the same reference and white.
  SceneLight measured(device, extent);
  run([&](gpu::Commands& commands) {
    measured.record(commands, input(extent, frame)->buffer, params.light, true);
    measured.record_move(commands, false);
  });
  reference::GlobalParams expected;
  light.reference = double(download(measured.state())[1]);
  light.white += double(got.found.solve.scale);
  expected.solve.light = light;
  expect_agreement(got, expected_of(frame, extent, expected), "colored light");
}

TEST_F(GlobalTest, AgreesWithReferenceOverTime) {
  const Extent extent{160, 120};
  GlobalIntrinsic method(device, extent);
  reference::GlobalState state;
  for (unsigned frame = 0; frame < 4; ++frame) {
    const Room made = room(extent, frame, 0.35F + 0.02F * float(frame));
    const Result got = decompose(method, made.frame, extent, to_the_letter(), {false});
    const auto expected = expected_of(made.frame, extent, {}, &state);
    expect_agreement(got, expected, "frame " + std::to_string(frame));
  }
}

TEST_F(GlobalTest, SlotsAreTheReferencesWhereColorsComeAndGo) {
  const Extent extent{160, 120};
  GlobalIntrinsic method(device, extent);
  reference::GlobalState state;
  const std::array<float, 3> violet{0.5F, 0.05F, 0.6F}, cyan{0.05F, 0.5F, 0.6F};
  for (unsigned frame = 0; frame < 12; ++frame) {
    Room made = room(extent, 3);
    const auto put = [&](const std::array<float, 3>& color, uint32_t left) {
      for (uint32_t y = 70; y < 90; ++y)
        for (uint32_t x = left; x < left + 20; ++x)
          std::copy(color.begin(), color.end(), &made.frame[4 * (size_t{y} * extent.width + x)]);
    };
    if (frame % 8 >= 2 && frame % 8 < 5) put(violet, 60);
    if (frame >= 6 && frame < 9) put(cyan, 90);
    const Result got = decompose(method, made.frame, extent, to_the_letter(), {false});
    const auto expected = expected_of(made.frame, extent, {}, &state);
    expect_agreement(got, expected, "frame " + std::to_string(frame));
  }
}

TEST_F(GlobalTest, TakesTheLampsColorOutAsTheReferenceDoes) {
  const Extent extent{160, 120};
  GlobalIntrinsic::Params params = to_the_letter();
  params.white_balance = 0.7F;
  const reference::GlobalParams spec{.white_balance = 0.7};
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
    auto expected = expected_of(made.frame, extent, spec, &state);
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
  const auto frame = expected_of(made.frame, extent);
  expect_agreement(got, frame, "frame");
  const auto expected = reference::split_indirect(frame, int(extent.width), int(extent.height));
  const Pixels bases = download(got.layers[Role::bases]);
  std::vector<Pixels> shares;
  for (uint32_t n = 0; n < kIndirectPlanes; ++n)
    shares.push_back(download(got.layers[indirect_role(n)]));
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

TEST_F(GlobalTest, LabelsAreDrawnInTheBaseColorsOfTheReference) {
  const Extent extent{120, 90};
  const Room made = room(extent, 3);
  GlobalIntrinsic method(device, extent);
  decompose(method, made.frame, extent, to_the_letter(), {true});
  const auto expected = expected_of(made.frame, extent);
  const PlanePtr target = input(extent, made.frame);
  run([&](gpu::Commands& commands) {
    method.draw_labels(commands, *input(extent, made.frame), *target);
  });
  const Pixels drawn = download(target);
  size_t others = 0;
  for (size_t i = 0; i < extent.pixels(); ++i) {
    reference::Vec3 color =
        reference::global::color_of(*expected.colors.color[size_t(expected.label[i])]);
    const double largest = *std::max_element(color.begin(), color.end());
    bool same = drawn[4 * i + 3] == 1;
    for (size_t c = 0; c < 3; ++c)
      same &= std::fabs(double(drawn[4 * i + c]) - color[c] / largest) < 0.02;
    others += !same;
  }
  EXPECT_LT(others, extent.pixels() / 100);  // at the borders of bins
}

TEST_F(GlobalTest, LayersMakeUpTheFrame) {
  const Extent extent{150, 100};
  const Room made = room(extent, 3);
  GlobalIntrinsic method(device, extent);
  expect_product(decompose(method, made.frame, extent, {}, {true, true}), made.frame);
}

TEST_F(GlobalTest, LightIsGrayIfItsAmountIsUnknown) {
  const Extent extent{160, 120};
  const Room made = room(extent, 3);
  GlobalIntrinsic::Params params = to_the_letter();
  reference::GlobalParams spec;
  // A small weight leaves little more than the prior: confidences below and above what is enough.
  float smallest = 1, largest = 0;
  for (const float measurement_weight : {0.0F, 0.05F, 0.1F, 0.2F, 0.4F, 1.0F}) {
    params.measurement_weight = measurement_weight;
    spec.amount.measurement_weight = double(measurement_weight);
    GlobalIntrinsic method(device, extent);
    const Result got = decompose(method, made.frame, extent, params, {true});
    const auto expected = expected_of(made.frame, extent, spec);
    expect_agreement(got, expected, "measurement_weight " + std::to_string(measurement_weight));
    float color = 0;
    for (size_t i = 0; i < got.light.size(); ++i)
      if (i % 4 != 3) update_max(color, std::abs(got.light[i] - 1));
    EXPECT_TRUE(measurement_weight > 0 || color < 1e-5F) << color;
    EXPECT_TRUE(measurement_weight < 1 || color > 0.05F) << color;
    smallest = std::min(smallest, got.found.confidence);
    update_max(largest, got.found.confidence);
  }
  EXPECT_LT(smallest, 0.01F);
  EXPECT_GT(largest, 0.03F);
}

TEST_F(GlobalTest, AnyFrameGivesFiniteLayers) {
  for (const Extent extent : {Extent{1, 1}, Extent{1, 90}, Extent{300, 2}, Extent{64, 48}}) {
    GlobalIntrinsic method(device, extent);
    for (int kind = 0; kind < 7; ++kind) {
      Pixels frame = kind < 4 ? Pixels(extent.pixels() * 4) : random_pixels(extent, 4);
      for (size_t i = 0; i < frame.size(); ++i) {
        if (kind == 1) frame[i] = 1;
        if (kind == 2) frame[i] = i % 4 == 1 ? 1 : 0;
        if (kind == 3) frame[i] = 1e30F;
        if (kind == 5 && i % 11 == 0) frame[i] = kNan;
        if (kind == 6 && i % 5 == 0) frame[i] = i % 2 ? kInf : -kInf;
      }
      for (int k = 0; k < 2; ++k) {
        const Result got = decompose(method, frame, extent, {}, {k == 0, true});
        ASSERT_TRUE(all_finite(got.intrinsic) && all_finite(got.light)) << kind;
        for (uint32_t n = 0; n < kIndirectPlanes; ++n) {
          const PlanePtr& shares = got.layers[indirect_role(n)];
          ASSERT_TRUE(!shares || are_light(download(shares))) << kind;
        }
        ASSERT_TRUE(std::isfinite(got.found.amount));
      }
    }
  }
}

TEST_F(GlobalTest, AResetDiscardsTheFrame) {
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
