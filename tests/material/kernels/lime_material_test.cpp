// SPDX-License-Identifier: LGPL-2.1-or-later
// The material of one object, by networks whose results are known.
#include <cmath>

#include "lime_material_fixture.hpp"

namespace inverse::testing {

TEST_F(LimeTest, AnotherObjectInTheSquareIsNotMixedIn) {
  LimeMaterial alone(device, kFrame, HandMadeLime::models()),
      beside = LimeMaterial(device, kFrame, HandMadeLime::models());
  const Plane one = scene(60, 30, 20), both = together(one, scene(88, 58, 4));
  LimeMaterial::Layers layers;
  for (int i = 0; i < 8; ++i) {
    frame(alone, one);
    layers = frame(beside, both);
  }
  ASSERT_TRUE(beside.object().found);
  ASSERT_EQ(beside.square(), alone.square());
  ASSERT_GT(beside.square().x + beside.square().size, 88) << "it is in the square";
  const Material &m = beside.object().latest, &expected = alone.object().latest;
  EXPECT_NEAR(m.specular, expected.specular, 1e-5);
  for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(m.diffuse[c], expected.diffuse[c], 1e-5);
  const Pixels diffuse = download(layers.diffuse);
  EXPECT_EQ(diffuse[4 * (58 * kFrame.width + 88) + 3], 0) << "nor in the mask";
  EXPECT_GT(diffuse[4 * (30 * kFrame.width + 60) + 3], .9);
}

TEST_F(LimeTest, ASkippedPartHasNoEstimateBeforeItRuns) {
  params.adaptive = false;
  const Plane other = scene(86, 56, 6, .4F, .9F), both = together(scene(60, 30, 20), other);
  const double of_nothing = 1 / (1 + std::exp(1));
  for (delay = 0; delay < 3; delay += 2) {
    LimeMaterial lime(device, kFrame, HandMadeLime::models());
    for (int i = 0; i < 8; ++i) frame(lime, both);
    ASSERT_LT(lime.object().box.left, 50);
    int estimates = 0;
    for (int i = 0; i < 8; ++i) {
      frame(lime, other);
      if (lime.object().box.left < 70 || !lime.object().known()) continue;
      EXPECT_GT(lime.object().latest.specular, of_nothing + .01) << delay << ", " << i;
      ++estimates;
    }
    EXPECT_GE(estimates, 3) << delay;
  }
}

TEST_F(LimeTest, AVanishedObjectHasNoEstimates) {
  LimeMaterial lime(device, kFrame, HandMadeLime::models());
  const Plane object = scene(60, 30, 20), nothing = scene(60, 30, 0);
  frame(lime, object);
  frame(lime, object);
  const uint64_t estimates = lime.object().averaged;
  const Material before = lime.object().latest;
  frame(lime, nothing);
  ASSERT_TRUE(lime.object().found) << "it may be back in a moment";
  EXPECT_EQ(lime.object().averaged, estimates);
  EXPECT_EQ(lime.object().latest.specular, before.specular);
}

TEST_F(LimeTest, EstimatesAreThoseOfTheNetworks) {
  LimeMaterial lime(device, kFrame, HandMadeLime::models());
  const Plane picture = scene(60, 30, 20);
  LimeMaterial::Layers layers;
  for (int i = 0; i < 6; ++i) layers = frame(lime, picture);
  const LimeMaterial::Object& object = lime.object();
  ASSERT_TRUE(object.found);
  EXPECT_NEAR(object.material.diffuse[0], .2, 1e-4);
  EXPECT_NEAR(object.material.diffuse[1], .5, 1e-4);
  EXPECT_NEAR(object.material.diffuse[2], .7, 1e-4);
  EXPECT_EQ(object.material.bin(), 5u);
  const float code = .5F * .4F;  // within the object, of which the square has this share
  EXPECT_NEAR(object.material.specular, 1 / (1 + std::exp(1 - 8 * code * object.share)), .01);
  EXPECT_NEAR((object.box.left + object.box.right) / 2, 60, 2);

  const Pixels diffuse = download(layers.diffuse), gloss = download(layers.gloss);
  const auto pixel = [](const Pixels& p, uint32_t x, uint32_t y) {
    return &p[4 * (size_t{y} * kFrame.width + x)];
  };
  EXPECT_NEAR(pixel(gloss, 60, 30)[0], decoded(code), 1e-3);
  EXPECT_NEAR(pixel(gloss, 60, 30)[3], decoded(2 * code), 1e-3);
  EXPECT_NEAR(pixel(diffuse, 60, 30)[0], kRed - decoded(code), 1e-3);
  EXPECT_NEAR(pixel(diffuse, 60, 30)[2], std::max(0.0F, kBlue - decoded(code)), 1e-3);
  EXPECT_EQ(pixel(diffuse, 60, 30)[3], 1);
  EXPECT_EQ(pixel(diffuse, 4, 4)[3], 0);
  EXPECT_EQ(pixel(gloss, 4, 4)[0], 0);
  EXPECT_NEAR(pixel(diffuse, 4, 4)[1], kGray, 1e-5);
}

TEST_F(LimeTest, WithoutAnObjectOnlyTheSearchRuns) {
  LimeMaterial lime(device, kFrame, HandMadeLime::models());
  const Plane empty = scene(0, 0, 0);
  for (int i = 0; i < 5; ++i) {
    const auto layers = frame(lime, empty);
    EXPECT_TRUE(last_report(lime).segmented);
    EXPECT_FALSE(last_report(lime).estimated);
    for (const float v : download(layers.gloss)) ASSERT_EQ(v, 0);
  }
  EXPECT_FALSE(lime.object().found);
  frame(lime, scene(60, 30, 20));
  frame(lime, scene(60, 30, 20));
  EXPECT_TRUE(last_report(lime).estimated);
}

TEST_F(LimeTest, APictureWithoutAnObjectIsSearchedOnce) {
  for (delay = 0; delay < gpu::kFramesInFlight; ++delay) {
    LimeMaterial lime(device, kFrame, HandMadeLime::models());
    const Plane empty = scene(0, 0, 0), disc = scene(50, 30, 20);
    const auto searched = [&] { return last_report(lime).segmentations; };
    params.adaptive = true;
    frame(lime, empty);
    for (int i = 0; i < 5; ++i) frame(lime, empty, true);
    EXPECT_EQ(searched(), 1u);
    frame(lime, empty);
    EXPECT_EQ(searched(), 2u) << "another one";
    for (int i = 0; i < 8; ++i) frame(lime, disc, i > 0);
    EXPECT_TRUE(lime.object().found);
    EXPECT_EQ(searched(), 10u - delay) << "found by what was recorded before it was done";
    // It goes: it is missed where it was, and then once in the whole frame.
    const uint64_t before = searched();
    for (int i = 0; i < 12; ++i) frame(lime, empty, i > 0);
    EXPECT_FALSE(lime.object().found);
    EXPECT_EQ(searched(), before + 4 + delay);
    lime.reset();
    frame(lime, empty, true);
    EXPECT_EQ(searched(), before + 5 + delay) << "what was known is forgotten";
    params.adaptive = false;
    for (int i = 0; i < 5; ++i) frame(lime, empty, true);
    EXPECT_EQ(searched(), before + 10 + delay);
  }
}

TEST_F(LimeTest, AnUnchangedObjectIsEstimatedRarely) {
  LimeMaterial lime(device, kFrame, HandMadeLime::models());
  params.estimate_interval = 5;
  const Plane picture = scene(50, 30, 20);
  for (int i = 0; i < 30; ++i) frame(lime, picture);
  const auto before = last_report(lime).estimates;
  const Pixels expected = download(frame(lime, picture).diffuse);
  for (int i = 0; i < 19; ++i) EXPECT_EQ(download(frame(lime, picture).diffuse), expected);
  EXPECT_EQ(last_report(lime).estimates, before + 4);
  params.adaptive = false;
  for (int i = 0; i < 5; ++i) frame(lime, picture);
  EXPECT_EQ(last_report(lime).estimates, before + 9);
}

TEST_F(LimeTest, AChangingObjectIsNeverConfirmed) {
  LimeMaterial lime(device, kFrame, HandMadeLime::models());
  params.estimate_interval = 1000;
  params.fusion.memory = 1;
  params.fusion.new_object_distance = 1;
  params.converged_error = .01F;
  for (int i = 0; i < 80; ++i) unseen(lime, i % 3 ? .3F : .5F, .5F);
  EXPECT_GE(last_report(lime).estimates, 75U);
  EXPECT_LT(lime.object().spread, params.converged_error * std::sqrt(60.F))
      << "or any rule would do";
}

TEST_F(LimeTest, LayersOfAnUnchangedObjectFollowItsLight) {
  LimeMaterial lime(device, kFrame, HandMadeLime::models());
  params.estimate_interval = 1000;
  const auto gloss = [&](float blue) { return gloss_of(lime, blue); };
  for (int i = 0; i < 30; ++i) gloss(.4F);
  ASSERT_FALSE(last_report(lime).estimated);
  const auto estimates = last_report(lime).estimates;
  // Less than a change: what was found stays.
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(gloss(.41F), decoded(.5F * .4F), 1e-3);
  EXPECT_EQ(last_report(lime).estimates, estimates);
  // A highlight comes: by the second frame it is seen, and then all is still again.
  gloss(.5F);
  EXPECT_NEAR(gloss(.5F), decoded(.5F * .5F), 1e-3);
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(gloss(.5F), decoded(.5F * .5F), 1e-3);
  EXPECT_EQ(last_report(lime).estimates, estimates + 2);
  // Layers are not read: the material is unchanged.
  for (int i = 0; i < 10; ++i) unseen(lime, i % 2 ? .5F : .47F, .5F);
  EXPECT_LE(last_report(lime).estimates, estimates + 4);
  for (int i = 0; i < 10; ++i) gloss(i % 2 ? .5F : .47F);
  EXPECT_GE(last_report(lime).estimates, estimates + 6);
}

TEST_F(LimeTest, FirstDrawnLayersAreOfTheCurrentPicture) {
  LimeMaterial lime(device, kFrame, HandMadeLime::models());
  params.estimate_interval = 1000;
  params.fusion.new_object_distance = 1;
  const auto gloss = [&](float blue) { return gloss_of(lime, blue); };
  for (int i = 0; i < 30; ++i) unseen(lime, .4F, .5F);
  ASSERT_FALSE(last_report(lime).estimated);
  unseen(lime, .5F, .5F);
  ASSERT_FALSE(last_report(lime).estimated) << "nobody draws what has changed";
  gloss(.5F);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(gloss(.5F), decoded(.5F * .5F), 1e-3);
  // Drawn, then not, while estimates go on; then drawn again.
  params.adaptive = false;
  for (int i = 0; i < 8; ++i) unseen(lime, .4F, .5F);
  params.adaptive = true;
  gloss(.5F);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(gloss(.5F), decoded(.5F * .5F), 1e-3);
}

TEST_F(LimeTest, ASteadyObjectThatLeavesIsLostAtOnce) {
  LimeMaterial lime(device, kFrame, HandMadeLime::models());
  params.estimate_interval = 1000;
  for (int i = 0; i < 30; ++i) frame(lime, scene(50, 30, 20));
  EXPECT_FALSE(last_report(lime).estimated);
  EXPECT_TRUE(last_report(lime).segmented);
  frame(lime, scene(50, 30, 20), true);
  EXPECT_FALSE(last_report(lime).segmented);
  for (int i = 0; i < 4; ++i) frame(lime, scene(0, 0, 0));
  EXPECT_FALSE(lime.object().found);
}

TEST_F(LimeTest, AResetDiscardsTheObject) {
  LimeMaterial lime(device, kFrame, HandMadeLime::models());
  for (int i = 0; i < 4; ++i) frame(lime, scene(50, 30, 20));
  lime.reset();
  EXPECT_FALSE(lime.object().found);
  EXPECT_EQ(lime.square().size, kFrame.width);
  for (const float v : download(frame(lime, scene(50, 30, 20)).gloss)) ASSERT_EQ(v, 0);
}

TEST_F(LimeTest, FramesInFlightAtAResetAreIgnored) {
  LimeMaterial lime(device, kFrame, HandMadeLime::models());
  for (int i = 0; i < 4; ++i) frame(lime, scene(50, 30, 20));
  ASSERT_TRUE(lime.object().found);
  for (int i = 0; i < 2; ++i)
    run([&](gpu::Commands& commands) { lime.record(commands, scene(50, 30, 20), params, false); });
  const uint64_t last = lime.recorded() - 1;
  lime.reset();
  for (const uint64_t number : {last - 1, last}) lime.done(number);
  EXPECT_FALSE(lime.object().found);
  EXPECT_EQ(lime.square().size, kFrame.width);
  for (int i = 0; i < 2; ++i) frame(lime, scene(50, 30, 20));
  EXPECT_TRUE(lime.object().found) << "it goes on";
}

TEST_F(LimeTest, BadFramesGiveFiniteEstimates) {
  LimeMaterial lime(device, kFrame, HandMadeLime::models());
  Pixels pixels(kFrame.pixels() * 4);
  const float bad[] = {kNan, -3, kInf, 1e30F, 0};
  for (size_t i = 0; i < pixels.size(); ++i) pixels[i] = bad[i % 5];
  for (int i = 0; i < 4; ++i) {
    const auto layers = frame(lime, plane(kFrame, pixels));
    for (const PlanePtr& layer : {layers.diffuse, layers.gloss})
      ASSERT_TRUE(all_finite(download(layer)));
  }
}

TEST_F(LimeTest, FramesOfEverySizeHaveLayers) {
  for (const Extent extent : {Extent{1, 1}, Extent{3, 200}, Extent{500, 7}}) {
    LimeMaterial lime(device, extent, HandMadeLime::models());
    Pixels red(extent.pixels() * 4, 0.0F);
    for (size_t i = 0; i < red.size(); i += 4) red[i] = 1;
    LimeMaterial::Layers layers;
    for (int i = 0; i < 4; ++i) layers = frame(lime, plane(extent, red));
    EXPECT_TRUE(lime.object().found);
    const Pixels diffuse = download(layers.diffuse);
    EXPECT_EQ(diffuse[4 * (extent.pixels() / 2) + 3], 1);
  }
}

TEST_F(LimeTest, AnObjectElsewhereIsAnotherOne) {
  LimeMaterial lime(device, kFrame, HandMadeLime::models());
  for (int i = 0; i < 30; ++i) frame(lime, scene(38, 32, 10));
  EXPECT_GT(lime.object().averaged, 12U);
  // After a cut, a little of it lies in the square of the one before.
  for (int frames = 0; frames < 8 && lime.object().box.left < 48; ++frames)
    frame(lime, scene(60, 32, 10));
  EXPECT_TRUE(lime.object().found);
  EXPECT_GE(lime.object().box.left, 48);
  EXPECT_LT(lime.object().averaged, 4U) << "whose estimates are its own";
}

TEST_F(LimeTest, NonFiniteNetworksGiveFiniteLayers) {
  // What `weights` say of a point, but where its blue is strong: there it is infinity less
  // infinity.
  const auto spoilt = [](uint32_t channels, std::vector<float> weights, float bias,
                         network::Activation activation) {
    NetworkBuilder b(1);
    const uint32_t image = b.input(channels, HandMadeLime::kSide, HandMadeLime::kSide);
    b.output(b.convolution(b.convolution(image, 3, 1), 1, 1, 1, activation));
    network::Graph graph = b.graph();
    std::vector<float> huge(channels);
    huge[2] = 3e38F;
    graph.weights = huge;
    for (const std::vector<float>& more : {huge, weights, {1e38F, 1e38F, bias}, {1, -1, 1}, {0}})
      graph.weights.insert(graph.weights.end(), more.begin(), more.end());
    return graph;
  };
  const Plane picture = together(scene(50, 30, 20), scene(50, 30, 8, .4F, .95F));
  for (const bool mask : {true, false}) {
    LimeModels models = HandMadeLime::models();
    if (mask)
      models.segmentation = spoilt(3, {60, -60, 0}, -20, network::Activation::sigmoid);
    else
      models.specular = spoilt(4, {0, 0, .5F, 0}, 0, network::Activation::none);
    LimeMaterial lime(device, kFrame, std::move(models));
    LimeMaterial::Layers layers;
    for (int i = 0; i < 6; ++i) layers = frame(lime, picture);
    EXPECT_TRUE(lime.object().known()) << mask;
    EXPECT_GT(download(layers.diffuse)[4 * (30 * kFrame.width + 62) + 3], .9F)
        << "beside them all is well";
    for (const PlanePtr& layer : {layers.diffuse, layers.gloss})
      ASSERT_TRUE(are_light(download(layer))) << mask;
  }
}

// In a process of its own, as others would have built them.
class LimeWarmUp : public OnANewDevice<LimeTest> {};

TEST_F(LimeWarmUp, NoKernelIsBuiltWhileFramesCome) {
  LimeMaterial lime(device, kFrame, HandMadeLime::models());
  gpu::build_kernels(device);
  const uint64_t before = device->kernels_used();
  EXPECT_GT(before, 5u);
  for (int i = 0; i < 6; ++i) frame(lime, scene(60, 30, i < 2 ? 0 : 20));
  for (int i = 0; i < 30; ++i) frame(lime, scene(60, 30, 20), i % 2);
  EXPECT_TRUE(lime.object().found);
  EXPECT_EQ(device->kernels_used(), before);
}

}  // namespace inverse::testing
