// SPDX-License-Identifier: LGPL-2.1-or-later
// The property prior of intrinsicdecomp and globalintrinsic.
#include <cstdlib>
#include <filesystem>

#include "kernels/network/graph_file.hpp"
#include "tests/elements/element_test.hpp"
#include "tests/kernels/intrinsic/prior_graph.hpp"
#include "tests/temporary_folder.hpp"

namespace inverse::testing {
namespace {

const std::string kCaps = VideoHarness::caps("RGBA", 160, 120);
class Prior : public ::testing::TestWithParam<const char*> {
 protected:
  std::string line(const std::string& prior) const {
    return std::string(GetParam()) + " show=reflectance prior=" + prior;
  }
  std::string network(const std::string& name, unsigned seed, float gain = 1) const {
    return folder_.write(name, network::to_file(prior_graph(seed, gain)));
  }
  std::string prior_in_stats(VideoHarness& harness) const {
    return stat<std::string>(harness.find(GetParam()), "prior");
  }
  void use_models(const std::string& folder) const { setenv("INVERSE_MODELS", folder.c_str(), 1); }
  void TearDown() override {
    models_.empty() ? unsetenv("INVERSE_MODELS") : setenv("INVERSE_MODELS", models_.c_str(), 1);
  }
  std::vector<uint8_t> usual() const {
    VideoHarness harness(line("fitted"), kCaps, kCaps);
    const auto frame = harness.process(frame_);
    EXPECT_EQ(prior_in_stats(harness), "fitted");
    return frame;
  }
  const std::vector<uint8_t> frame_ = random_frame(kCaps, 3);
  TemporaryFolder folder_;

 private:
  static std::string models() {
    const char* models = std::getenv("INVERSE_MODELS");
    return models ? models : "";
  }
  const std::string models_ = models();
};

INSTANTIATE_TEST_SUITE_P(Elements, Prior, ::testing::Values("intrinsicdecomp", "globalintrinsic"),
                         [](const auto& info) { return std::string(info.param); });

}  // namespace

TEST_P(Prior, AFileChangesFrames) {
  const std::string zero = network("zero.net", 1, 0),
                    paint =
                        folder_.write("paint.net", network::to_file(reflectance_model(1)->graph));
  for (const std::string& random : {network("random.net", 1), paint}) {
    VideoHarness harness(line(random), kCaps, kCaps);
    EXPECT_GT(largest_difference(harness.process(frame_), usual()), 10);
    EXPECT_EQ(prior_in_stats(harness), random);
    EXPECT_TRUE(harness.warnings().empty());
    EXPECT_TRUE(harness.errors().empty());
  }
  VideoHarness same(line(zero), kCaps, kCaps);
  EXPECT_EQ(same.process(frame_), usual());
}

TEST_P(Prior, LearnedIsTheNetworkInTheModelsFolder) {
  use_models(folder_.path());
  {
    VideoHarness harness(line("learned"), kCaps, kCaps);
    EXPECT_EQ(harness.process(frame_), usual());
    EXPECT_EQ(harness.process(frame_).empty(), false);
    EXPECT_EQ(prior_in_stats(harness), "fitted");
    expect_one(harness.warnings(), "prior=learned is not used",
               folder_ / "intrinsic/prior.net; install gst-inverse-models");
  }
  std::filesystem::create_directory(folder_ / "intrinsic");
  const std::string path = network("intrinsic/prior.net", 2);
  VideoHarness harness(line("learned"), kCaps, kCaps), named(line(path), kCaps, kCaps);
  EXPECT_EQ(harness.process(frame_), named.process(frame_));
  EXPECT_EQ(prior_in_stats(harness), path);
  EXPECT_TRUE(harness.warnings().empty());
}

TEST_P(Prior, WhatCannotBeUsedIsOneWarning) {
  NetworkBuilder other(1);
  other.output(other.convolution(other.input(4), 44, 3, 2));
  const std::string four = folder_.write("four.net", network::to_file(other.graph()));
  const std::string text = folder_.write("text.net", "no network"), missing = folder_ / "none.net";
  const auto expect = [&](const std::string& prior, const std::string& why) {
    VideoHarness harness(line(prior), kCaps, kCaps);
    EXPECT_EQ(harness.process(frame_), usual()) << prior;
    for (int k = 0; k < 4; ++k) harness.process(frame_);
    expect_one(harness.warnings(), "prior=" + prior + " is not used, but the fitted prior", why);
    EXPECT_TRUE(harness.errors().empty());
  };
  expect(four, "it takes 4 channels in place of 6 of the guide or 3 of an image");
  expect(text, "too short to be a network");
  expect(missing, "No such file");
  expect(folder_.path(), "it ");
  expect("/a/b.onnx", "run \"inverse-onnx-import /a/b.onnx /a/b.net\" and set prior=/a/b.net");
}

TEST_P(Prior, ChangesWhilePlaying) {
  const std::string one = network("one.net", 1), two = network("two.net", 2),
                    missing = folder_ / "none.net";
  // Frames of the old prior hold on for long otherwise.
  VideoHarness harness(line(one) + " temporal-weight=0 temporal-hold=0", kCaps, kCaps);
  auto before = harness.process(frame_, 6);
  const auto change = [&](const std::string& prior, const std::string& used, size_t warnings) {
    const bool other = prior_in_stats(harness) != used;
    g_object_set(harness.find(GetParam()), "prior", prior.c_str(), nullptr);
    const auto after = harness.process(frame_, 6);
    EXPECT_EQ(prior_in_stats(harness), used);
    EXPECT_EQ(harness.warnings().size(), warnings) << prior;
    if (other)
      EXPECT_GT(largest_difference(after, before), 20) << prior;
    else
      EXPECT_LT(largest_difference(after, before), 4) << prior;
    before = after;
  };
  change(one, one, 0);
  change(two, two, 0);
  change("fitted", "fitted", 0);
  change(missing, "fitted", 1);
  change(missing, "fitted", 0);
  change(two, two, 0);
  change(missing, "fitted", 1);
  EXPECT_TRUE(harness.errors().empty());
}

}  // namespace inverse::testing
