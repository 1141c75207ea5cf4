// SPDX-License-Identifier: LGPL-2.1-or-later
// Any effect on one layer: intrinsicedit, and lines with intrinsicsplit and intrinsicmerge.
#include <algorithm>

#include "tests/elements/element_test.hpp"

namespace inverse::testing {
namespace {

constexpr int kFrames = 4;

std::string source(const std::string& format = "RGBA", int width = 60, int height = 44,
                   int frames = kFrames) {
  return "videotestsrc pattern=smpte num-buffers=" + std::to_string(frames) + " ! " +
         VideoHarness::caps(format, width, height) + " ! ";
}
std::string sink(const std::string& format = "RGBA") {
  return " ! video/x-raw, format=" + format + " ! appsink name=out sync=false";
}
std::string edit(const std::string& layer, const std::string& effect,
                 const std::string& more = {}) {
  return "intrinsicedit name=e layer=" + layer + " effect=\"" + effect + "\" " + more;
}

bool have(const char* factory) {
  GstElementFactory* found = gst_element_factory_find(factory);
  if (found) gst_object_unref(found);
  return found;
}

/// A line's frames, and what intrinsicedit counted.
struct Counted {
  LineResult line;
  guint64 missing = 0, late = 0;
};
Counted run_counted(const std::string& line, unsigned seconds = 60) {
  Counted result;
  GstElement* element = nullptr;
  result.line = run_line(line, seconds, [&](GstElement* pipeline) {
    element = gst_bin_get_by_name(GST_BIN(pipeline), "e");
  });
  if (!element) return result;
  result.missing = find_stat<guint64>(element, "returned-missing").value_or(0);
  result.late = find_stat<guint64>(element, "returned-late").value_or(0);
  gst_object_unref(element);
  return result;
}

/// Fails the test if a line complained or lost frames.
void expect_frames(const LineResult& line, size_t frames = kFrames) {
  EXPECT_TRUE(line.eos);
  EXPECT_EQ(line.errors.size(), 0U) << line.first_error();
  EXPECT_EQ(line.frames.size(), frames);
}

/// Frames without the padding of their rows.
std::vector<std::vector<uint8_t>> pictures(const LineResult& line) {
  std::vector<std::vector<uint8_t>> result;
  for (const auto& frame : line.frames) result.push_back(visible(line.info, frame));
  return result;
}

}  // namespace

TEST(Effects, OneThatDoesNothingReturnsTheFrameBitForBit) {
  for (const char* format : {"RGBA", "I420", "NV12", "GRAY8"})
    for (const auto& [width, height] : {std::pair{60, 44}, {15, 11}, {1, 1}, {2, 3}}) {
      const std::string from = source(format, width, height, 2);
      const auto plain =
          pictures(run_line(from + "intrinsicdecomp ! intrinsiccompose" + sink(format)));
      ASSERT_EQ(plain.size(), 2U);
      for (const char* layer : {"reflectance", "shading"}) {
        const Counted edited = run_counted(from + edit(layer, "identity") + sink(format));
        expect_frames(edited.line, 2);
        EXPECT_EQ(pictures(edited.line), plain) << format << " " << width << "x" << height << layer;
        EXPECT_EQ(edited.missing, 0U);
      }
    }
}

TEST(Effects, SoItDoesInDeepAndWideFormats) {
  for (const std::string format :
       {"RGBA64_LE", "I420_10LE, colorimetry=bt2020", "P010_10LE, colorimetry=bt2100-pq"}) {
    const std::string from = source(format, 160, 90);
    const auto plain =
        run_line(from + "intrinsicdecomp ! intrinsiccompose" + sink("RGBA64_LE")).frames;
    for (const char* layer : {"reflectance", "shading"}) {
      const auto line = run_line(from + edit(layer, "identity") + sink("RGBA64_LE"));
      expect_frames(line);
      EXPECT_EQ(line.frames, plain) << format << " " << layer;
    }
  }
}

TEST(Effects, SoItDoesWithLayersOfLightAndInFormatsOfTheEffect) {
  const std::string decomposer = "globalintrinsic ! ";
  const auto plain = run_line(source() + decomposer + "intrinsiccompose" + sink()).frames;
  for (const char* layer : {"reflectance", "shading", "direct", "indirect"})
    for (const char* effect :
         {"identity", "capsfilter caps=video/x-raw,format=I420",
          "capsfilter caps=video/x-raw,format=AYUV", "capsfilter caps=video/x-raw,format=GRAY8",
          "capsfilter caps=video/x-raw,format=RGB16"})
      EXPECT_EQ(
          run_line(source() + decomposer + edit(layer, effect) + " ! intrinsiccompose" + sink())
              .frames,
          plain)
          << layer << " " << effect;
}

TEST(Effects, SoItDoesWhateverElementsScaleOrConvertOnTheWay) {
  const auto plain = run_line(source() + "intrinsicdecomp ! intrinsiccompose" + sink()).frames;
  for (const char* effect : {"videoscale ! capsfilter caps=video/x-raw,width=30,height=22",
                             "videoscale ! capsfilter caps=video/x-raw,width=100,height=80",
                             "capsfilter caps=video/x-raw,format=RGBA ! videoconvert ! capsfilter "
                             "caps=video/x-raw,format=I420",
                             "capsfilter caps=video/x-raw,format=I420 ! videoconvert ! capsfilter "
                             "caps=video/x-raw,format=RGBA"}) {
    const auto line = run_line(source() + edit("reflectance", effect) + sink());
    expect_frames(line);
    EXPECT_EQ(line.frames, plain) << effect;
  }
}

TEST(Effects, SoItDoesWithAnySettingsOfIntrinsicsplit) {
  const auto plain =
      run_line(source() + "intrinsicdecomp ! intrinsicrecolor ! intrinsiccompose" + sink()).frames;
  for (const char* settings : {"encoding=linear", "shading-scale=0.2 reflectance-scale=0.3",
                               "shading-scale=40", "shading-scale=0"})
    for (const char* layer : {"reflectance", "shading"}) {
      // Before the editor, behind it, and beside it.
      const std::string split =
          std::string("intrinsicsplit name=s ") + settings + " s." + layer + " ! c." + layer;
      for (const std::string& line :
           {"intrinsicdecomp ! intrinsicrecolor ! tee name=t t. ! " + split +
                " t. ! queue ! intrinsiccompose name=c",
            "intrinsicdecomp ! tee name=t t. ! " + split +
                " t. ! queue ! intrinsicmerge name=c ! intrinsicrecolor ! intrinsiccompose",
            "intrinsicdecomp ! tee name=t t. ! " + split +
                " t. ! queue ! intrinsicrecolor ! intrinsiccompose name=c"})
        EXPECT_EQ(run_line(source() + line + sink()).frames, plain) << line;
    }
}

TEST(Effects, TheChangeIsThatOfTheEffect) {
  // No light, no picture.
  const auto dark = run_line(source() + edit("shading", "videobalance brightness=-1") + sink());
  ASSERT_EQ(dark.frames.size(), kFrames) << dark.first_error();
  for (size_t i = 0; i < dark.frames.back().size(); ++i)
    if (i % 4 != 3) {
      ASSERT_EQ(dark.frames.back()[i], 0) << i;
    }
  // Gray paint in gray light.
  const auto gray = run_line(source() +
                             edit("reflectance", "videobalance saturation=0",
                                  "decomposer=\"intrinsicdecomp light-color-slope=0\"") +
                             sink());
  ASSERT_EQ(gray.frames.size(), kFrames) << gray.first_error();
  int color = 0;
  const auto& frame = gray.frames.back();
  for (size_t i = 0; i + 3 < frame.size(); i += 4)
    color = std::max(color, std::abs(frame[i] - frame[i + 2]));
  EXPECT_LE(color, 3);
  // A tint of shading is one of the frame.
  const auto warm = run_line(source() + edit("shading", "coloreffects preset=sepia") + sink());
  const auto plain = run_line(source() + "intrinsicdecomp ! intrinsiccompose" + sink());
  ASSERT_EQ(warm.frames.size(), kFrames) << warm.first_error();
  ASSERT_EQ(plain.frames.size(), kFrames) << plain.first_error();
  double red = 0, blue = 0;
  for (size_t i = 0; i + 3 < frame.size(); i += 4) {
    red += warm.frames.back()[i] - plain.frames.back()[i];
    blue += warm.frames.back()[i + 2] - plain.frames.back()[i + 2];
  }
  EXPECT_GT(red, blue + static_cast<double>(frame.size()) / 4);
}

TEST(Effects, StrengthAndTheMaskLimitIt) {
  const auto plain = run_line(source() + "intrinsicdecomp ! intrinsiccompose" + sink()).frames;
  const std::string dark = "videobalance brightness=-1";
  EXPECT_EQ(run_line(source() + edit("shading", dark, "strength=0") + sink()).frames, plain);
  // A mask of nothing, as nothing has the key.
  const std::string masked =
      "intrinsicdecomp ! intrinsicrecolor strength=0 write-mask=true "
      "key=0xff123456 tolerance=0 softness=0 ! ";
  EXPECT_EQ(
      run_line(source() + masked + edit("shading", dark) + " ! intrinsiccompose" + sink()).frames,
      plain);
  EXPECT_NE(run_line(source() + masked + edit("shading", dark, "use-mask=false") +
                     " ! intrinsiccompose" + sink())
                .frames,
            plain);
  // The mask is a layer, too.
  EXPECT_NE(run_line(source() + masked + edit("mask", "videobalance brightness=1") +
                     " ! intrinsiccompose show=mask" + sink())
                .frames,
            run_line(source() + masked + "intrinsiccompose show=mask" + sink()).frames);
}

TEST(Effects, LayersComeInAndGoOutBetweenEditors) {
  const auto line = run_line(source() + "intrinsicdecomp ! " + edit("shading", "identity") +
                             " ! intrinsicrecolor ! intrinsiccompose" + sink());
  expect_frames(line);
  EXPECT_EQ(
      line.frames,
      run_line(source() + "intrinsicdecomp ! intrinsicrecolor ! intrinsiccompose" + sink()).frames);
}

TEST(Effects, WithoutAnEffectFramesPass) {
  const auto line = run_line(source() + "intrinsicedit" + sink());
  expect_frames(line);
  EXPECT_EQ(line.frames, run_line(source() + "identity" + sink()).frames);
  expect_frames(run_line(source() + "intrinsicdecomp ! intrinsicedit ! intrinsiccompose" + sink()));
}

TEST(Effects, OnesThatHoldBackDropOrEndLoseNoFrame) {
  const std::string from = source("RGBA", 60, 44, 30);
  const auto plain = run_line(from + "intrinsicdecomp ! intrinsiccompose" + sink()).frames;
  for (const auto& [effect, missing] : {std::pair{"queue min-threshold-buffers=9", 0},
                                        {"identity eos-after=11", 20},
                                        {"videorate drop-only=true max-rate=5", -1},
                                        {"queue ! queue", 0}}) {
    const Counted edited = run_counted(from + edit("shading", effect) + sink());
    expect_frames(edited.line, 30);
    EXPECT_EQ(edited.line.frames, plain) << effect;
    EXPECT_EQ(edited.line.warnings.size(), 0U) << effect;
    if (missing >= 0) {
      EXPECT_EQ(edited.missing, static_cast<guint64>(missing)) << effect;
    } else {
      EXPECT_GT(edited.missing, 10U) << effect;
    }
  }
}

TEST(Effects, OneThatSendsNothingHoldsUpTheFirstFrameOnly) {
  const Counted edited = run_counted(source() + edit("shading", "valve drop=true") + sink());
  expect_frames(edited.line);
  EXPECT_EQ(edited.missing, static_cast<guint64>(kFrames));
  expect_one(edited.line.warnings, "no picture came to pad shading", "queue");
}

TEST(Effects, OneThatDropsEverythingIsWarnedOf) {
  const Counted edited = run_counted(source("RGBA", 16, 16, 120) +
                                     edit("shading", "identity drop-probability=1") + sink());
  expect_frames(edited.line, 120);
  EXPECT_EQ(edited.missing, 120U);
  expect_one(edited.line.warnings, "none of 100 pictures came back to pad shading");
}

TEST(Effects, EachFaultIsOneErrorThatSaysWhatToDo) {
  const auto errors = [](const std::string& effect, const std::string& more = {}) {
    return run_line(source() + edit("shading", effect, more) + " ! fakesink").errors;
  };
  expect_one(errors("gausianblur"), "cannot be built", "gausianblur", "gst-launch");
  expect_one(errors("identity ! ! identity"), "cannot be built");
  expect_one(errors("videotestsrc"), "no free sink pad");
  expect_one(errors("fakesink"), "no free source pad");
  expect_one(errors("volume"), "takes no raw video");
  expect_one(errors("pngenc"), "sends no raw video");
  const auto first = [](const std::vector<std::string>& all) {
    return all.empty() ? std::string() : all.front();
  };
  expect_contains(first(errors("identity", "decomposer=none")),
                  "decomposer=\"none\" cannot be built");
  expect_contains(first(errors("identity", "decomposer=identity")), "works on layers");
  expect_contains(first(run_line(source() + edit("indirect", "identity") + " ! fakesink").errors),
                  "globalintrinsic");
  expect_contains(
      first(run_line(source() + "intrinsicdecomp ! " + edit("mask", "identity") + " ! fakesink")
                .errors),
      "write-mask=true");
}

TEST(Effects, TheMaskOfPlainFramesIsOneErrorUnlessTheDecomposerWritesOne) {
  expect_one(run_line(source() + edit("mask", "identity") + " ! fakesink").errors,
             "intrinsicdecomp ! intrinsicselect ! intrinsicedit layer=mask");
  expect_frames(run_line(source() +
                         edit("mask", "identity",
                              "decomposer=\"intrinsicdecomp ! intrinsicrecolor strength=0 "
                              "write-mask=true key=0xff00ff00\"") +
                         sink()));
}

TEST(Effects, AStoppedLineRunsAgain) {
  for (const auto& line :
       run_line_again(source() + edit("shading", "gamma gamma=2") + sink(), 3, {}))
    expect_frames(line);
}

TEST(Effects, ANewOneWaitsForTheNextStart) {
  // Starts with one effect, then sets another one, and starts again or goes on. No noise: a source
  // that starts again goes on with its random numbers.
  const std::string bars = "videotestsrc num-buffers=" + std::to_string(kFrames) +
                           " pattern=smpte75 ! video/x-raw,format=RGBA,width=60,height=44 ! ";
  const auto change = [&](const std::string& effect, bool again) {
    return run_line(bars + edit("shading", effect) + sink(), 60, [&](GstElement* pipeline) {
      GstElement* element = gst_bin_get_by_name(GST_BIN(pipeline), "e");
      gst_element_set_state(pipeline, GST_STATE_PAUSED);
      gst_element_get_state(pipeline, nullptr, nullptr, 60 * GST_SECOND);
      g_object_set(element, "effect", "gamma gamma=2", nullptr);
      if (again) gst_element_set_state(pipeline, GST_STATE_NULL);
      EXPECT_EQ(property<std::string>(element, "effect"), "gamma gamma=2");
      gst_object_unref(element);
    });
  };
  const auto went_on = change("identity", false), again = change("identity", true);
  expect_frames(went_on);
  expect_one(went_on.warnings, "effect cannot change while frames flow", "next start");
  EXPECT_TRUE(went_on.frames == run_line(bars + edit("shading", "identity") + sink()).frames);
  expect_frames(again);
  EXPECT_TRUE(again.frames == change("gamma gamma=2", true).frames);
  EXPECT_TRUE(again.frames != went_on.frames);
}

TEST(Effects, ThoseOfOtherPluginsWork) {
  const auto plain = run_line(source() + "intrinsicdecomp ! intrinsiccompose" + sink()).frames;
  std::string skipped;
  for (const auto& [factory, layer, effect] :
       {std::tuple{"gaussianblur", "shading", "gaussianblur sigma=3"},
        {"frei0r-filter-cartoon", "reflectance", "frei0r-filter-cartoon"},
        {"edgedetect", "reflectance", "edgedetect"},
        {"cvsobel", "shading", "cvsobel"},
        {"videobalance", "shading", "videobalance contrast=1.5"}}) {
    if (!have(factory)) {
      skipped += std::string(" ") + factory;
      continue;
    }
    const Counted edited = run_counted(source() + edit(layer, effect) + sink());
    expect_frames(edited.line);
    EXPECT_NE(edited.line.frames, plain) << effect;
    EXPECT_EQ(edited.missing, 0U) << effect;
  }
  if (!skipped.empty()) GTEST_SKIP() << "not installed:" << skipped;
}

TEST(Effects, ShadersWorkWhereThereIsGl) {
  const std::string shader =
      "glupload ! glcolorconvert ! gleffects effect=sepia ! glcolorconvert ! gldownload";
  if (!have("glupload")) GTEST_SKIP() << "not installed: gstreamer1.0-gl";
  if (!run_line(source() + shader + sink()).eos)
    GTEST_SKIP() << "no OpenGL here; run it under xvfb-run";
  const auto line = run_line(source() + edit("shading", shader) + sink());
  expect_frames(line);
  EXPECT_NE(line.frames, run_line(source() + "intrinsicdecomp ! intrinsiccompose" + sink()).frames);
}

}  // namespace inverse::testing
