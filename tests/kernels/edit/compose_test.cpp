// SPDX-License-Identifier: LGPL-2.1-or-later
// Composing against its specification, on ordinary and on hostile layers.
#include "kernels/edit/compose.hpp"

#include "tests/differences.hpp"
#include "tests/kernels/edit/edit_fixture.hpp"
#include "tests/reference/edit/edit.hpp"
#include "tests/reference/image/light_color.hpp"

namespace inverse::testing {

using ComposeTest = EditorTest;

TEST_F(ComposeTest, ComposeAgreesWithReference) {
  for (const Extent extent : kOddSizes)
    for (const auto& [hostile, color] : {std::pair{false, reference::LightColor{}},
                                         {true, {}},
                                         {false, {0.6, 0, -0.3}},
                                         {false, {-1.2, 0, 0.2}}}) {
      const Pixels input = any_pixels(extent, 1, hostile), model = any_pixels(extent, 2, hostile),
                   intrinsic = any_pixels(extent, 3, hostile);
      Layers frame;
      frame.extent = extent;
      frame[Role::input] = shared_plane(extent, input);
      frame[Role::model] = shared_plane(extent, model);
      frame[Role::intrinsic] = shared_plane(extent, intrinsic);
      if (color.slope != 0)
        frame[Role::slope] = shared_plane({1, 1}, {float(color.slope), float(color.white), 1, 0});
      const reference::LightColor light = color;
      const auto seen = [&](const Pixels& pixels, size_t n) {
        return light.slope != 0 ? reference::in_gray_light(pixel_of(pixels, n), light)
                                : pixel_of(pixels, n);
      };
      Compose compose(device, extent);
      // Sums of numbers up to 65504² lose the small ones.
      const double tolerance = hostile ? 1e-2 : 1e-5;
      for (const Residual residual : {Residual::add, Residual::ratio, Residual::none})
        for (const float strength : {1.0f, 0.4f}) {
          const Pixels got = result_of([&](gpu::Commands& commands) {
            return compose.record(commands, frame, {residual, strength});
          });
          ASSERT_NO_FATAL_FAILURE(expect_pixels(
              got,
              [&](size_t n) {
                const auto in = pixel_of(input, n), before = seen(model, n),
                           now = seen(intrinsic, n);
                reference::Rgba wanted = reference::compose(
                    in, before, now, static_cast<reference::Residual>(residual), strength);
                // Where two huge products cancel, single precision keeps nothing to compare.
                for (int c = 0; c < 3; ++c)
                  if (reference::finite(before)[c] * reference::finite(before)[3] > 1e4 &&
                      residual != Residual::none)
                    wanted[c] = got[4 * n + c];
                return wanted;
              },
              tolerance, hostile ? "hostile" : "random"));
        }
      ASSERT_NO_FATAL_FAILURE(expect_pixels(
          result_of(
              [&](gpu::Commands& commands) { return compose.record_difference(commands, frame); }),
          [&](size_t n) {
            return reference::difference(pixel_of(input, n), seen(model, n), seen(intrinsic, n));
          },
          tolerance, "difference"));
    }
}

TEST_F(ComposeTest, UneditedLayersGiveTheInputsOwnPlane) {
  Layers frame = layers({15, 10}, random_pixels({15, 10}, 6));
  Compose compose(device, frame.extent);
  run([&](gpu::Commands& commands) {
    for (const Residual residual : {Residual::add, Residual::ratio})
      EXPECT_EQ(compose.record(commands, frame, {residual, 1}), frame[Role::input]);
    EXPECT_EQ(compose.record(commands, frame, {Residual::none, 0}), frame[Role::input]);
    EXPECT_EQ(commands.dispatches(), 0u);
  });
}

TEST_F(ComposeTest, EqualCopiesGiveTheInputBack) {
  // An edit that changed nothing, bit by bit: the picture is the input but for rounding.
  const Extent extent{349, 287};
  const Pixels intrinsic = random_pixels(extent, 12, 0, 2);
  Layers frame = layers(extent, intrinsic);
  frame[Role::intrinsic] = shared_plane(extent, intrinsic);
  Compose compose(device, extent);
  const Pixels input = download(frame[Role::input]);
  for (const Residual residual : {Residual::add, Residual::ratio}) {
    const Pixels got = result_of([&](gpu::Commands& commands) {
      return compose.record(commands, frame, {residual, 1});
    });
    EXPECT_LE(max_difference(got, input), 1e-6);
  }
}

TEST_F(ComposeTest, DiffuseAndSpecularAreTheFrameAgain) {
  for (const Extent extent : kOddSizes)
    for (const bool hostile : {false, true}) {
      const Pixels input = any_pixels(extent, 1, hostile), diffuse = any_pixels(extent, 2, hostile),
                   specular = any_pixels(extent, 3, hostile);
      const Layers frame =
          material_layers(shared_plane(extent, input), shared_plane(extent, diffuse),
                          shared_plane(extent, specular));
      Compose compose(device, extent);
      const double tolerance = hostile ? 1e-2 : 1e-5;  // sums of large numbers lose small ones
      for (const float strength : {1.0f, 0.4f, 0.0f}) {
        PlanePtr picture;
        run([&](gpu::Commands& commands) {
          picture = compose.record(commands, frame, {Residual::add, strength});
        });
        if (strength == 0) {
          EXPECT_EQ(picture, frame[Role::input]);
          continue;
        }
        ASSERT_NO_FATAL_FAILURE(expect_pixels(
            download(picture),
            [&](size_t n) {
              return reference::recombine(pixel_of(input, n), pixel_of(diffuse, n),
                                          pixel_of(specular, n), strength);
            },
            tolerance, "recombined"));
      }
      ASSERT_NO_FATAL_FAILURE(expect_pixels(
          result_of(
              [&](gpu::Commands& commands) { return compose.record_difference(commands, frame); }),
          [&](size_t n) {
            return reference::recombine_difference(pixel_of(input, n), pixel_of(diffuse, n),
                                                   pixel_of(specular, n));
          },
          tolerance, "difference"));
    }
}

TEST_F(ComposeTest, MaskIsDrawnAsGray) {
  const Extent extent{17, 5};
  const Pixels matte = random_pixels(extent, 9);
  Layers frame = layers(extent, random_pixels(extent, 10));
  frame[Role::mask] = shared_plane(extent, matte);
  const Pixels input = download(frame[Role::input]);
  Compose compose(device, extent);
  expect_pixels(
      result_of([&](gpu::Commands& commands) { return compose.record_mask(commands, frame); }),
      [&](size_t n) -> reference::Rgba {
        return {matte[4 * n], matte[4 * n], matte[4 * n], input[4 * n + 3]};
      },
      0, "mask");
}

}  // namespace inverse::testing
