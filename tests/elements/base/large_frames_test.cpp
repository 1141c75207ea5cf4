// SPDX-License-Identifier: LGPL-2.1-or-later
// Frames whose planes exceed what a kernel can bind on lavapipe, and lines of more workgroups than
// Vulkan allows: what comes out is the frame that went in, in all its rows.
#include "tests/elements/element_test.hpp"

namespace inverse::testing {
namespace {

struct Case {
  const char* line;
  const char* format;
  int width, height;
};

class LargeFrames : public ::testing::TestWithParam<Case> {};

TEST_P(LargeFrames, ComeOutAsTheyWentIn) {
  const auto& [line, format, width, height] = GetParam();
  const std::string caps = VideoHarness::caps(format, width, height);
  VideoHarness harness(line, caps, caps);
  const auto frame = random_frame(caps, 1);
  for (int n = 0; n < 2; ++n) {
    const auto out = harness.process(frame);
    ASSERT_EQ(out.size(), frame.size());
    EXPECT_LE(largest_difference(visible(caps, out), visible(caps, frame)), 1) << "frame " << n;
  }
  EXPECT_EQ(harness.errors(), std::vector<std::string>());
}

constexpr const char* kEdited =
    "intrinsicdecomp ! queue ! intrinsicrecolor strength=0 write-mask=true ! queue ! "
    "intrinsiccompose";
INSTANTIATE_TEST_SUITE_P(
    All, LargeFrames,
    ::testing::Values(Case{kEdited, "RGBA", 3840, 2160}, Case{kEdited, "RGB", 4096, 2160},
                      Case{"globalintrinsic ! intrinsiccompose", "RGBA", 4096, 2160},
                      Case{"limematerial ! intrinsiccompose", "RGBA", 4096, 2160},
                      Case{"intrinsicdecomp show=input", "GRAY8", 7680, 4320},
                      Case{kEdited, "RGBA", 32767, 1}, Case{kEdited, "RGBA", 1, 32767}));

}  // namespace
}  // namespace inverse::testing
