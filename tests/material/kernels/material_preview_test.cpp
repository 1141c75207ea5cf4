// SPDX-License-Identifier: LGPL-2.1-or-later
// The sphere that wears a material.
#include "kernels/material/preview/material_preview.hpp"

#include <cmath>

#include "materials.hpp"
#include "tests/kernels/gpu_fixture.hpp"

namespace inverse::testing {

class PreviewTest : public GpuTest {};

TEST_F(PreviewTest, DrawsASphereIntoTheCorner) {
  const Extent extent{83, 61};
  const Pixels pixels = random_pixels(extent, 3);
  MaterialPreview preview(device);
  Material m = material(.8F, 0, 2);
  const auto white = std::make_shared<const Environment>(Environment::uniform({1, 1, 1}));
  const Plane frame = plane(extent, pixels), picture = plane(extent);
  run([&](gpu::Commands& commands) { preview.record(commands, frame, m, white, .5F, picture); });
  const Pixels got = download(picture);
  const double diameter = .5 * 61, off = diameter * (.5 + .06 * .5);
  const double x0 = 83 - off, y0 = 61 - off, radius = diameter / 2;
  int inside = 0, edge = 0;
  for (size_t i = 0; i < extent.pixels(); ++i) {
    const double x = static_cast<double>(i % extent.width) + .5 - x0;
    const double y = static_cast<double>(i / extent.width) + .5 - y0;
    const double covered = std::clamp(.5 + radius - std::hypot(x, y), 0., 1.);
    inside += covered == 1;
    edge += covered > 0 && covered < 1;
    for (size_t c = 0; c < 3; ++c) {
      // A dull thing under even light has the color of its albedo.
      const double want = (1 - covered) * static_cast<double>(pixels[4 * i + c]) +
                          covered * static_cast<double>(m.diffuse[c]);
      ASSERT_NEAR(got[4 * i + c], want, .01) << i;
    }
    EXPECT_EQ(got[4 * i + 3], pixels[4 * i + 3]) << "alpha";
  }
  EXPECT_GT(inside, 500);
  EXPECT_GT(edge, 50) << "soft";
}

TEST_F(PreviewTest, IsDrawnAgainOnlyIfVisible) {
  const Extent extent{40, 30};
  const Plane frame = plane(extent, random_pixels(extent, 4)), picture = plane(extent);
  MaterialPreview preview(device);
  const auto light = [](float radiance) {
    return std::make_shared<const Environment>(
        Environment::uniform({radiance, radiance, radiance}));
  };
  const auto drawn = [&](const Material& m, const std::shared_ptr<const Environment>& lit_by) {
    run([&](gpu::Commands& commands) { preview.record(commands, frame, m, lit_by, .8F, picture); });
    return download(picture);
  };
  Material m = material(.5F, .3F, 5);
  const Pixels first = drawn(m, light(1));
  m.diffuse[0] += 4e-4F;
  m.specular -= 7e-4F;
  m.bins[5] -= .002F;
  m.bins[6] += .002F;
  EXPECT_EQ(drawn(m, light(1.004F)), first) << "less than half a code value";
  Pixels redder;
  for (int i = 0; i < 5; ++i) {
    m.diffuse[0] += 5e-4F;
    redder = drawn(m, light(1));
  }
  EXPECT_NE(redder, first) << "small steps add up";
  EXPECT_NE(drawn(m, light(1.1F)), redder);
  EXPECT_NE(drawn(m, nullptr), redder) << "the studio's light";
}

TEST_F(PreviewTest, HasAPictureAtEverySize) {
  MaterialPreview preview(device);
  for (const Extent extent : kOddSizes)
    for (const float size : {.02F, .3F, 1.F}) {
      const Plane frame = plane(extent, random_pixels(extent, 5)), picture = plane(extent);
      run([&](gpu::Commands& commands) {
        preview.record(commands, frame, material(.5F, .4F, 7), nullptr, size, picture);
      });
      ASSERT_TRUE(are_light(download(picture)));
    }
}

}  // namespace inverse::testing
