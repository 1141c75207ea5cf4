// SPDX-License-Identifier: LGPL-2.1-or-later
// A picture on a plane against its specification, on ordinary and on hostile layers.
#include "tests/texture/reference/texture.hpp"

#include "kernels/texture/plane_luminance.hpp"
#include "kernels/texture/texture_edit.hpp"
#include "tests/kernels/edit/edit_fixture.hpp"
#include "tests/update_max.hpp"

namespace inverse::testing {
namespace {

using reference::Grid;
using reference::Rgba;

Grid<Rgba> grid_of(Extent extent, const Pixels& pixels) {
  return {extent.width, extent.height, reference_of(pixels)};
}

reference::Matrix matrix_of(const Homography& h) {
  return {{{h[0], h[1], h[2]}, {h[3], h[4], h[5]}, {h[6], h[7], h[8]}}};
}

/// A quadrilateral in perspective in the middle of a frame, or the whole frame.
Corners corners_in(Extent extent, bool whole) {
  const double w = extent.width, h = extent.height;
  if (whole || w < 12 || h < 8)
    return {{{-2.0, -2.0}, {w + 2, -2.0}, {w + 2, h + 2}, {-2.0, h + 2}}};
  return {{{0.21 * w, 0.13 * h}, {0.78 * w, 0.27 * h}, {0.71 * w, 0.83 * h}, {0.17 * w, 0.91 * h}}};
}

}  // namespace

class TextureTest : public GpuTest {
 protected:
  TexturePyramid pyramid(Extent extent, const Pixels& pixels) {
    TexturePyramid pyramid(device, extent);
    const Plane picture = plane(extent, pixels);
    run([&](gpu::Commands& commands) { pyramid.record(commands, picture); });
    return pyramid;
  }
  Layers layers(Extent extent, const Pixels& pixels) {
    Layers result{extent, {}};
    result[Role::input] = result[Role::model] = result[Role::intrinsic] =
        shared_plane(extent, pixels);
    return result;
  }
};

TEST_F(TextureTest, LuminanceAgreesWithReference) {
  for (const Extent extent : {Extent{1, 1}, {17, 5}, {349, 287}, {1921, 3}, {3, 4001}})
    for (const bool hostile : {false, true}) {
      const Pixels pixels = any_pixels(extent, 3, hostile);
      PlaneLuminance reduce(device, extent);
      EXPECT_EQ(reduce.factor(), extent.width == 1921 ? 3U : extent.height == 4001 ? 5U : 1U);
      const Plane frame = plane(extent, pixels);
      run([&](gpu::Commands& commands) { reduce.record(commands, frame); });
      const auto expected = reference::luminance(grid_of(extent, pixels), reduce.factor());
      const auto got = reduce.values();
      ASSERT_EQ(got.size(), expected.data.size());
      for (size_t n = 0; n < got.size(); ++n) ASSERT_NEAR(got[n], expected.data[n], 1e-4) << n;
    }
}

TEST_F(TextureTest, LevelsAgreeWithReference) {
  for (const Extent extent : {Extent{1, 1}, {2, 1}, {3, 5}, {64, 48}, {349, 287}, {1, 777}})
    for (const bool hostile : {false, true}) {
      const Pixels pixels = any_pixels(extent, 5, hostile);
      const TexturePyramid got = pyramid(extent, pixels);
      const auto expected = reference::texture_levels(grid_of(extent, pixels));
      ASSERT_EQ(got.levels(), expected.size());
      const Pixels texels = download(got.buffer());
      size_t n = 0;
      for (const auto& level : expected)
        for (const Rgba& texel : level.data)
          for (size_t c = 0; c < 4; ++c, ++n)
            ASSERT_NEAR(texels[n], texel[c], 1e-4 * (1 + texel[c])) << name_of(extent) << " " << n;
      EXPECT_EQ(n, texels.size());
    }
}

TEST_F(TextureTest, DrawAgreesWithReference) {
  for (const Extent extent : {Extent{1, 1}, {2, 3}, {17, 5}, {64, 48}, {349, 287}})
    for (const Extent picture : {Extent{1, 1}, {64, 48}, {400, 30}})
      for (const bool hostile : {false, true})
        for (const bool masked : {false, true}) {
          const Pixels pixels = any_pixels(extent, 7, hostile);
          const Pixels texels = any_pixels(picture, 8, hostile);
          const Pixels mask = any_pixels(extent, 9, hostile);
          const Corners corners = corners_in(extent, hostile && masked);
          Layers frame = layers(extent, pixels);
          if (masked) frame[Role::mask] = shared_plane(extent, mask);
          const TextureParams params{.white = 0.8F, .opacity = 0.7F, .occlusion = false};
          const TexturePyramid levels = pyramid(picture, texels);
          TextureEdit edit(device, extent);
          run([&](gpu::Commands& commands) {
            edit.record(commands, frame, levels, corners, params);
          });
          const Pixels got = download(frame[Role::intrinsic]);
          const reference::TextureSpec spec{matrix_of(to_square(corners)), double{0.8F},
                                            double{0.7F}};
          const auto expected = reference::texture_levels(grid_of(picture, texels));
          for (size_t n = 0; n < extent.pixels(); ++n) {
            const size_t x = n % extent.width, y = n / extent.width;
            if (reference::off_whole_taps(x, y, expected[0], spec) < 1e-3) continue;
            const Rgba wanted = reference::draw_texture(
                grid_of({1, 1}, {pixels.begin() + long(4 * n), pixels.begin() + long(4 * n + 4)})
                    .data[0],
                x, y, masked ? double{mask[4 * n]} : 1, expected, nullptr, spec);
            for (size_t c = 0; c < 4; ++c)
              ASSERT_NEAR(got[4 * n + c], wanted[c],
                          (hostile ? 2e-3 : 1e-3) * (1 + std::abs(wanted[c])) +
                              (hostile ? 0.02 * double{65504} * 0.7 * 1e-2 : 0))
                  << name_of(extent) << " picture " << name_of(picture) << " at " << x << "," << y;
          }
        }
}

TEST_F(TextureTest, WhatStandsBeforeThePlaneAgreesWithReference) {
  const Extent extent{64, 48};
  for (const bool hostile : {false, true}) {
    const Corners corners = corners_in(extent, false);
    const Extent size = TextureEdit::cells_of(corners);
    ASSERT_GT(size.pixels(), 300U);
    const TextureParams params;
    TextureEdit edit(device, extent);
    const TexturePyramid picture = pyramid({1, 1}, {1, 1, 1, 1});
    std::vector<reference::Cell> cells(size.pixels());
    Pixels pixels = any_pixels(extent, 11, false);
    for (float& p : pixels) p = 0.5F + 0.01F * p;
    for (int t = 0; t < 6; ++t) {
      Pixels now = t == 1 && hostile ? any_pixels(extent, 12, true) : pixels;
      if (t > 2)  // something dark stands before its left half
        for (size_t n = 0; n < extent.pixels(); ++n)
          if (n % extent.width < 30)
            for (size_t c = 0; c < 3; ++c) now[4 * n + c] = 0.05F;
      Layers frame = layers(extent, now);
      run([&](gpu::Commands& commands) { edit.record(commands, frame, picture, corners, params); });
      const auto model = grid_of(extent, now);
      Grid<double> excess{size.width, size.height, {}};
      std::vector<reference::Observed> observed;
      for (size_t n = 0; n < cells.size(); ++n) {
        observed.push_back(reference::observe(model, matrix_of(square_to(corners)), n % size.width,
                                              n / size.width, {size.width, size.height}));
        excess.data.push_back(reference::excess(observed[n], cells[n]));
      }
      const auto hidden =
          reference::hide(excess, double{params.tolerance}, double{params.softness});
      for (size_t n = 0; n < cells.size(); ++n)
        reference::learn(cells[n], observed[n], hidden.data[n]);
      const auto expected = reference::soften(hidden);
      const Pixels got = download(edit.hidden());
      double sum = 0;
      for (size_t n = 0; n < cells.size(); ++n) {
        ASSERT_NEAR(got[n], expected.data[n], 5e-3) << "frame " << t << ", cell " << n;
        sum += double{got[n]};
      }
      const reference::TextureSpec spec{matrix_of(to_square(corners)), double{params.white}, 1};
      const auto texels = reference::texture_levels(grid_of({1, 1}, {1, 1, 1, 1}));
      const Pixels drawn = download(frame[Role::intrinsic]);
      for (size_t n = 0; n < extent.pixels() && !hostile; ++n) {
        const Rgba wanted = reference::draw_texture(model.data[n], n % extent.width,
                                                    n / extent.width, 1, texels, &expected, spec);
        for (size_t c = 0; c < 4; ++c) ASSERT_NEAR(drawn[4 * n + c], wanted[c], 5e-3) << n;
      }
      if (!hostile) {
        const double share = sum / static_cast<double>(cells.size());
        EXPECT_NEAR(share, t > 2 ? 0.5 : 0, t > 2 ? 0.2 : 0) << t;
      }
    }
  }
}

TEST_F(TextureTest, AChangeThatLastsIsLearned) {
  const Extent extent{16, 16};
  TextureEdit edit(device, extent);
  const TexturePyramid picture = pyramid({1, 1}, {1, 1, 1, 1});
  const auto hidden_by = [&](float reflectance) {
    Layers frame = layers(extent, Pixels(4 * extent.pixels(), reflectance));
    run([&](gpu::Commands& commands) {
      edit.record(commands, frame, picture, corners_in(extent, true), {});
    });
    return download(edit.hidden())[edit.hidden()->count() / 2 + 4];
  };
  EXPECT_EQ(hidden_by(0.5F), 0);
  int frames = 0;
  while (hidden_by(0.3F) > 0.5F && frames < 1000) ++frames;
  EXPECT_GT(frames, 20) << "somebody who stands still for a second is learned";
  EXPECT_LT(frames, 400);
  edit.forget();
  EXPECT_EQ(hidden_by(2.0F), 0) << "nothing is learned yet";
}

TEST_F(TextureTest, NothingIsDoneWithoutOpacityAndOthersPlanesStay) {
  const Extent extent{64, 48};
  const TexturePyramid picture = pyramid({4, 4}, random_pixels({4, 4}, 1));
  const Pixels pixels = random_pixels(extent, 2);
  Layers frame = layers(extent, pixels);
  TextureEdit edit(device, extent);
  run([&](gpu::Commands& commands) {
    const uint32_t before = commands.dispatches();
    for (const float opacity : {0.0F, -1.0F, kNan})
      edit.record(commands, frame, picture, corners_in(extent, false), {.opacity = opacity});
    EXPECT_EQ(commands.dispatches(), before);
    EXPECT_EQ(frame[Role::intrinsic], frame[Role::model]);
    edit.record(commands, frame, picture, corners_in(extent, false), {});
  });
  EXPECT_NE(frame[Role::intrinsic], frame[Role::model]);
  EXPECT_EQ(download(frame[Role::model]), pixels);
  // The second edit owns its plane: it works in place, on the rows of the quadrilateral alone.
  const PlanePtr own = frame[Role::intrinsic];
  const Plane* place = own.get();
  const Pixels once = download(own);
  frame[Role::intrinsic] = nullptr;
  Layers again = frame;
  again[Role::intrinsic] = std::move(const_cast<PlanePtr&>(own));
  run([&](gpu::Commands& commands) {
    edit.record(commands, again, picture, corners_in(extent, false), {});
  });
  EXPECT_EQ(again[Role::intrinsic].get(), place);
  const Pixels twice = download(again[Role::intrinsic]);
  double difference = 0;
  for (size_t i = 0; i < twice.size(); ++i)
    update_max(difference, std::abs(double{twice[i]} - double{once[i]}));
  EXPECT_LT(difference, 0.26) << "opaque paint over the same paint changes edges alone";
}

TEST(Quad, SaysWhatIsWrongWithCorners) {
  const Corners good{{{10, 10}, {90, 20}, {80, 70}, {5, 60}}};
  EXPECT_EQ(wrong_corners(good), "");
  const auto with = [&](size_t k, Point p) {
    Corners corners = good;
    corners[k] = p;
    return wrong_corners(corners);
  };
  EXPECT_EQ(with(0, {-50, -70}), "") << "outside of the picture";
  EXPECT_NE(with(2, {20, 20}), "") << "concave";
  EXPECT_NE(with(1, {45, 40}), "") << "three on a line";
  EXPECT_NE(with(2, {std::nan(""), 0}), "");
  EXPECT_NE(with(2, {1e9, 0}), "");
  EXPECT_NE(wrong_corners({{{10, 10}, {90, 20}, {5, 60}, {80, 70}}}), "") << "crossed";
  EXPECT_NE(wrong_corners({}), "");
  EXPECT_EQ(wrong_corners({{good[1], good[0], good[3], good[2]}}), "") << "mirrored";
  for (const Corners& corners : {good, Corners{{good[1], good[0], good[3], good[2]}}}) {
    const Homography there = square_to(corners), back = to_square(corners);
    for (const Point& p : {Point{0, 0}, {1, 0}, {0.3, 0.8}}) {
      const Point at = mapped(there, p), again = mapped(back, at);
      EXPECT_NEAR(again[0], p[0], 1e-9);
      EXPECT_NEAR(again[1], p[1], 1e-9);
      EXPECT_GT(back[6] * at[0] + back[7] * at[1] + back[8], 0);
    }
    const Point corner = mapped(there, {1, 1});
    EXPECT_NEAR(corner[0], corners[2][0], 1e-9);
    EXPECT_NEAR(corner[1], corners[2][1], 1e-9);
  }
}

}  // namespace inverse::testing
