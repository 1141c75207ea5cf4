// SPDX-License-Identifier: LGPL-2.1-or-later
// Elements in an order that cannot work: which of them the message names, and what it says to do.
#include <string>
#include <vector>

#include "tests/has_element.hpp"
#include "tests/material/elements/lime_fixture.hpp"

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
        "intrinsicdecomp ! intrinsicrecolor key=0xffc83c28 ! intrinsiccompose ! intrinsicdecomp",
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
  expect_contains(run_chain("olatrelight ! intrinsiccompose").first_error(),
                  "insert intrinsicdecomp before it");
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

/// A branch of a tee that takes anything gets layers, too, whichever branch is first.
TEST_F(Chains, EditorsBehindATeeGetLayersInAnyOrderOfBranches) {
  const std::string editor = "t. ! queue ! intrinsicrecolor ! intrinsiccompose ! fakesink ",
                    other = "t. ! queue ! identity ! fakesink ";
  for (const std::string& branches : {editor + other, other + editor}) {
    const auto result = run_line(
        "videotestsrc num-buffers=2 ! video/x-raw,width=64,height=48 ! "
        "intrinsicdecomp ! tee name=t " +
        branches);
    EXPECT_TRUE(result.eos) << branches << result.first_error();
  }
}

/// Editors that get pictures: where the layers ended.
TEST_F(Chains, EditorsWithoutLayersNameWhatTookThem) {
  const struct {
    const char* chain;
    std::vector<std::string> parts;
    const char* absent = "insert intrinsicdecomp";  // which is there
  } cases[] = {
      {"intrinsicdecomp name=first ! tee name=t t. ! queue ! identity name=other ! "
       "video/x-raw,format=RGBA ! fakesink t. ! queue ! intrinsicrecolor ! intrinsiccompose",
       {"intrinsicrecolor works on layers", "first (intrinsicdecomp) sends pictures", "capsfilter",
        "another branch of t (tee)", "put intrinsiccompose before"}},
      {"intrinsicdecomp name=first ! tee name=t t. ! queue ! intrinsiccompose ! fakesink "
       "t. ! queue ! videoscale name=scales ! video/x-raw,width=32,height=24 ! fakesink "
       "t. ! queue ! intrinsicrecolor ! intrinsiccompose",
       {"capsfilter", "put intrinsiccompose before scales (videoscale)"}},
      {"intrinsicdecomp name=first ! tee name=t t. ! queue ! pngenc name=other ! fakesink "
       "t. ! queue ! intrinsicsplit name=s s.shading ! queue",
       {"intrinsicsplit works on layers", "because other (pngenc) in another branch of t (tee)"}},
      {"intrinsicdecomp name=first ! tee name=t t. ! queue ! globalintrinsic name=other ! fakesink "
       "t. ! queue ! intrinsiccompose",
       {"intrinsiccompose works on layers", "because other (globalintrinsic) in another branch"}},
      {"intrinsicdecomp ! bin.( tee name=t t. ! queue ! pngenc name=other ! fakesink t. ! queue ! "
       "intrinsiccompose )",
       {"because other (pngenc) in another branch of t (tee)"}},
      {"intrinsicdecomp name=first ! video/x-raw,format=RGBA ! intrinsicrecolor ! intrinsiccompose",
       {"capsfilter", "between first (intrinsicdecomp) and it takes pictures only", "remove it"}},
      {"intrinsicdecomp ! intrinsiccompose name=c ! intrinsicrecolor ! intrinsiccompose",
       {"c (intrinsiccompose) before it sends pictures",
        "remove c (intrinsiccompose), or put intrinsicrecolor before it"}},
      {"intrinsicdecomp ! intrinsicsplit name=s s.shading ! queue ! intrinsiccompose",
       {"s (intrinsicsplit) before it sends pictures"}},
      {"LIME ! intrinsicrecolor ! intrinsiccompose",
       {"intrinsicrecolor works on layers", "of lime (limematerial)", "highlights, mirror image",
        "put intrinsicdecomp in the place of lime"}},
      {"LIME ! intrinsicdespill ! intrinsiccompose",
       {"of lime (limematerial)", "highlights", "put globalintrinsic in the place of lime"}},
      {"intrinsicdecomp ! intrinsicdespill ! intrinsiccompose",
       {"needs reflectance, direct light and indirect light",
        "these layers are reflectance and shading", "put globalintrinsic"}},
      {"LIME ! intrinsiccompose show=reflectance", {"highlights, mirror image", "no reflectance"}},
      {"LIME ! intrinsiccompose show=direct", {"highlights, mirror image", "direct light"}},
      {"LIME ! intrinsicsplit name=s s.shading", {"highlights, mirror image", "no shading"}},
      {"intrinsicrecolor ! intrinsiccompose",
       {"insert intrinsicdecomp before it"},
       "sends pictures"},
  };
  for (const auto& [chain, parts, absent] : cases) {
    SCOPED_TRACE(chain);
    const std::string error = run_chain(chain).first_error();
    for (const std::string& part : parts) expect_contains(error, part);
    EXPECT_EQ(error.find(absent), std::string::npos) << error;
  }
}

/// What takes pictures only and is linked when it starts, as autovideosink's sink is.
TEST_F(Chains, EditorsThatNothingComposesAreNamed) {
  for (const char* chain : {"intrinsicdecomp ! intrinsicrecolor name=e",
                            "intrinsicdecomp ! intrinsicrecolor ! queue ! intrinsicrecolor name=e",
                            "globalintrinsic ! intrinsicdespill name=e ! queue"}) {
    const std::string caps = VideoHarness::caps("RGBA", 32, 24);
    VideoHarness harness(chain, caps, caps);
    harness.push(random_frame(caps, 1));
    harness.push(random_frame(caps, 2));
    expect_one(harness.errors(), "e (intrinsic", "sends layers", "takes pictures only",
               "insert intrinsiccompose behind e");
  }
}

}  // namespace inverse::testing
