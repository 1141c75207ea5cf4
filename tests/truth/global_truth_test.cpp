// SPDX-License-Identifier: LGPL-2.1-or-later
// globalintrinsic against truth: a room with a colored wall and colored things on the floor,
// rendered with three bounces. The renderer is the bundled clip's, the room no other test's or
// training's.
#include "kernels/global/global_intrinsic.hpp"
#include "tests/bench/metrics/metrics.hpp"
#include "tests/kernels/gpu_fixture.hpp"
#include "tests/srgb.hpp"
#include "tools/clip/denoise.hpp"
#include "tools/clip/transport.hpp"

namespace inverse::testing {
namespace {

using bench::Image;
using clip::Paint;
using clip::Pattern;
using clip::Shape;

constexpr int kWidth = 160, kHeight = 120;

Paint plain(clip::Vec3 color) { return {Pattern::kPlain, {color}, 1, ""}; }

/// A green wall on the right, a red box on the left, a white and an ocher thing between.
clip::Scene room() {
  const clip::Frame facing = clip::rotation({1, 0, 0}, clip::kPi / 2),
                    aside = clip::rotation({0, 0, 1}, clip::kPi / 2);
  clip::Scene scene;
  scene.primitives = {
      {Shape::kRectangle, {3, 0, 2}, {0, 0.8F, -0.6F}, facing, plain({0.62F, 0.6F, 0.56F})},
      {Shape::kRectangle,
       {3, 0, 3},
       {0, 0, 1},
       {},
       {Pattern::kChecker,
        {{0.6F, 0.58F, 0.54F}, {0.36F, 0.35F, 0.34F}, {0.5F, 0.42F, 0.3F}},
        0.17F,
        ""}},
      {Shape::kRectangle, {2, 0, 2}, {0.72F, 0.5F, 0}, aside, plain({0.12F, 0.55F, 0.18F})},
      {Shape::kBox,
       {0.15F, 0.22F, 0.12F},
       {-0.42F, 0.22F, -0.12F},
       clip::rotation({0, 1, 0}, 0.45F),
       plain({0.72F, 0.1F, 0.08F})},
      {Shape::kEllipsoid,
       {0.13F, 0.13F, 0.13F},
       {0.04F, 0.13F, 0.1F},
       {},
       plain({0.78F, 0.77F, 0.74F})},
      {Shape::kTorus, {0.11F, 0.045F, 0}, {0.38F, 0.045F, 0.22F}, {}, plain({0.7F, 0.45F, 0.1F})},
      {Shape::kVase, {0.36F, 0, 0}, {0.34F, 0, -0.28F}, {}, plain({0.25F, 0.3F, 0.62F})}};
  scene.lamp = {{-0.7F, 1.15F, 0.85F}, 0.02F, 1.2F};
  scene.window = {{-1.6F, 0.3F, 0.2F}, {0, 1.1F, 0}, {0, 0, 1.1F}, 0.25F};
  scene.camera = {{0.02F, 0.55F, 1.65F}, {0.02F, 0.22F, -0.1F}, 0.6F};
  return scene;
}

struct Truth {
  Image reflectance{kWidth, kHeight, 3}, shading{kWidth, kHeight, 1}, direct{kWidth, kHeight, 3},
      indirect{kWidth, kHeight, 3};
  Pixels frame = Pixels(4 * kWidth * kHeight, 1);
};

const Truth& truth() {
  static const Truth made = [] {
    constexpr int kThreads = 2;
    clip::Layers layers = clip::render(room(), kWidth, kHeight, {16, 8, 3}, kThreads);
    clip::denoise(layers, 4, kThreads);
    Truth t;
    for (size_t i = 0; i < layers.reflectance.size(); ++i)
      for (int c = 0; c < 3; ++c) {
        const size_t k = 3 * i + static_cast<size_t>(c);
        t.reflectance.data[k] = layers.reflectance[i][c];
        t.direct.data[k] = layers.lamp[i][c] + layers.window[i];
        t.indirect.data[k] = layers.indirect[i][c];
        const float light = t.direct.data[k] + t.indirect.data[k];
        t.shading.data[i] += std::array{0.2126F, 0.7152F, 0.0722F}[static_cast<size_t>(c)] * light;
        const float code = srgb_code(std::min(layers.reflectance[i][c] * light, 1.0F));
        t.frame[4 * i + static_cast<size_t>(c)] = srgb_light(std::round(255 * code) / 255);
      }
    return t;
  }();
  return made;
}

class GlobalTruth : public GpuTest {
 protected:
  struct Errors {
    double lmse;      ///< of reflectance and shading
    double indirect;  ///< relative, of indirect light at its own scale
    double split;     ///< the same of direct and indirect light at one scale, summed
    double tint;      ///< of the light's color, log units
  };
  /// What is allowed: 5 % above 0.02083, 0.0898, 0.4102 and 0.1302, which were reached.
  static constexpr Errors kMaxErrors{0.0219, 0.0943, 0.4307, 0.1367};
  /// Of a first frame. `slope` of the color of light: the scene's lights are white, and with their
  /// bounces it is -.03; empty: measured.
  Errors errors(GlobalIntrinsic::Params params, std::optional<float> slope = 0.0F) {
    params.light.slope = slope;
    const Extent extent{kWidth, kHeight};
    GlobalIntrinsic method(device, extent);
    const auto frame = std::make_shared<Plane>(plane(extent, truth().frame));
    Layers layers;
    run([&](gpu::Commands& commands) { layers = method.record(commands, frame, params, {true}); });
    const Pixels intrinsic = download(layers[Role::intrinsic]),
                 light = download(layers[Role::light]);
    Truth got;
    for (size_t i = 0; i < extent.pixels(); ++i)
      for (size_t c = 0; c < 3; ++c) {
        const float shading = intrinsic[4 * i + 3];
        got.reflectance.data[3 * i + c] = intrinsic[4 * i + c];
        got.direct.data[3 * i + c] = shading * light[4 * i + 3];
        got.indirect.data[3 * i + c] = shading * (light[4 * i + c] - light[4 * i + 3]);
        got.shading.data[i] +=
            std::array{0.2126F, 0.7152F, 0.0722F}[c] * shading * light[4 * i + c];
      }
    const bench::LayerScores parts =
        bench::score_layers(got.direct, got.indirect, truth().direct, truth().indirect, Image());
    const Errors e{bench::score_lmse(got.reflectance, got.shading, truth().reflectance,
                                     truth().shading, Image()),
                   parts.ind, parts.dir_j + parts.ind_j, parts.tint};
    printf("  LMSE %.5f, indirect light %.4f, split %.4f, tint %.4f\n", e.lmse, e.indirect, e.split,
           e.tint);
    return e;
  }
};

TEST_F(GlobalTruth, ReflectanceAndLightAreAsNearAsTheyWere) {
  const Errors e = errors({});
  EXPECT_LT(e.lmse, kMaxErrors.lmse);
  EXPECT_LT(e.indirect, kMaxErrors.indirect);
  EXPECT_LT(e.split, kMaxErrors.split);
  EXPECT_LT(e.tint, kMaxErrors.tint);
}

TEST_F(GlobalTruth, AMeasuredSlopeCostsLittle) {
  const Errors e = errors({}, {});
  EXPECT_LT(e.lmse, 1.1 * kMaxErrors.lmse);
  EXPECT_LT(e.indirect, 1.3 * kMaxErrors.indirect);
  EXPECT_LT(e.split, kMaxErrors.split);
  EXPECT_LT(e.tint, 1.35 * kMaxErrors.tint);
}

TEST_F(GlobalTruth, EveryPartOfTheMethodIsNeededForThat) {
  using Set = void (*)(GlobalIntrinsic::Params&);
  const std::pair<const char*, Set> without[] = {
      {"half the amount", [](auto& p) { p.amount = 0.25F; }},
      {"no residual", [](auto& p) { p.residual = 0; }},
      {"a surface lights itself", [](auto& p) { p.own = 0; }},
      {"no near light", [](auto& p) { p.near_share = 0; }},
      {"half the cycles", [](auto& p) { p.cycles /= 2; }}};
  for (const auto& [name, leave_out] : without) {
    GlobalIntrinsic::Params params;
    leave_out(params);
    const Errors e = errors(params);
    EXPECT_TRUE(e.lmse > kMaxErrors.lmse || e.indirect > kMaxErrors.indirect ||
                e.split > kMaxErrors.split || e.tint > kMaxErrors.tint)
        << name;
  }
}

}  // namespace
}  // namespace inverse::testing
