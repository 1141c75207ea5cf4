// SPDX-License-Identifier: LGPL-2.1-or-later
// intrinsicrelight: what its lamps light, how they are set and dragged, which files it refuses.
#include <gst/video/navigation.h>

#include <cmath>
#include <thread>

#include "tests/elements/edit/edit_fixture.hpp"
#include "tests/elements/layer_of.hpp"
#include "tests/kernels/environment/normal_map_file.hpp"

namespace inverse::testing {
namespace {

constexpr const char* kLine = "intrinsicdecomp ! intrinsicrelight ! intrinsiccompose";
constexpr const char* kSun = R"([{"kind":"directional","direction":[0,0,-1],"power":1}])";

class RelightElement : public EditorElement {
 protected:
  explicit RelightElement(const std::string& line = kLine)
      : harness_(line, rgba(), rgba()), element_(harness_.find("intrinsicrelight")) {}

  void set(const std::string& lamps) { g_object_set(element_, "lamps", lamps.c_str(), nullptr); }
  void set_mode(const char* mode) {
    gst_util_set_object_arg(G_OBJECT(element_), "lamp-mode", mode);
  }
  std::string lamps() { return property<std::string>(element_, "lamps"); }
  void press(double x, double y) {
    harness_.send_upstream(
        gst_navigation_event_new_mouse_button_press(1, x, y, GST_NAVIGATION_MODIFIER_NONE));
  }
  void move(double x, double y) {
    harness_.send_upstream(gst_navigation_event_new_mouse_move(x, y, GST_NAVIGATION_MODIFIER_NONE));
  }
  void release(double x, double y) {
    harness_.send_upstream(
        gst_navigation_event_new_mouse_button_release(1, x, y, GST_NAVIGATION_MODIFIER_NONE));
  }
  template <typename... Arguments>
  bool call(const char* action, Arguments... arguments) {
    gboolean done = FALSE;
    g_signal_emit_by_name(element_, action, arguments..., &done);
    return done;
  }
  /// Mean of a channel near a place.
  static double mean_at(const std::vector<uint8_t>& shown, int x, int y, int channel) {
    double sum = 0;
    for (int j = -3; j <= 3; ++j)
      for (int i = -3; i <= 3; ++i) sum += pixel_at(shown, x + i, y + j, kWidth)[channel];
    return sum / 49;
  }

  VideoHarness harness_;
  GstElement* element_;
};

/// A depth map of 16 bits, 2 m away.
std::vector<uint8_t> wall() {
  std::vector<uint8_t> codes;
  for (int i = 0; i < 8 * 8; ++i) codes.insert(codes.end(), {2000 >> 8, 2000 & 255});
  return png(8, 8, 1, 16, codes);
}

}  // namespace

TEST_F(RelightElement, ALampLightsWhereItIs) {
  harness_.process(frame);
  set(R"([{"kind":"point","position":[24,20,0.1],"power":0.02}])");
  const auto shown = harness_.process(frame);
  EXPECT_GT(mean_at(shown, 24, 20, 0), mean_at(frame, 24, 20, 0) + 40);
  EXPECT_LT(mean_at(shown, 90, 60, 2), mean_at(frame, 90, 60, 2) + 8);
  // A narrow spot leaves what is beside it.
  set(R"([{"kind":"spot","position":[48,32,0.3],"angle":10,"power":0.1}])");
  const auto spot = harness_.process(frame);
  EXPECT_GT(mean_at(spot, 44, 32, 0), mean_at(frame, 44, 32, 0) + 30);
  EXPECT_LE(std::abs(mean_at(spot, 8, 8, 0) - mean_at(frame, 8, 8, 0)), 1);
}

TEST_F(RelightElement, LampsHaveTheirColor) {
  harness_.process(frame);
  const auto gray = draw(kWidth, kHeight, [](int, int, int) { return 90; });
  set(R"([{"kind":"directional","direction":[0,0,-1],"color":"#ff0000","power":0.5}])");
  const auto shown = harness_.process(gray);
  EXPECT_GT(mean_at(shown, 48, 32, 0), 110);
  EXPECT_NEAR(mean_at(shown, 48, 32, 1), 90, 2);
  EXPECT_NEAR(mean_at(shown, 48, 32, 2), 90, 2);
}

TEST_F(RelightElement, AmbientTakesTheLightAway) {
  g_object_set(element_, "ambient", 0.0F, nullptr);
  const auto dark = harness_.process(frame);
  EXPECT_LT(mean_at(dark, 20, 20, 0), 12) << "black, but for what the model does not explain";
  g_object_set(element_, "ambient", 0.25F, nullptr);
  const auto less = harness_.process(frame);
  EXPECT_GT(mean_at(less, 20, 20, 0), mean_at(dark, 20, 20, 0) + 20);
  EXPECT_LT(mean_at(less, 20, 20, 0), mean_at(frame, 20, 20, 0) - 20);
}

TEST_F(RelightElement, NeutralSettingsReturnTheFrameAndDispatchNothing) {
  expect_neutral("intrinsicrelight",
                 {"", "lamps=\"[]\"", "geometry=flat show-lamps=true",
                  "strength=0 lamps=\"[{\\\"kind\\\":\\\"point\\\",\\\"position\\\":[4,4,1]}]\""});
}

TEST_F(RelightElement, FollowsItsPropertiesWhilePlaying) {
  EXPECT_LE(largest_difference(harness_.process(frame), frame), 1);
  set(R"([{"kind":"directional","direction":[1,0,-1],"power":1}])");
  const auto lit = harness_.process(frame);
  EXPECT_GT(largest_difference(lit, frame), 40);
  g_object_set(element_, "strength", 0.3F, nullptr);
  const auto weaker = harness_.process(frame);
  EXPECT_GT(largest_difference(weaker, lit), 15);
  g_object_set(element_, "strength", 1.0F, "geometry", 2 /* flat */, nullptr);
  const auto flat = harness_.process(frame);
  EXPECT_GT(largest_difference(flat, lit), 5);
  g_object_set(element_, "geometry", 1 /* shading */, "relief", 3.0F, nullptr);
  EXPECT_GT(largest_difference(harness_.process(frame), flat), 20);
  g_object_set(element_, "show-lamps", TRUE, nullptr);
  set(R"([{"kind":"point","position":[48,32,1],"color":"#00ff00","power":0}])");
  const auto marked = harness_.process(frame);
  EXPECT_GT(pixel_at(marked, 48, 32, kWidth)[1], 230);
  set("");
  EXPECT_LE(largest_difference(harness_.process(frame), frame), 1);
  EXPECT_TRUE(harness_.warnings().empty());
}

TEST_F(RelightElement, StrengthFollowsAController) {
  set(kSun);
  expect_strength_follows_a_controller(harness_, element_, 12);
}

TEST_F(RelightElement, AMaskConfinesIt) {
  expect_confined_by_a_mask(
      R"(intrinsicrelight lamps="[{\"kind\":\"directional\",\"direction\":[0,0,-1],\"power\":1}]")");
}

TEST_F(RelightElement, LightWithLayersGetsTheLampAsDirectLight) {
  VideoHarness plain("globalintrinsic", rgba(), kGlobal);
  VideoHarness relit("globalintrinsic ! intrinsicrelight", rgba(), kGlobal);
  g_object_set(relit.find("intrinsicrelight"), "lamps", kSun, "geometry", 2 /* flat */, nullptr);
  const Buffer a = plain.process_buffer(frame), b = relit.process_buffer(frame);
  const auto before = layer_of(a.get(), GST_INVERSE_ROLE_INTRINSIC);
  const auto after = layer_of(b.get(), GST_INVERSE_ROLE_INTRINSIC);
  const auto light = layer_of(a.get(), GST_INVERSE_ROLE_LIGHT);
  const auto lit = layer_of(b.get(), GST_INVERSE_ROLE_LIGHT);
  const auto shares = layer_of(a.get(), GST_INVERSE_ROLE_INDIRECT_0);
  const auto shared = layer_of(b.get(), GST_INVERSE_ROLE_INDIRECT_0);
  ASSERT_EQ(after.size(), before.size());
  ASSERT_FALSE(light.empty() || shares.empty());
  EXPECT_EQ(layer_of(b.get(), GST_INVERSE_ROLE_MODEL_LIGHT), light);
  for (size_t i = 0; i < after.size(); i += 4) {
    const float s = before[i + 3], now = after[i + 3];
    ASSERT_NEAR(now, s + 1, 1e-3 * now);
    ASSERT_NEAR(lit[i + 3] * now, light[i + 3] * s + 1, 2e-3 * now);
    for (size_t c = 0; c < 4; ++c) ASSERT_NEAR(shared[i + c] * now, shares[i + c] * s, 2e-3 * now);
  }
}

TEST_F(RelightElement, TheMouseMovesAddsAndRemovesLamps) {
  press(30, 20);  // before the first frame: ignored
  harness_.process(frame);
  set(R"([{"kind":"point","position":[30,20,0.2]},{"kind":"spot","position":[70,40,0.5]}])");
  harness_.process(frame);
  const std::string before = lamps();
  press(50, 50);  // none is there
  move(55, 55);
  release(55, 55);
  EXPECT_EQ(lamps(), before);
  set_mode("off");
  press(30, 20);
  move(60, 20);
  release(60, 20);
  EXPECT_EQ(lamps(), before);

  set_mode("move");
  press(31, 21);  // a pixel beside it
  move(51, 31);
  expect_contains(lamps(), R"("position":[50.0,30.0,0.2])");
  const auto near = harness_.process(frame);
  move(11, 31);
  const auto moved = harness_.process(frame);
  EXPECT_LT(mean_at(moved, 50, 30, 2), mean_at(near, 50, 30, 2));
  release(11, 31);
  move(90, 60);
  expect_contains(lamps(),
                  R"({"frame":[96,64],"lamps":[{"kind":"point","position":[10.0,30.0,0.2])");
  expect_contains(lamps(), R"("position":[70.0,40.0,0.5],"direction":[0.0,0.0,-1.0])");
  press(70, 40);
  move(1e300, -1e300);  // it stays in the frame
  move(NAN, 3);
  release(0, INFINITY);
  expect_contains(lamps(), R"("position":[96.0,0.0,0.5])");

  set_mode("add");
  gst_util_set_object_arg(G_OBJECT(element_), "lamp-kind", "spot");
  g_object_set(element_, "lamp-color", 0xff2040c0U, "lamp-power", 0.5F, "lamp-height", 0.7F,
               nullptr);
  press(40, 50);
  expect_contains(lamps(),
                  R"({"kind":"spot","position":[40.0,50.0,0.7],"direction":[0.0,0.0,-1.0],)"
                  R"("color":"#2040c0","power":0.5)");
  move(45, 50);
  release(45, 50);
  expect_contains(lamps(), "[45.0,50.0,0.7]");
  set_mode("remove");
  press(45, 50);
  EXPECT_EQ(lamps().find("[45.0,50.0,0.7]"), std::string::npos);
  set_mode("add");
  for (int i = 0; i < 7; ++i) {  // of which the last has no room
    press(12 * i, 60);
    release(12 * i, 60);
  }
  harness_.process(frame);
  expect_one(harness_.warnings(), "8 lamps");
}

TEST_F(RelightElement, ADragOutlivesFlushesAndLampsThatAreRemoved) {
  harness_.process(frame);
  set(R"([{"kind":"point","position":[10,10,0.2]},{"kind":"point","position":[70,40,0.2]}])");
  harness_.process(frame);
  press(70, 40);
  move(72, 40);
  harness_.flush();  // by a seek to the same picture, which shows the step
  harness_.process(frame);
  move(80, 42);
  expect_contains(lamps(), "[80.0,42.0,0.2]");
  EXPECT_TRUE(call("remove-lamp", 1U));
  move(84, 42);
  EXPECT_EQ(lamps().find("[10.0,10.0"), std::string::npos);
  expect_contains(lamps(), "[84.0,42.0,0.2]");
  EXPECT_TRUE(call("remove-lamp", 1U));
  move(20, 20);
  release(20, 20);
  EXPECT_EQ(lamps().find("[20.0,20.0"), std::string::npos);
}

TEST_F(RelightElement, TheSunIsDraggedAroundABall) {
  harness_.process(frame);
  set(kSun);
  harness_.process(frame);
  press(48, 32);
  move(48 + 16, 32);  // half of the ball's radius to the right
  expect_contains(lamps(), R"("direction":[-0.5,0.0,-0.86603])");
  release(64, 32);
}

TEST_F(RelightElement, SignalsChangeTheProperty) {
  EXPECT_TRUE(call("add-lamp", R"({"kind":"point","position":[1,2,3],"color":"#FF8000"})"));
  EXPECT_EQ(
      lamps(),
      R"([{"kind":"point","position":[1.0,2.0,3.0],"color":"#ff8000","power":0.1,"radius":0.02}])");
  EXPECT_TRUE(
      call("add-lamp", R"({"kind":"point","room":true,"position":[1.23456,-2,3],"radius":0.1})"));
  EXPECT_TRUE(call("remove-lamp", 1U));
  EXPECT_EQ(lamps(),
            R"([{"kind":"point","position":[1.2346,-2.0,3.0],"color":"#ffffff","power":0.1,)"
            R"("radius":0.1,"room":true}])");
  EXPECT_TRUE(call("add-lamp", R"({"kind":"directional","direction":[0,1,-1],"power":2})"));
  EXPECT_FALSE(call("remove-lamp", 3U));
  EXPECT_FALSE(call("remove-lamp", 0U));
  EXPECT_TRUE(call("remove-lamp", 1U));
  EXPECT_EQ(lamps(),
            R"([{"kind":"directional","direction":[0.0,1.0,-1.0],"color":"#ffffff","power":2.0}])");
  for (int i = 1; i < 8; ++i)
    EXPECT_TRUE(call("add-lamp", R"({"kind":"point","position":[1,2,3]})"));
  EXPECT_FALSE(call("add-lamp", R"({"kind":"point","position":[1,2,3]})"));
  EXPECT_TRUE(call("clear-lamps"));
  EXPECT_EQ(lamps(), "");
  EXPECT_EQ(harness_.warnings().size(), 3U);
}

TEST_F(RelightElement, PositionsOfAnotherFrameAreScaled) {
  set(R"({"frame":[9600,6400],"lamps":[{"kind":"point","position":[2400,2000,0.1],"power":0.02}]})");
  const auto shown = harness_.process(frame);
  EXPECT_GT(mean_at(shown, 24, 20, 0), mean_at(frame, 24, 20, 0) + 40);
  press(24, 20);
  move(34, 20);
  release(34, 20);
  expect_contains(lamps(),
                  R"({"frame":[9600,6400],"lamps":[{"kind":"point","position":[3400.0,2000.0)");
}

TEST_F(RelightElement, BadLampsAreRefusedInWords) {
  for (const auto& [text, part] : std::initializer_list<std::pair<std::string, std::string>>{
           {"[", "JSON"},
           {"7", "list"},
           {"{}", "list"},
           {"[3]", "object"},
           {R"([{"position":[1,2,3]}])", "kind"},
           {R"([{"kind":"lamp","position":[1,2,3]}])", "kind"},
           {R"([{"kind":"point"}])", "position"},
           {R"([{"kind":"directional","position":[1,2,3]}])", "direction"},
           {R"([{"kind":"point","position":[1,2]}])", "[x, y, z]"},
           {R"([{"kind":"point","position":[1,"2",3]}])", "y of the position of lamp 1"},
           {R"([{"kind":"point","position":[1,2,1e9]}])", "z of the position"},
           {R"([{"kind":"directional","direction":[0,0,0]}])", "[0, 0, 0]"},
           {R"([{"kind":"point","position":[1,2,3],"color":"red"}])", "#rrggbb"},
           {R"([{"kind":"point","position":[1,2,3],"color":"#12345g"}])", "#rrggbb"},
           {R"([{"kind":"point","position":[1,2,3],"power":-1}])", "power"},
           {R"([{"kind":"spot","position":[1,2,3],"angle":0}])",
            "the angle of lamp 1 must be a number"},
           {R"([{"kind":"spot","position":[1,2,3],"softness":2}])", "softness"},
           {R"([{"kind":"point","position":[1,2,3],"radius":null}])", "radius"},
           {R"([{"kind":"point","position":[1,2,3],"size":3}])", "\"size\""},
           {R"([{"kind":"point","position":[1,2,3],"room":1}])", "the room of lamp 1"},
           {R"([{"kind":"point","position":[1001,2,3],"room":true}])", "x of the position"},
           {R"({"frame":[0,3],"lamps":[]})", "width"},
           {std::string(1000, '['), "deep"}}) {
    set(text);
    expect_one(harness_.warnings(), part);
    EXPECT_FALSE(call("add-lamp", text.c_str())) << text;
    harness_.warnings();
  }
  EXPECT_EQ(lamps(), "") << "the value before stays in force";
  std::string many = "[";
  for (int i = 0; i < 9; ++i)
    many += std::string(i ? "," : "") + R"({"kind":"point","position":[1,2,3]})";
  set(many + "]");
  expect_one(harness_.warnings(), "lamps: there are 9 lamps; at most 8");
  EXPECT_LE(largest_difference(harness_.process(frame), frame), 1);
}

TEST_F(RelightElement, DragsAndFramesAtOnce) {
  harness_.process(frame);
  set(R"([{"kind":"point","position":[30,20,0.2]}])");
  harness_.process(frame);
  press(30, 20);
  std::thread mover([&] {
    for (int i = 0; i < 2000; ++i) move(i % 96, i % 64);
  });
  for (int i = 0; i < 5; ++i) harness_.process(frame);
  mover.join();
  release(10, 10);
  expect_contains(lamps(), "[10.0,10.0,0.2]");
  EXPECT_TRUE(harness_.warnings().empty());
}

TEST_F(RelightElement, AFileOfDepthIsTheShape) {
  const NormalMapPath file;
  file.write(wall());
  VideoHarness harness(
      "intrinsicdecomp ! intrinsicrelight location=" + file.path() + " ! intrinsiccompose", rgba(),
      rgba());
  GstElement* relight = harness.find("intrinsicrelight");
  // Half a meter before the wall.
  g_object_set(relight, "lamps", R"([{"kind":"point","position":[24,20,0.5],"power":0.4}])",
               nullptr);
  const auto shown = harness.process(frame);
  EXPECT_GT(mean_at(shown, 24, 20, 0), mean_at(frame, 24, 20, 0) + 40);
  EXPECT_LT(mean_at(shown, 90, 60, 2), mean_at(frame, 90, 60, 2) + 20);
  harness.process(frame, 3);
  EXPECT_NEAR(stat<double>(relight, "plane-depth"), 2, 1e-6);
  g_object_set(relight, "field-of-view", 100.0F, nullptr);
  EXPECT_GT(largest_difference(harness.process(frame), shown), 10);
  // Behind the wall.
  g_object_set(relight, "plane-depth", 4.0F, "field-of-view", 60.0F, nullptr);
  EXPECT_LE(largest_difference(harness.process(frame), frame), 1);
}

TEST_F(RelightElement, AFileOfNormalsIsTheShape) {
  // Left half towards the left, right half towards the right.
  std::vector<uint8_t> codes;
  for (int i = 0; i < 8; ++i)
    for (int x = 0; x < 8; ++x)
      codes.insert(codes.end(), {static_cast<uint8_t>(x < 4 ? 18 : 238), 128, 191});
  const NormalMapPath file;
  file.write(png(8, 8, 3, 8, codes));
  VideoHarness harness(
      "intrinsicdecomp ! intrinsicrelight location=" + file.path() + " ! intrinsiccompose", rgba(),
      rgba());
  g_object_set(harness.find("intrinsicrelight"), "lamps",
               R"([{"kind":"directional","direction":[1,0,-0.01],"power":1}])", nullptr);
  const auto shown = harness.process(frame);
  EXPECT_GT(half_difference(shown, frame, kWidth, false), 40);
  EXPECT_LE(largest_difference({shown.begin() + 4 * 60, shown.begin() + 4 * 90},
                               {frame.begin() + 4 * 60, frame.begin() + 4 * 90}),
            3);
}

TEST_F(RelightElement, ABadFileIsOneErrorWithItsPath) {
  const NormalMapPath file;
  file.write({'n', 'o'});
  for (const auto& [path, part] : std::vector<std::pair<std::string, std::string>>{
           {file.path(), "no PNG"}, {"/nosuch/depth.png", "No such file"}, {"/tmp", "no file"}}) {
    const auto result = run_line(
        "videotestsrc num-buffers=2 ! video/x-raw,width=32,height=24 ! intrinsicdecomp ! "
        "intrinsicrelight location=" +
        path + " ! intrinsiccompose ! fakesink");
    EXPECT_FALSE(result.eos);
    expect_contains(result.first_error(), path + ": ");
    expect_contains(result.first_error(), part);
  }
}

TEST_F(RelightElement, AnyFormatAndSizeWorks) {
  expect_any_format_and_size(line(
      R"(intrinsicrelight lamps="[{\"kind\":\"point\",\"position\":[1,1,0.3],\"color\":\"#ff8000\"}]")"));
}

TEST_F(RelightElement, NaNInLayersStaysInItsPixel) {
  VideoHarness source("intrinsicdecomp", rgba(), kLayers);
  GstBuffer* buffer = gst_buffer_make_writable(source.process_buffer(frame).release());
  auto model = layer_of(buffer, GST_INVERSE_ROLE_INTRINSIC);
  model[4 * 500 + 3] = NAN;
  model[4 * 700] = INFINITY;
  ASSERT_TRUE(replace_layer(buffer, GST_INVERSE_ROLE_MODEL, model));
  ASSERT_TRUE(replace_layer(buffer, GST_INVERSE_ROLE_INTRINSIC, model));
  const std::string layers =
      std::string(kLayers) + ",format=RGBA,width=96,height=64,framerate=25/1";
  VideoHarness editors("intrinsicrelight ! intrinsiccompose", layers, rgba());
  g_object_set(editors.find("intrinsicrelight"), "lamps",
               R"([{"kind":"point","position":[50,10,0.3],"color":"#ff8000","power":0.01}])",
               nullptr);
  ASSERT_EQ(gst_harness_push(editors.harness(), buffer), GST_FLOW_OK);
  const Buffer made(gst_harness_try_pull(editors.harness()));
  ASSERT_TRUE(made);
  const auto bytes = bytes_of(made.get());
  for (size_t n = 0; n < bytes.size() / 4; ++n)
    if (n / 96 > 20) {
      ASSERT_GT(bytes[4 * n] + bytes[4 * n + 2], 20) << n;
    }
}

}  // namespace inverse::testing
