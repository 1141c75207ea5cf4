// SPDX-License-Identifier: LGPL-2.1-or-later
// Devices that are not there, or go while frames are under way. In processes of their own, as
// environment variables decide (INVERSE_LOSE_DEVICE=N loses the device with the Nth submit).
#include <set>

#include "tests/elements/element_test.hpp"
#include "tests/elements/own_process.hpp"
#include "tests/has_element.hpp"
#include "tests/material/kernels/lime_models.hpp"

namespace inverse::testing {
namespace {

const std::string kSource = "videotestsrc num-buffers=20 ! video/x-raw,width=32,height=24 ! ";

/// Loses the device with this submit of frames.
Ended lost_at(const std::string& submit, const std::vector<std::string>& arguments) {
  return run_self({{"INVERSE_LOSE_DEVICE", submit}, {"INVERSE_WARM_UP", "0"}}, arguments);
}

/// Loses the device with each of a few submits in turn. Every time the line must end with an error
/// that says so, and nothing else. The elements that the loss was noticed in first.
std::set<std::string> lose(const std::string& line) {
  std::set<std::string> noticed;
  for (int submit = 4; submit < 10; ++submit) {
    const auto [status, text] = lost_at(std::to_string(submit), {kLaunchOption, line});
    EXPECT_EQ(status, 1) << "submit " << submit << ": " << text;
    const std::string first = text.substr(0, text.find('\n'));
    expect_contains(first, "device was lost");
    noticed.insert(first.substr(0, first.find(':')));
  }
  return noticed;
}

using Names = std::set<std::string>;

}  // namespace

TEST(LostDevice, EveryElementReportsTheLossAndNothingHangs) {
  EXPECT_EQ(lose(kSource + "intrinsicdecomp ! fakesink"), Names{"intrinsicdecomp"});
  EXPECT_EQ(lose(kSource + "intrinsicdecompthesis ! fakesink"), Names{"intrinsicdecompthesis"});
  EXPECT_EQ(lose(kSource +
                 "intrinsicdecomp ! intrinsicrecolor key=0xffc83c28 ! intrinsiccompose ! fakesink"),
            (Names{"intrinsicdecomp", "intrinsicrecolor", "intrinsiccompose"}));
  EXPECT_EQ(lose(kSource + "intrinsicdecomp ! intrinsicsplit name=s s.reflectance ! queue ! "
                           "fakesink s.shading ! queue ! fakesink"),
            (Names{"intrinsicdecomp", "intrinsicsplit"}));
  const HandMadeLime networks;
  const std::string lime = "limematerial estimate-light=true models=" + networks.folder();
  EXPECT_EQ(lose(kSource + lime + " ! fakesink"), Names{"limematerial"});
  if (!has_element("materialclone")) GTEST_SKIP() << "built without Assimp or OpenEXR";
  EXPECT_EQ(lose(kSource + "materialclone ! fakesink"), Names{"materialclone"});
  EXPECT_EQ(lose(kSource + lime + " ! materialclone ! fakesink"), Names{"limematerial"})
      << "each plugin counts its own submits, and the first has more";
}

TEST(LostDevice, WhileKernelsAreWarmedUpIsAnErrorToo) {
  for (const std::string element : {"intrinsicdecomp", "globalintrinsicthesis"})
    for (const char* submit : {"1", "2"}) {
      const auto [status, text] = run_self({{"INVERSE_LOSE_DEVICE", submit}},
                                           {kLaunchOption, kSource + element + " ! fakesink"});
      EXPECT_EQ(status, 1) << element << ": " << text;
      EXPECT_EQ(text.find(element), 0u) << text;
      expect_contains(text, "device was lost");
    }
}

TEST(LostDevice, PendingMessagesArePostedAllTheSame) {
  // Lost with the first frame's base colors, while the frame is being recorded, and later.
  for (const char* submit : {"1", "2", "3"}) {
    const auto [status, text] = lost_at(
        submit,
        {kMarkOption, kSource + "globalintrinsicthesis name=marked tuning=steps=1 ! fakesink"});
    EXPECT_EQ(status, 0);
    EXPECT_EQ(text.substr(0, 28), "inverse-region-marked\nerror\n") << submit << ": " << text;
  }
}

TEST(LostDevice, OnATeeNoBranchHangs) {
  // Which branch comes first is up to the threads.
  const Names noticed =
      lose(kSource +
           "intrinsicdecomp ! tee name=t t. ! queue ! intrinsiccompose ! fakesink "
           "t. ! queue ! intrinsicrecolor key=0xffc83c28 ! intrinsiccompose ! fakesink "
           "t. ! queue ! intrinsicsplit name=s s.shading ! fakesink");
  EXPECT_FALSE(noticed.empty());
  for (const std::string& element : noticed)
    EXPECT_TRUE(element.starts_with("intrinsic")) << element;
}

TEST(LostDevice, IsReplacedWhenThePipelineStartsAgain) {
  const std::string line = kSource + "intrinsicdecomp ! intrinsiccompose ! fakesink";
  for (const char* state : {"null", "ready"}) {
    const auto [status, text] = lost_at("7", {kRestartOption, state, line});
    EXPECT_EQ(status, 0) << state << ": " << text;
    EXPECT_EQ(text.substr(0, 10), "error\nend\n") << state << ": " << text;
  }
}

TEST(LostDevice, WithoutAVulkanDriverTheErrorNamesWhatToInstall) {
  const auto [status, text] =
      run_self({{"VK_ICD_FILENAMES", "/nowhere"}},
               {kLaunchOption, "videotestsrc num-buffers=1 ! intrinsicdecomp ! fakesink"});
  EXPECT_EQ(status, 1) << text;
  expect_contains(text, "mesa-vulkan-drivers");
}

TEST(LostDevice, AnUnknownDeviceListsTheKnownOnes) {
  const auto result =
      run_line("videotestsrc num-buffers=1 ! intrinsicdecomp device=nonesuch ! fakesink");
  expect_contains(result.first_error(), "no Vulkan device matches \"nonesuch\"; there are: 0 =");
}

}  // namespace inverse::testing
