// SPDX-License-Identifier: LGPL-2.1-or-later
// Elements in an order that cannot work: which of them the message names, and what it says to do.
#include <string>
#include <vector>

#include "tests/elements/material/lime_fixture.hpp"
#include "tests/has_element.hpp"

namespace inverse::testing {
namespace {

constexpr const char* kDecomposers[] = {"intrinsicdecomp", "globalintrinsic",
                                        "intrinsicdecompthesis", "globalintrinsicthesis"};
constexpr const char* kSource =
    "videotestsrc num-buffers=3 ! video/x-raw,format=RGBA,width=96,height=64 ! ";

class Chains : public LimeElementTest {
 protected:
  /// A chain with limematerial for "LIME".
  LineResult run_chain(std::string chain) const {
    for (size_t at = 0; (at = chain.find("LIME", at)) != std::string::npos;)
      chain.replace(at, 4, line());
    return run_line(kSource + chain + " ! fakesink");
  }
  /// Expects one warning with all of these parts; no warning if there are none.
  void expect_warning(const std::string& chain, const std::vector<std::string>& parts) const {
    SCOPED_TRACE(chain);
    const auto result = run_chain(chain);
    EXPECT_TRUE(result.eos) << result.first_error();
    ASSERT_EQ(result.warnings.size(), parts.empty() ? 0u : 1u)
        << ::testing::PrintToString(result.warnings);
    for (const std::string& part : parts) expect_contains(result.warnings[0], part);
  }
};

}  // namespace

TEST_F(Chains, APictureOfALayerIsNoFrame) {
  for (const char* first : kDecomposers)
    expect_warning(std::string(first) + " name=first ! intrinsicdecomp name=last",
                   {"last (intrinsicdecomp) gets the picture \"reflectance\" of first (" +
                        std::string(first) + ")",
                    "remove one", "set show=input of first"});
  for (const char* second : kDecomposers)
    expect_warning(std::string("intrinsicdecomp name=first show=mosaic ! ") + second,
                   {second, "gets the picture \"mosaic\" of first"});
  const struct {
    std::string chain;
    std::vector<std::string> parts;
  } cases[] = {
      {"intrinsicdecomp name=first ! globalintrinsic ! intrinsiccompose",
       {"globalintrinsic: ", "\"reflectance\" of first"}},
      {"intrinsicdecomp name=first show=shading ! LIME",
       {"limematerial: ", "\"shading\" of first"}},
      {"LIME show=mirror ! intrinsicdecomp", {"\"mirror\" of lime", "set show=input"}},
      {"intrinsicdecomp ! intrinsiccompose name=c show=shading ! intrinsicdecomp",
       {"\"shading\" of c", "set show=composed of c"}},
      {"intrinsicdecomp ! intrinsicsplit name=s s.reflectance ! queue ! intrinsicdecomp",
       {"\"reflectance\" of s", "use pad input of s"}},
      // Without highlights there is no material.
      {"LIME ! limematerial name=second models=" + files.folder(),
       {"second (limematerial) gets the picture \"diffuse\" of lime", "set show=input"}},
      // What GStreamer's elements do to it leaves it a picture of a layer.
      {"intrinsicdecomp name=first ! videoconvert ! video/x-raw,format=I420 ! videoscale ! "
       "video/x-raw,width=48,height=32 ! videocrop top=2 ! videoflip method=rotate-180 ! queue ! "
       "globalintrinsic",
       {"\"reflectance\" of first"}},
  };
  for (const auto& [chain, parts] : cases) expect_warning(chain, parts);
}

/// What an element passes on as it came is no more of a frame behind it.
TEST_F(Chains, APictureOfALayerRemainsOneBehindElementsThatPassItOn) {
  for (const char* between : {"intrinsicdecomp show=input", "intrinsicdecomp ! intrinsiccompose",
                              "intrinsicdecomp ! intrinsicsplit name=s s.input ! queue"}) {
    const auto result = run_chain(std::string("intrinsicdecomp name=first ! ") + between +
                                  " ! intrinsicdecomp name=last");
    ASSERT_EQ(result.warnings.size(), 2u) << between;
    for (const std::string& warning : result.warnings)
      expect_contains(warning, "\"reflectance\" of first");
  }
}

TEST_F(Chains, FramesMayBeDecomposedAgain) {
  for (const char* chain :
       {"intrinsicdecomp show=input ! globalintrinsic", "LIME show=diffuse ! intrinsicdecomp",
        "LIME show=preview ! intrinsicdecomp", "LIME ! intrinsiccompose ! globalintrinsic",
        "intrinsicdecomp ! intrinsicrecolor ! intrinsiccompose ! intrinsicdecomp",
        "intrinsicdecomp ! intrinsiccompose show=input ! LIME",
        "intrinsicdecomp ! intrinsicsplit name=s s.input ! queue ! intrinsicdecomp",
        "LIME ! intrinsicsplit name=s s.diffuse ! queue ! intrinsicdecomp"})
    expect_warning(chain, {});
}

TEST_F(Chains, AWarningComesAgainOnlyForAnotherPicture) {
  const std::string caps = VideoHarness::caps("RGBA", 32, 24);
  VideoHarness harness("intrinsicdecomp name=first ! globalintrinsic", caps);
  const auto push = [&](const char* show) {
    gst_util_set_object_arg(G_OBJECT(harness.find("intrinsicdecomp")), "show", show);
    EXPECT_FALSE(harness.process(random_frame(caps, 1)).empty());
    return harness.warnings();
  };
  expect_one(push("reflectance"), "\"reflectance\" of first");
  EXPECT_TRUE(push("reflectance").empty());
  EXPECT_TRUE(push("input").empty());
  expect_one(push("shading"), "\"shading\" of first");
  EXPECT_TRUE(push("reflectance").empty());
}

TEST_F(Chains, RelightingAndDecomposingAreNoEditsOfEachOther) {
  if (!has_element("olatrelight")) GTEST_SKIP() << "built without the stage plugin";
  expect_warning("intrinsicdecomp ! olatrelight name=relight",
                 {"relight (olatrelight) gets the picture \"reflectance\""});
  expect_warning("olatrelight name=relight show=normal ! intrinsicdecomp",
                 {"gets the picture \"normal\" of relight", "set show=relit"});
  expect_warning("olatrelight ! globalintrinsic", {});
}

TEST_F(Chains, APairOfGradientsIsNoFrame) {
  if (!has_element("lightstagesync")) GTEST_SKIP() << "built without the stage plugin";
  const auto warnings = [](const std::string& chain) {
    const auto result = run_line(
        "lightstagetestsrc is-live=false program=performance num-buffers=30 ! "
        "video/x-raw,width=64,height=64 ! lightstagesync name=sync program=performance "
        "assemble=pairs ! " +
        chain + " ! fakesink");
    EXPECT_TRUE(result.eos) << result.first_error();
    return result.warnings;
  };
  expect_one(warnings("intrinsicdecomp"), "\"gradients\" of sync (lightstagesync)",
             "set assemble=none of sync");
  EXPECT_TRUE(warnings("olatrelight").empty());
  EXPECT_TRUE(warnings("video/x-raw,format=RGBA ! videoconvert ! olatrelight").empty());
}

}  // namespace inverse::testing
