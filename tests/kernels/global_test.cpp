// globalintrinsic on the device against its specification.
#include "global/global_intrinsic.hpp"

#include <cmath>

#include "intrinsic_fixture.hpp"
#include "tests/reference/global_intrinsic.hpp"

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
      const bool left = u < 0.25F, right = u > 0.75F;
      const size_t patch = static_cast<size_t>(u * 12) + 3 * static_cast<size_t>(v * 5);
      const auto& paint = paints[left ? 0 : right ? 1 : 2 + patch % 3];
      const float shadow = v > 0.5F && u > 0.4F && u < 0.65F ? 0.05F : 1.0F;
      const float direct = shadow * (0.6F - 0.3F * v);
      // A wall does not light itself.
      const float from_red = left ? 0.05F : bounced * 0.6F * std::exp(-3 * (u - 0.25F));
      const float from_green = right ? 0.05F : bounced * 0.6F * std::exp(-3 * (0.75F - u));
      for (size_t c = 0; c < 3; ++c) {
        const float indirect =
            0.25F * bounced + (left ? 0 : from_red * paints[0][c]) + (right ? 0 : from_green * paints[1][c]);
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
    Pixels intrinsic, light;
    GlobalIntrinsic::Findings found;
  };
  Result decompose(GlobalIntrinsic& method, const Pixels& frame, Extent extent, bool reset,
                   const GlobalIntrinsic::Params& params = {}) {
    Layers layers;
    run([&](gpu::Commands& commands) {
      layers = method.record(commands, input(extent, frame), params, {reset});
    });
    return {download(layers[Role::intrinsic]->buffer), download(layers[Role::light]->buffer),
            method.findings(method.recorded() - 1)};
  }
};

TEST_F(GlobalTest, AgreesWithReference) {
  for (const Extent extent : {Extent{160, 120}, Extent{97, 61}, Extent{333, 100}}) {
    const Room made = room(extent, 3);
    GlobalIntrinsic method(device, extent);
    GlobalIntrinsic::Params params;
    params.adaptive = false;
    const Result got = decompose(method, made.frame, extent, true, params);
    reference::GlobalParams spec;
    const auto expected = reference::decompose_global(rgb_of(made.frame).data(), int(extent.width),
                                                      int(extent.height), spec, nullptr);
    EXPECT_NEAR(got.found.amount, expected.amount.value, 0.02 * expected.amount.value);
    EXPECT_EQ(got.found.colors, uint32_t(expected.colors.used()));
    EXPECT_NEAR(got.found.tint, expected.tint, 0.02 * expected.tint + 1e-3);
    double r2 = 0, d2 = 0;
    for (size_t i = 0; i < extent.pixels(); ++i) {
      double all = 0;
      for (size_t c = 0; c < 3; ++c) {
        const double d = std::log(got.intrinsic[4 * i + c] + 1e-3) -
                         std::log(expected.reflectance[3 * i + c] + 1e-3);
        r2 += d * d / 3;
        all += expected.indirect[3 * i + c] / 3;
      }
      all += expected.direct[i];
      const double d = double(got.light[4 * i + 3]) * got.intrinsic[4 * i + 3] - expected.direct[i];
      d2 += d * d;
      (void)all;
    }
    const double n = double(extent.pixels());
    printf("%ux%u amount %.4f %.4f colors %u %d tint %.4f %.4f  R %.4g T0 %.4g\n", extent.width,
           extent.height, got.found.amount, expected.amount.value, got.found.colors,
           expected.colors.used(), got.found.tint, expected.tint, std::sqrt(r2 / n),
           std::sqrt(d2 / n));
    EXPECT_LT(std::sqrt(r2 / n), 5e-3);
    EXPECT_LT(std::sqrt(d2 / n), 5e-3);
  }
}

}  // namespace inverse::testing
