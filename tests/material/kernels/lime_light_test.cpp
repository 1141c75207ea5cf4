// SPDX-License-Identifier: LGPL-2.1-or-later
// The light around one object, by networks whose results are known.
#include <cmath>

#include "lime_material_fixture.hpp"

namespace inverse::testing {

TEST_F(LimeTest, TheLightIsEstimatedIfRequested) {
  LimeMaterial lime(device, kFrame, HandMadeLime::models());
  for (int i = 0; i < 6; ++i) frame(lime, scene(50, 30, 20));
  EXPECT_EQ(lime.light(), nullptr);
  EXPECT_EQ(lime.light_views(), 0u);
  params.light_asked = true;
  params.adaptive = false;
  for (int i = 0; i < 4; ++i) frame(lime, scene(50, 30, 20));
  ASSERT_NE(lime.light(), nullptr);
  EXPECT_EQ(lime.light_views(), 4u);
  const auto first = lime.light();
  for (int i = 0; i < 8; ++i) frame(lime, scene(50, 30, 20));
  EXPECT_EQ(lime.light_views(), 6u) << "then one in four";
  EXPECT_NE(lime.light(), first);
  for (const float v : lime.light()->rgb()) ASSERT_TRUE(v >= 0 && std::isfinite(v));
  // It is the scene's, and stays when the object goes.
  for (int i = 0; i < 4; ++i) frame(lime, scene(0, 0, 0));
  EXPECT_FALSE(lime.object().found);
  EXPECT_NE(lime.light(), nullptr);
  lime.reset();
  EXPECT_EQ(lime.light(), nullptr);
}

TEST_F(LimeTest, TheLightOfAnUnchangedObjectIsThatOfTheLamps) {
  params.light_asked = true;
  params.estimate_interval = 1000;
  params.fusion.new_object_distance = params.converged_error = 1;  // the material does not restart
  for (delay = 0; delay < gpu::kFramesInFlight; ++delay) {
    LimeMaterial lime(device, kFrame, HandMadeLime::models());
    for (int i = 0; i < 40; ++i) unseen(lime, .4F);
    ASSERT_FALSE(unseen(lime, .4F).estimated);
    ASSERT_NE(lime.light(), nullptr);
    const uint64_t views = lime.light_views();
    const double before = blueness(lime);
    EXPECT_GE(views, 4u);
    // Other lamps: noticed when a frame is done, then the light is what they make.
    for (uint64_t i = 0; i < 2 + 2 * delay; ++i) unseen(lime, .6F);
    const double between = blueness(lime);
    EXPECT_GT(between, 1.2 * before);
    for (uint64_t i = 0; i < 2 + 2 * delay; ++i) unseen(lime, .9F);
    EXPECT_GT(blueness(lime), 1.2 * between);
    EXPECT_LE(lime.light_views(), 1 + delay) << "none of the lamps before";
    for (uint64_t i = 0; i < 1 + delay; ++i) unseen(lime, .9F);
    EXPECT_FALSE(unseen(lime, .9F).estimated) << "and it rests again";
  }
}

TEST_F(LimeTest, TheLightFollowsLampsThatFade) {
  params.light_asked = true;
  params.fusion.new_object_distance = params.converged_error = 1;
  for (delay = 0; delay < gpu::kFramesInFlight; ++delay) {
    LimeMaterial lime(device, kFrame, HandMadeLime::models());
    const auto estimates = [&] { return last_report(lime).estimates; };
    for (int i = 0; i < 60; ++i) unseen(lime, .4F);
    const uint64_t known = estimates();
    for (int i = 0; i < 16; ++i) unseen(lime, .4F);
    ASSERT_EQ(estimates(), known + 2) << "it rests";
    const double before = blueness(lime);
    for (int i = 0; i < 600; ++i) unseen(lime, .4F + .4F * static_cast<float>(i) / 600);
    const double faded = blueness(lime);
    EXPECT_LT(estimates(), known + 400) << "and between the steps";
    for (int i = 0; i < 200; ++i) unseen(lime, .8F);
    EXPECT_GT(faded, 2 * before);
    EXPECT_NEAR(faded / blueness(lime), 1, .05) << "as those lamps make it";
  }
}

TEST_F(LimeTest, LightThatIsNotRequestedIsDiscarded) {
  params.light_asked = true;
  params.fusion.new_object_distance = params.converged_error = 1;
  LimeMaterial lime(device, kFrame, HandMadeLime::models());
  for (int i = 0; i < 40; ++i) unseen(lime, .4F);
  ASSERT_GE(lime.light_views(), 4U);
  const auto light = lime.light();
  params.light_asked = false;
  unseen(lime, .8F);
  EXPECT_EQ(lime.light_views(), 0U);
  EXPECT_EQ(lime.light(), nullptr) << "it would be handed out to who asks again";
  params.light_asked = true;
  for (int i = 0; i < 4; ++i) unseen(lime, .8F);
  EXPECT_GE(lime.light_views(), 1U);
  ASSERT_NE(lime.light(), nullptr);
  EXPECT_NE(*lime.light(), *light);
}

TEST_F(LimeTest, TheLightIsAMeanWhileThingsMove) {
  LimeMaterial lime(device, kFrame, HandMadeLime::models());
  params.light_asked = true;
  params.fusion.new_object_distance = params.converged_error = 1;
  for (int i = 0; i < 40; ++i) unseen(lime, .4F);
  // An object that turns in its place restarts it once, and follows for a while.
  for (int i = 0; i < 150; ++i) unseen(lime, i % 2 ? .45F : .6F);
  EXPECT_GE(lime.light_views(), 25u);
  // What is moved does not.
  for (int i = 0; i < 60; ++i) unseen(lime, .6F);
  const uint64_t views = lime.light_views();
  for (int i = 0; i < 40; ++i) frame(lime, scene(50 + static_cast<float>(i % 4), 30, 20, .4F, .6F));
  EXPECT_GT(lime.light_views(), views);
}

TEST_F(LimeTest, AnObjectThatStopsElsewhereGetsTheLightThere) {
  LimeMaterial lime(device, kFrame, HandMadeLime::models());
  params.light_asked = true;
  params.fusion.new_object_distance = params.converged_error = 1;
  const auto put = [&](float x, float blue) { unseen(lime, scene(x, 30, 20, .4F, blue)); };
  for (int i = 0; i < 1000; ++i) put(40, .4F);
  const double before = blueness(lime);
  const uint64_t views = lime.light_views();
  EXPECT_GE(views, 30U);
  // Carried under a lamp of another color, a while on the way.
  for (int i = 0; i < 16; ++i) put(40 + static_cast<float>(i), .4F + .025F * static_cast<float>(i));
  for (int i = 0; i < 100; ++i) put(56, .8F);
  EXPECT_LT(lime.light_views(), views);
  const double after = blueness(lime);
  for (int i = 0; i < 3000; ++i) put(56, .8F);
  EXPECT_GT(blueness(lime), 2 * before);
  EXPECT_NEAR(after / blueness(lime), 1, .2);
  // In its place it is one light, however often it is estimated.
  EXPECT_GE(lime.light_views(), 60U);
}

TEST_F(LimeTest, WithoutNormalsThereIsNoLight) {
  LimeMaterial lime(device, kFrame, HandMadeLime::models());
  params.light_asked = true;
  params.light.inflate = false;
  for (int i = 0; i < 6; ++i) frame(lime, scene(50, 30, 20));
  EXPECT_EQ(lime.light(), nullptr);
  // A map of another size than the frame.
  lime.set_normal_map(std::make_shared<const NormalMap>(
      NormalMap({3, 2}, std::vector<Normal>(6, Normal{0, 0, 1}))));
  params.adaptive = false;
  for (int i = 0; i < 4; ++i) frame(lime, scene(50, 30, 20));
  EXPECT_NE(lime.light(), nullptr);
}

TEST_F(LimeTest, TheLightExplainsWhatIsSeen) {
  LimeMaterial lime(device, kFrame, HandMadeLime::models());
  params.light_asked = true;
  lime.set_normal_map(std::make_shared<const NormalMap>(
      NormalMap({1, 1}, std::vector<Normal>(1, Normal{0, 0, 1}))));
  for (int i = 0; i < 6; ++i) frame(lime, scene(50, 30, 20));
  ASSERT_NE(lime.light(), nullptr);
  // D towards the camera, a sum over the map, times the albedo is the diffuse layer in the mean
  // that albedos weigh.
  const Environment& light = *lime.light();
  const double specular = static_cast<double>(decoded(.5F * .4F));
  const double seen[3] = {double{kRed} - specular, std::max(0., double{kBlue} - specular),
                          std::max(0., double{kBlue} - specular)};
  const double albedo[3] = {.2, .5, .7};
  double fit = 0, all = 0;
  for (size_t c = 0; c < 3; ++c) {
    double d = 0;
    for (uint32_t row = 0; row < light.extent().height; ++row)
      for (uint32_t column = 0; column < light.extent().width; ++column) {
        const double z = light.direction(column + .5, row + .5)[2];
        const size_t at = 3 * (size_t{row} * light.extent().width + column) + c;
        if (z > 0) d += light.solid_angle(row) * z * static_cast<double>(light.rgb()[at]) / M_PI;
      }
    fit += albedo[c] * albedo[c] * d;
    all += albedo[c] * seen[c];
  }
  EXPECT_NEAR(fit / all, 1, .15);
}

}  // namespace inverse::testing
