// SPDX-License-Identifier: LGPL-2.1-or-later
// lightstagesync: cameras that begin at different times, with a marker before every pass and
// without.
#include "stage_fixture.hpp"

namespace inverse::testing {
namespace {

class StageRuns : public StageSync {
 protected:
  void use_marker(LightProgram::Marker marker) {
    LightProgram program = performance(stage_lights(geodesic_directions(42)));
    while (program.steps.size() < 40)
      program.steps.push_back(program.steps[program.steps.size() % 2]);
    program.marker = marker;
    use(program);
  }
  /// Both; the second has time stamps some periods off, and sees lights some triggers behind.
  void play(int64_t from, int64_t to, double off = 0, int64_t behind = 0) {
    const BallOnStage ball(program_, kWidth, kHeight);
    for (int64_t n = from; n < to; ++n) {
      ASSERT_EQ(push(n), GST_FLOW_OK);
      ASSERT_EQ(push(ball.draw(n - behind, 0, 1), static_cast<double>(n) + off, 1), GST_FLOW_OK);
    }
  }
  struct Counts {
    int left = 0, back = 0, causes = 0;
  };
  Counts messages() {
    Counts found;
    while (GstMessage* message = gst_bus_pop(bus_)) {
      if (const GstStructure* what = gst_message_get_structure(message);
          what && gst_structure_has_name(what, "lightstagesync")) {
        const std::string event = gst_structure_get_string(what, "event");
        found.left += event == "camera-excluded" ? 1 : 0;
        found.back += event == "camera-back" ? 1 : 0;
      }
      if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_WARNING)
        found.causes += text_of(message).find("another start") != std::string::npos;
      gst_message_unref(message);
    }
    return found;
  }
  /// Frames continue; cameras that do not belong together may not be reported again.
  void stays_so(int64_t from, double off, int64_t behind = 0) {
    messages();
    for (int64_t n = from; n < from + 60; n += 20) {
      play(n, n + 20, off, behind);
      g_usleep(250000);
    }
    const Counts more = messages();
    EXPECT_EQ(more.left, 0);
    EXPECT_EQ(more.back, 0);
    EXPECT_EQ(more.causes, 0);
  }
};

TEST_F(StageRuns, ACameraThatComesPassesLateMeetsTheOthers) {
  use_marker(LightProgram::Marker::pass);
  g_object_set(element_, "timeout", 30.0, nullptr);
  start(0);
  start(1);
  push_all(-10, 180);
  play(180, 400, 12);
  const guint64 complete = count("sets-complete");
  EXPECT_EQ(complete, 400u - 215);  // from the next marker on
  const auto one = pull(complete, 0), other = pull(complete, 1);
  for (size_t i = 0; i < complete; ++i) EXPECT_EQ(one[i].trigger, other[i].trigger) << i;
  EXPECT_EQ(one.front().trigger, 215);
  EXPECT_EQ(one.back().trigger, 399);
}

TEST_F(StageRuns, ACameraOfUncertainPassesIsReportedOnce) {
  use_marker(LightProgram::Marker::pass);
  g_object_set(element_, "timeout", 0.1, "tuning", "max-frames=1000", nullptr);
  start(0);
  start(1);
  push_all(-10, 20);
  play(20, 150, 21.5);
  EXPECT_TRUE(warned_of("is not certain which passes are the same"));
  stays_so(150, 21.5);
}

TEST_F(StageRuns, StartsSecondsApartAreReportedOnce) {
  use_marker(LightProgram::Marker::start);
  g_object_set(element_, "timeout", 0.1, "tuning", "max-frames=1000", nullptr);
  start(0);
  start(1);
  push_all(-10, 20);
  g_usleep(2500000);  // too long for one and the same marker
  play(140, 210, 0, 150);
  EXPECT_TRUE(warned_of("give it the marker \"pass\""));
  stays_so(210, 0, 150);
}

}  // namespace
}  // namespace inverse::testing
