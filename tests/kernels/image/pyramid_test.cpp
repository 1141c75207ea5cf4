// SPDX-License-Identifier: LGPL-2.1-or-later
#include "kernels/image/pyramid.hpp"

#include "tests/kernels/gpu_fixture.hpp"
#include "tests/reference/image/pyramid.hpp"

namespace inverse::testing {

class PyramidTest : public GpuTest {};

TEST_F(PyramidTest, HalveAgreesWithReferenceOnOddSizes) {
  const Halve halve(device);
  for (const Extent extent : kOddSizes) {
    const Pixels pixels = random_pixels(extent, extent.width);
    const Plane fine = plane(extent, pixels), coarse = plane(half_of(extent));
    run([&](gpu::Commands& commands) { halve.record(commands, fine, coarse); });
    const auto expected =
        reference::halve({pixels.begin(), pixels.end()}, extent.width, extent.height, 4);
    const Pixels got = download(coarse);
    ASSERT_EQ(got.size(), expected.size());
    for (size_t i = 0; i < got.size(); ++i)
      ASSERT_NEAR(got[i], expected[i], 1e-6) << extent.width << " at " << i;
  }
}

}  // namespace inverse::testing
