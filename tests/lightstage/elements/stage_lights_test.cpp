// SPDX-License-Identifier: LGPL-2.1-or-later
// lightstagesync as the one that drives the lights.
#include <set>

#include "kernels/lightstage/controllers/dmx_levels.hpp"
#include "kernels/lightstage/controllers/sacn_receiver.hpp"
#include "stage_fixture.hpp"
#include "tests/lightstage/host/serial_controller.hpp"
#include "tests/pipeline.hpp"
#include "tests/update_max.hpp"

namespace inverse::testing {
namespace {

constexpr const char* kCamera =
    "videotestsrc is-live=true ! video/x-raw,width=32,height=24,framerate=60/1 ! ";

/// Whether the lights emit what the program has in a step, within half a minute.
bool shows(sacn::Receiver& receiver, const LightProgram& program, StepKind kind) {
  const DmxPatch patch(program, 1);
  const auto wanted = program.colors(LightStep{kind, 0, {}, {}, {}});
  const gint64 until = g_get_monotonic_time() + 30 * G_USEC_PER_SEC;
  while (g_get_monotonic_time() < until) {
    receiver.poll();
    const auto seen = patch.colors(receiver.levels());
    float off = 0;
    for (size_t i = 0; i < wanted.size(); ++i)
      for (size_t c = 0; c < 3; ++c) update_max(off, std::abs(seen[i][c] - wanted[i][c]));
    if (off < 0.51F / 255) return true;
    g_usleep(500);
  }
  return false;
}

TEST(StageLights, AreSteppedWhilePlayingAndDarkAfterwards) {
  const LightProgram program = performance(stage_lights(geodesic_directions(42)));
  const std::vector<uint32_t> universes = {1};
  sacn::Receiver receiver("127.0.0.1:0", universes);
  Pipeline line(
      std::string(kCamera) +
      "lightstagesync program=performance:42 backend=sacn tuning=lead-in=0.2 host=127.0.0.1:" +
      std::to_string(receiver.port()) + " ! fakesink");
  for (int time = 0; time < 2; ++time) {  // after a pause it restarts
    ASSERT_NE(line.set(GST_STATE_PLAYING), GST_STATE_CHANGE_FAILURE);
    EXPECT_TRUE(shows(receiver, program, StepKind::gradient_a));
    EXPECT_TRUE(shows(receiver, program, StepKind::gradient_b));
    line.set(GST_STATE_PAUSED);
    EXPECT_TRUE(shows(receiver, program, StepKind::black));
  }
}

TEST_F(StageSync, ProgramsThatRestartAfterAPauseAreLabeledAgain) {
  use_performance();
  gst_util_set_object_arg(G_OBJECT(element_), "backend", "sacn");
  const std::vector<uint32_t> universes = {1};
  sacn::Receiver receiver("127.0.0.1:0", universes);
  g_object_set(element_, "host", ("127.0.0.1:" + std::to_string(receiver.port())).c_str(), nullptr);
  start();
  const BallOnStage ball(program_, kWidth, kHeight);
  push_all(-10, 20);
  pull(20);
  gst_element_set_state(element_, GST_STATE_PAUSED);
  gst_element_set_state(element_, GST_STATE_PLAYING);
  for (int64_t n = -10; n < 20; ++n)
    ASSERT_EQ(push(ball.draw(n), static_cast<double>(n + 51)), GST_FLOW_OK);
  const auto again = pull(20);
  EXPECT_EQ(again.front().trigger, 0);
  EXPECT_EQ(again.back().trigger, 19);
  EXPECT_EQ(count("contradicted"), 0u);
  EXPECT_EQ(count("before-marker"), 20u);
}

std::string on_line(const std::string& port) {
  return std::string(kCamera) +
         "lightstagesync program=performance:42 tuning=lead-in=0.1:serial-timeout=60 "
         "backend=serial serial-port=" +
         port + " ! fakesink";
}

TEST(StageLights, StateChangesDoNotWaitForAController) {
  if (!has_pseudo_terminals())
    GTEST_SKIP() << "this system has no pseudo-terminals: mount /dev/pts";
  Controller unresponsive([](const std::string&) { return ""; });
  const gint64 start = g_get_monotonic_time();
  {
    Pipeline line(on_line(unresponsive.path()));
    ASSERT_NE(line.set(GST_STATE_PLAYING), GST_STATE_CHANGE_FAILURE);
    EXPECT_FALSE(unresponsive.lines(1).empty());  // it is being spoken to
  }
  EXPECT_LT(g_get_monotonic_time() - start, 15 * G_USEC_PER_SEC);
}

TEST(StageLights, AControllerIsGivenTheProgramOnce) {
  if (!has_pseudo_terminals())
    GTEST_SKIP() << "this system has no pseudo-terminals: mount /dev/pts";
  ConnectedRig rig;
  {
    Pipeline line(on_line(rig.path()));
    for (int time = 1; time <= 3; ++time) {
      ASSERT_NE(line.set(GST_STATE_PLAYING), GST_STATE_CHANGE_FAILURE);
      const int pulses = rig.count("pulse");
      for (int i = 0; i < 1000 && rig.count("pulse") < pulses + 5; ++i) g_usleep(10000);
      EXPECT_GE(rig.count("pulse"), pulses + 5);
      line.set(GST_STATE_PAUSED);
      for (int i = 0; i < 1000 && rig.count("off") < time; ++i) g_usleep(10000);
    }
  }
  EXPECT_EQ(rig.count("begin"), 1);
  EXPECT_EQ(rig.count("go"), 3);
  EXPECT_EQ(rig.count("off"), 3);
  EXPECT_EQ(rig.after(0), Rig::Lights(42));
}

TEST(StageLights, AnUnreachableControllerIsAnError) {
  Pipeline line(std::string(kCamera) +
                "lightstagesync backend=serial serial-port=/dev/nowhere ! fakesink");
  line.set(GST_STATE_PLAYING);
  expect_contains(line.error(10), "/dev/nowhere");
  Pipeline without(std::string(kCamera) + "lightstagesync backend=serial ! fakesink");
  EXPECT_EQ(without.set(GST_STATE_PLAYING), GST_STATE_CHANGE_FAILURE);
  expect_contains(without.error(10), "port");
}

}  // namespace
}  // namespace inverse::testing
