// The gather-tint model on the device against its reference.
#include "global/global_intrinsic.hpp"
#include "intrinsic_fixture.hpp"
#include "tests/reference/global_intrinsic.hpp"

namespace inverse::testing {
namespace {

/// A room of four paints under a light with a hard border that moves with `time`, and indirect
/// light of one bounce: the frame's own colors, blurred by hand.
Pixels room(Extent extent, int time) {
  constexpr float kPaints[4][3] = {
      {.8F, .15F, .1F}, {.75F, .75F, .75F}, {.15F, .6F, .2F}, {.25F, .3F, .8F}};
  Pixels pixels(extent.pixels() * 4, 1);
  for (uint32_t y = 0; y < extent.height; ++y)
    for (uint32_t x = 0; x < extent.width; ++x) {
      const float u = (static_cast<float>(x) + 0.5F) / static_cast<float>(extent.width);
      const float v = (static_cast<float>(y) + 0.5F) / static_cast<float>(extent.height);
      const int paint = u < 0.25F ? 0 : u > 0.75F ? 2 : (u > 0.45F && u < 0.6F && v > 0.5F) ? 3 : 1;
      const float direct = u + v > 0.9F + 0.02F * static_cast<float>(time) ? 0.7F : 0.1F;
      for (size_t c = 0; c < 3; ++c) {
        const float indirect = 0.25F * ((1 - u) * kPaints[0][c] + u * kPaints[2][c]);
        pixels[4 * (static_cast<size_t>(y) * extent.width + x) + c] =
            kPaints[paint][c] * (direct + indirect);
      }
    }
  return pixels;
}

class GlobalTest : public GpuTest {};

struct Compared {
  double tint = 0, labels = 0, reflectance = 0, light = 0, product = 0;
};

/// Root mean square differences of log chroma and of ln R, relative ones of light; the share of
/// pixels of another label; and the largest difference of the product from the frame.
Compared compare(const Pixels& frame, const Pixels& tints, const Pixels& reflectance,
                 const Pixels& light, const reference::GlobalResult& r) {
  Compared out;
  const size_t n = r.direct.size();
  double all = 0;
  for (size_t i = 0; i < n; ++i) {
    out.labels += tints[4 * i + 2] == static_cast<float>(r.label[i]) ? 0 : 1.0 / double(n);
    reference::Vec3 mine{}, theirs{};
    for (size_t c = 0; c < 3; ++c) {
      mine[c] = double(light[4 * i + c]) + double(light[4 * i + 3]);
      theirs[c] = r.direct[i] + r.indirect[3 * i + c];
      const double d = double(light[4 * i + c]) - r.indirect[3 * i + c];
      out.light += d * d;
      all += r.indirect[3 * i + c] * r.indirect[3 * i + c];
      const double ratio =
          std::log((double(reflectance[4 * i + c]) + 1e-3) / (r.reflectance[3 * i + c] + 1e-3));
      out.reflectance += ratio * ratio / double(3 * n);
      out.product = std::max(out.product, std::abs(double(reflectance[4 * i + c]) * mine[c] -
                                                   double(frame[4 * i + c])));
    }
    out.tint += norm2(reference::global::chroma_of(mine) - reference::global::chroma_of(theirs)) /
                double(n);
  }
  out.tint = std::sqrt(out.tint);
  out.reflectance = std::sqrt(out.reflectance);
  out.light = std::sqrt(out.light / all);
  return out;
}

TEST_F(GlobalTest, FollowsTheReferenceOverFrames) {
  for (const Extent extent : {Extent{160, 120}, Extent{97, 61}, Extent{646, 200}}) {
    SCOPED_TRACE(name_of(extent));
    GlobalIntrinsic method(device, extent);
    GlobalIntrinsic::Params params;
    params.solve.adaptive = false;
    reference::GlobalState state;
    for (int k = 0; k < 3; ++k) {
      SCOPED_TRACE(k);
      const Pixels frame = room(extent, k);
      GlobalIntrinsic::Result result;
      run([&](gpu::Commands& commands) {
        result = method.record(commands, std::make_shared<Plane>(plane(extent, frame)), params, {});
      });
      const auto rgb = rgb_of(frame);
      const reference::GlobalResult expected = reference::decompose_global(
          rgb.data(), int(extent.width), int(extent.height), {}, &state);
      const GlobalIntrinsic::Findings found = method.findings();
      EXPECT_NEAR(found.amount, expected.amount.value, 0.02 * expected.amount.value);
      EXPECT_NEAR(found.confidence, expected.amount.confidence, 0.02);
      EXPECT_EQ(found.colors, uint32_t(expected.colors.used()));
      EXPECT_EQ(found.cut, k == 0);
      const Compared c =
          compare(frame, download(result.tints->buffer), download(result.reflectance->buffer),
                  download(result.light->buffer), expected);
      EXPECT_LT(c.labels, 0.01);
      EXPECT_LT(c.tint, 0.02);
      EXPECT_LT(c.reflectance, 0.03);
      EXPECT_LT(c.light, 0.05);
      EXPECT_LT(c.product, 1e-4);
      for (uint32_t s = 0; s < LightModel::kSlots; ++s) {
        ASSERT_EQ(found.used[s], expected.colors.color[s].has_value());
        if (!found.used[s]) continue;
        EXPECT_NEAR(found.base[s][0], (*expected.colors.color[s])[0], 0.01);
        EXPECT_NEAR(found.base[s][1], (*expected.colors.color[s])[1], 0.01);
      }
    }
  }
}

TEST_F(GlobalTest, TakesTheAmountThatItIsGiven) {
  const Extent extent{160, 120};
  GlobalIntrinsic method(device, extent);
  GlobalIntrinsic::Params params;
  params.light.amount = 0.3F;
  run([&](gpu::Commands& commands) {
    method.record(commands, std::make_shared<Plane>(plane(extent, room(extent, 0))), params, {});
  });
  EXPECT_FLOAT_EQ(method.findings().amount, 0.3F);
}

TEST_F(GlobalTest, StaysFiniteOnAnything) {
  for (const Extent extent : kOddSizes) {
    if (extent.pixels() > 10000) continue;
    SCOPED_TRACE(name_of(extent));
    GlobalIntrinsic method(device, extent);
    for (const float value : {0.0F, 1.0F, -1.0F, std::numeric_limits<float>::quiet_NaN(),
                              std::numeric_limits<float>::infinity(), 0.3F}) {
      Pixels frame = random_pixels(extent, 1);
      if (value != 0.3F)
        for (size_t i = 0; i < frame.size(); i += value == value ? 1 : 3) frame[i] = value;
      GlobalIntrinsic::Result result;
      run([&](gpu::Commands& commands) {
        result = method.record(commands, std::make_shared<Plane>(plane(extent, frame)), {}, {});
      });
      for (const PlanePtr& plane : {result.reflectance, result.light, result.tints})
        for (const float v : download(plane->buffer)) ASSERT_TRUE(std::isfinite(v));
    }
  }
}

}  // namespace
}  // namespace inverse::testing
