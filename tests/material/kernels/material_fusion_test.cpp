// SPDX-License-Identifier: LGPL-2.1-or-later
// Estimates of one object's material over time.
#include "kernels/material/estimate/material_fusion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "materials.hpp"

namespace inverse::testing {

TEST(MaterialTest, BinsCoverTwoTo1024Evenly) {
  EXPECT_NEAR(Material::bin_middle(0), std::exp2(1 + 9. / 16), 1e-4);
  EXPECT_NEAR(Material::bin_middle(7), std::exp2(10 - 9. / 16), 1e-1);
  Material m = material(0, 0, 3);
  EXPECT_EQ(m.bin(), 3u);
  EXPECT_NEAR(m.shininess(), Material::bin_middle(3), 1e-3);
  m.bins = {0, 0, .3F, .3F, .08F, 0, 0, .32F};  // three that lie together against a lone one
  EXPECT_EQ(m.bin(), 3u);
  m.bins = {0, 0, 0, .5F, .5F, 0, 0, 0};
  EXPECT_NEAR(std::log2(m.shininess()), 1 + 9 * 4. / 8, 1e-5) << "between the two";
}

TEST(MaterialFusion, OneEstimateIsItself) {
  MaterialFusion fusion;
  fusion.add(material(.3F, .4F, 2), {});
  EXPECT_FLOAT_EQ(fusion.material().diffuse[0], .3F);
  EXPECT_FLOAT_EQ(fusion.material().specular, .4F);
  EXPECT_EQ(fusion.material().bin(), 2u);
  EXPECT_EQ(fusion.count(), 1u);
  EXPECT_EQ(fusion.spread(), 0);
}

TEST(MaterialFusion, SingleOutliersHaveNoEffect) {
  MaterialFusion fusion, clean;
  for (int i = 0; i < 40; ++i) {
    fusion.add(material(i % 7 == 6 ? .95F : .3F, .4F, i % 7 == 6 ? 7 : 2), {});
    clean.add(material(.3F, .4F, 2), {});
  }
  EXPECT_FLOAT_EQ(fusion.material().diffuse[0], clean.material().diffuse[0]);
  EXPECT_NEAR(fusion.material().shininess(), clean.material().shininess(), 1e-3);
}

TEST(MaterialFusion, NoiseFallsWithTheRootOfTime) {
  std::mt19937 random(4);
  std::normal_distribution<float> noise(0, .05F);
  MaterialFusion fusion;
  for (int i = 0; i < 400; ++i) fusion.add(material(.5F + noise(random), .4F, 2), {400});
  EXPECT_NEAR(fusion.material().diffuse[0], .5F, 4 * .05F / 20);
  EXPECT_NEAR(fusion.spread(), .05F, .03F);
}

TEST(MaterialFusion, TheMeanOfManyThatScatterIsAsSteadyAsThatOfAFewThatDoNot) {
  constexpr float kLimit = .02F, kNoise = .05F;
  std::mt19937 random(4);
  std::normal_distribution<float> noise(0, kNoise);
  MaterialFusion even, noisy;
  for (uint64_t i = 1; i <= 100; ++i) {
    even.add(material(.5F, .4F, 2), {});
    EXPECT_EQ(even.converged(kLimit), i >= MaterialFusion::kMinEstimates) << i;
    noisy.add(material(.5F + noise(random), .4F, 2), {});
    EXPECT_EQ(noisy.converged(kLimit),
              i >= MaterialFusion::kMinEstimates &&
                  noisy.spread() < kLimit * std::sqrt(static_cast<float>(i)))
        << i << ": what scatters drifts no further than its scatter explains";
  }
  EXPECT_FALSE(even.converged(0));
  EXPECT_FALSE(even.converged(std::numeric_limits<float>::quiet_NaN()));
}

TEST(MaterialFusion, ASimilarObjectIsNotConfirmedBeforeItsMean) {
  constexpr float kLimit = .02F;
  for (const float noise : {0.F, .03F}) {
    std::mt19937 random(4);
    std::normal_distribution<float> scatter(0, noise);
    MaterialFusion fusion;
    for (int i = 0; i < 100; ++i) fusion.add(material(.2F + scatter(random), .4F, 2), {});
    ASSERT_TRUE(fusion.converged(kLimit));
    // Less than another object, which would restart it.
    for (int i = 0; i < 20; ++i) fusion.add(material(.35F + scatter(random), .4F, 2), {});
    EXPECT_EQ(fusion.count(), 120U);
    EXPECT_FALSE(fusion.converged(kLimit));
    int more = 0;
    while (!fusion.converged(kLimit) && more < 1000) {
      fusion.add(material(.35F + scatter(random), .4F, 2), {});
      ++more;
    }
    EXPECT_LT(more, 300);
    EXPECT_NEAR(fusion.material().diffuse[0], .35F, 1.5F * kLimit + noise);
  }
}

TEST(MaterialFusion, TheMeanHasAtMostTheLengthOfItsMemory) {
  MaterialFusion fusion;
  const MaterialFusion::Params params{.memory = 5};
  for (uint64_t i = 1; i <= 20; ++i) {
    fusion.add(material(.3F, .4F, 2), params);
    EXPECT_EQ(fusion.count(), i);
    EXPECT_EQ(fusion.averaged(), std::min<uint64_t>(i, 5));
  }
}

TEST(MaterialFusion, AGrowingMemoryOmitsDiscardedEstimates) {
  MaterialFusion fusion;
  MaterialFusion::Params params{.memory = 1};
  for (int i = 0; i < 50; ++i) fusion.add(material(.3F, .4F, 2), params);
  params.memory = 1000;
  for (int i = 0; i < 20; ++i) fusion.add(material(.4F, .4F, 2), params);
  EXPECT_EQ(fusion.averaged(), 21u);
  EXPECT_EQ(fusion.count(), 70u);
  // The median takes three of the old ones with it, and the mean had one.
  EXPECT_NEAR(fusion.material().diffuse[0], (3 * .3F + 18 * .4F) / 21, .005F);
}

TEST(MaterialFusion, AnotherObjectIsTakenUpAfterFiveFrames) {
  MaterialFusion fusion;
  for (int i = 0; i < 50; ++i) fusion.add(material(.2F, .4F, 2), {});
  int frames = 0;
  while (fusion.material().diffuse[0] < .7F && frames < 100) {
    fusion.add(material(.8F, .1F, 6), {});
    ++frames;
  }
  EXPECT_LE(frames, 8);
  EXPECT_LE(fusion.count(), 2u);
}

TEST(MaterialFusion, AGlossyObjectOfTheSameColorIsAnotherOne) {
  for (const bool shiny : {true, false}) {
    MaterialFusion fusion;
    for (int i = 0; i < 50; ++i) fusion.add(material(.2F, .1F, 1), {});
    for (int i = 0; i < 12; ++i) fusion.add(material(.2F, shiny ? .1F : .8F, shiny ? 7 : 1), {});
    EXPECT_NEAR(fusion.material().specular, shiny ? .1F : .8F, .01F);
    EXPECT_EQ(fusion.material().bin(), shiny ? 7u : 1u);
  }
}

TEST(MaterialFusion, InvalidProbabilitiesAreIgnored) {
  MaterialFusion fusion;
  Material none = material(.3F, .4F, 2), negative = none;
  none.bins.fill(0);
  negative.bins[0] = -1;
  for (const Material& m : {none, negative}) fusion.add(m, {});
  EXPECT_EQ(fusion.count(), 0u);
}

TEST(MaterialFusion, NonFiniteEstimatesAreIgnored) {
  MaterialFusion fusion;
  fusion.add(material(.3F, .4F, 2), {});
  fusion.add(material(std::numeric_limits<float>::quiet_NaN(), .4F, 2), {});
  fusion.add(material(.3F, std::numeric_limits<float>::infinity(), 2), {});
  EXPECT_EQ(fusion.count(), 1u);
  EXPECT_FLOAT_EQ(fusion.material().diffuse[0], .3F);
}

}  // namespace inverse::testing
