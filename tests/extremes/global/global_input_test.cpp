// SPDX-License-Identifier: LGPL-2.1-or-later
// Bad input, one by one and in seeded mixtures, for both global methods: finite, consistent layers.
#include <gtest/gtest.h>

#include <limits>

#include "global_methods.hpp"

namespace inverse::extremes {
namespace {

class GlobalInputs : public testing::TestWithParam<Solver> {
 protected:
  static const Lab& lab() {
    static const Lab lab;
    return lab;
  }
};

TEST_P(GlobalInputs, EveryFaultByItself) {
  const Check check = check_global_with(lab());
  for (uint32_t fault = 0; fault < kFaults; ++fault)
    for (const Extent extent : {Extent{1, 1}, Extent{2, 3}, Extent{31, 18}, Extent{1, 200}}) {
      const Case one{GetParam(), extent.width, extent.height, 3, fault + 1, 1U << fault, 0};
      const auto wrong = check(one);
      EXPECT_FALSE(wrong) << name_of(static_cast<Fault>(fault)) << ": " << one.text() << ": "
                          << *wrong;
    }
}

TEST_P(GlobalInputs, MixturesOfFaultsAndParameters) {
  const auto failure = first_failure(GetParam(), 1, 40, 48, check_global_with(lab()));
  EXPECT_FALSE(failure) << *failure;
}

TEST(GlobalInputsThatFailed, LightThatIsClippedAfterItsTintIsOut) {
  const Lab lab;
  const auto wrong =
      check_global_with(lab)(parse_case("global 1x2 frames=1 seed=1 faults=0x200 knobs=0x0"));
  EXPECT_FALSE(wrong) << *wrong;
}

TEST(GlobalInputsThatFailed, TheLargestFloatIsNotInfinite) {
  const Lab lab;
  constexpr float kLargest = std::numeric_limits<float>::max();
  constexpr float kInfinite = std::numeric_limits<float>::infinity();
  GlobalMethod method(lab, Solver::global_thesis, {1, 1});
  method.decompose({kLargest, kInfinite, 1e5F, 1});
  const Pixels taken = lab.download(method.thesis().image().buffer);
  EXPECT_EQ(taken, (Pixels{65504, 1, 65504, 1}));
}

INSTANTIATE_TEST_SUITE_P(All, GlobalInputs, testing::ValuesIn(kGlobalMethods),
                         [](const auto& info) {
                           return std::string(info.param == Solver::global ? "global" : "thesis");
                         });

}  // namespace
}  // namespace inverse::extremes
