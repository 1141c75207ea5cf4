// SPDX-License-Identifier: LGPL-2.1-or-later
// The output's scale and the fade between resolutions against their reference.
#include "tests/reference/intrinsic/layers.hpp"

#include "kernels/image/pack4.hpp"
#include "kernels/intrinsic/resolution/layer_fade.hpp"
#include "kernels/intrinsic_output_layers.spv.hpp"
#include "tests/kernels/gpu_fixture.hpp"

namespace inverse::testing {
namespace {

const std::vector<Extent> kSizes = {{1, 1}, {7, 3}, {37, 22}};
constexpr double kTolerance = 3e-5;

/// Random pixels with black, NaN, infinite, negative and huge ones among them.
Pixels extreme_pixels(Extent extent, unsigned seed) {
  Pixels pixels = random_pixels(extent, seed);
  const float values[] = {0, kNan, kInf, -kInf, -1, 1e9F, 1e-30F};
  for (size_t i = 0; i < pixels.size(); i += 11) pixels[i] = values[i / 11 % std::size(values)];
  return pixels;
}

/// Layers whose log shading is in ±`range`.
Pixels random_layers(Extent extent, unsigned seed, float range) {
  Pixels layers = random_pixels(extent, seed, -range, range);
  for (float& value : layers) value = std::exp(value);
  return layers;
}

}  // namespace

class LayersTest : public GpuTest {};

TEST_F(LayersTest, OutputScaleAgreesWithReference) {
  using Shader = shaders::intrinsic_output_layers;
  const gpu::Program<Shader> gray(device), colored(device, {.colored = true});
  for (const Extent size : kSizes)
    for (const auto& [log_scale, light] : {std::pair{0.0F, reference::LightColor{}},
                                           {0.7F, {}},
                                           {-30.0F, {}},
                                           {30.0F, {}},
                                           {0.7F, {0.6, 0, -1}},
                                           {-3.0F, {-1.2, 0, 0.5}}}) {
      const Pixels frame = extreme_pixels(size, 3);
      const uint64_t packs = pack4_count(size);
      Pixels shading = random_pixels({uint32_t(packs), 1}, 4, -30, 30);
      const auto zeros = [&](uint64_t count) { return upload(Pixels(4 * count)); };
      const auto field = upload(shading);
      const auto memory = zeros(packs * Shader::MEMORY_STRIDE);
      const auto intrinsic = zeros(size.pixels());
      run([&](gpu::Commands& commands) {
        commands.dispatch(light.slope != 0 ? colored : gray,
                          {.frame = plane(size, frame).buffer,
                           .cells = zeros(size.pixels() * Shader::CELL_STRIDE),
                           .guide_coarse = zeros(size.pixels()),
                           .scale = upload({log_scale, 1, 0, 0}),
                           .start = zeros(packs * Shader::START_STRIDE),
                           .before = zeros(packs * Shader::MEMORY_STRIDE),
                           .now = memory,
                           .shading = field,
                           .memory = gpu::aliased(memory),
                           .new_shading = gpu::aliased(field),
                           .cell_history = zeros(size.pixels()),
                           .intrinsic = intrinsic,
                           .slope = upload({float(light.slope), float(light.white), 1, 0})},
                          {.size = size, .texture = 1}, line_of(packs));
      });
      reference::Plane expected = to_reference(size, frame);
      for (int y = 0; y < expected.height; ++y)
        for (int x = 0; x < expected.width; ++x) {
          const size_t pack = size_t(y) * pack4_count(size.width) + size_t(x) / 4;
          expected.at(x, y) = reference::layers_of(
              expected.at(x, y), double(shading[4 * pack + size_t(x) % 4]) - double(log_scale),
              light);
        }
      expect_near(download(intrinsic), expected, kTolerance,
                  std::to_string(size.width) + " wide, scale " + std::to_string(log_scale));
    }
}

TEST_F(LayersTest, FadeAgreesWithReference) {
  for (const Extent size : kSizes)
    for (const auto& [range, light] : {std::pair{1.0F, reference::LightColor{}},
                                       {25.0F, {}},
                                       {1.0F, {0.6, 0, -1}},
                                       {6.0F, {-1.2, 0, 0.5}},
                                       {6.0F, {2, 0, 0}}}) {
      const PlanePtr slope =
          light.slope != 0 ? shared_plane({1, 1}, {float(light.slope), float(light.white), 1, 0})
                           : nullptr;
      const Pixels frame = extreme_pixels(size, 5), shown = random_layers(size, 6, range),
                   now = random_layers(size, 7, range);
      // Some pixels stay, some change a little or much, and the solution goes on.
      Pixels later = frame;
      for (size_t i = 0; i < later.size(); ++i) later[i] *= i % 3 ? 1 : 1 + 0.2F * float(i % 8);
      Pixels solution = random_layers(size, 8, range);
      solution[3] = 0;  // no light at all
      LayerFade fade(device, size);
      double share = 1;
      run([&](gpu::Commands& commands) {
        fade.start(commands, shared_plane(size, frame), shared_plane(size, shown),
                   shared_plane(size, now));
      });
      for (int k = 0; k < 2; ++k) {
        share *= double(LayerFade::kShare);
        PlanePtr got;
        run([&](gpu::Commands& commands) {
          got =
              fade.record(commands, shared_plane(size, later), shared_plane(size, solution), slope);
        });
        const reference::Plane first = to_reference(size, frame), old = to_reference(size, shown),
                               base = to_reference(size, now), rgb = to_reference(size, later),
                               next = to_reference(size, solution);
        reference::Plane expected = rgb;
        for (size_t i = 0; i < expected.size(); ++i)
          expected.data[i] =
              reference::faded(reference::fade_from(first.data[i], old.data[i], base.data[i]),
                               share, rgb.data[i], next.data[i], light);
        expect_near(download(got), expected, kTolerance,
                    std::to_string(size.width) + " wide, frame " + std::to_string(k));
      }
    }
}

TEST_F(LayersTest, FadeTakesFramesOfMorePixelsThanALineOfWorkgroupsHas) {
  const Extent size{32767, 129};
  const auto all = [&](float r, float g, float b, float s) {
    Pixels pixels(4 * size.pixels());
    for (size_t i = 0; i < pixels.size(); i += 4)
      pixels[i] = r, pixels[i + 1] = g, pixels[i + 2] = b, pixels[i + 3] = s;
    return shared_plane(size, pixels);
  };
  const PlanePtr frame = all(0.2F, 0.2F, 0.2F, 1), shown = all(0.4F, 0.4F, 0.4F, 0.5F),
                 now = all(0.8F, 0.8F, 0.8F, 0.25F);
  LayerFade fade(device, size);
  PlanePtr got;
  run([&](gpu::Commands& commands) {
    fade.start(commands, frame, shown, now);
    got = fade.record(commands, frame, now, nullptr);
  });
  const Pixels faded = download(got->buffer);
  const float expected = 0.25F * std::pow(2.0F, float(LayerFade::kShare));
  for (const size_t pixel : {size_t{0}, size.pixels() / 2, size.pixels() - 1})
    EXPECT_NEAR(faded[4 * pixel + 3], expected, 1e-5F) << "pixel " << pixel;
}

}  // namespace inverse::testing
