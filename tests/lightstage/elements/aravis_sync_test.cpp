// SPDX-License-Identifier: LGPL-2.1-or-later
// lightstagesync camera-trigger=aravis-software with the camera in software, and lights that are
// heard over streaming ACN on loopback.
#include <cmath>
#include <map>
#include <mutex>

#include "aravis_fixture.hpp"
#include "gst/inverse/inverse_light_stage_meta.h"
#include "kernels/lightstage/controllers/dmx_levels.hpp"
#include "kernels/lightstage/controllers/sacn_receiver.hpp"
#include "tests/temporary_folder.hpp"

namespace inverse::testing {
namespace {

const std::string kSmall = "video/x-raw,format=GRAY8,width=64,height=48";

class AravisSync : public FakeCamera {
 protected:
  void write_program(uint64_t passes) {
    program_ = {};
    program_.name = "test";
    program_.lights = stage_lights(geodesic_directions(12));
    program_.repeat = passes;
    for (uint32_t light = 0; light < 12; ++light) program_.steps.push_back({StepKind::olat, light});
    program_.steps.push_back({StepKind::gradient_a});
    program_.steps.push_back({StepKind::gradient_b});
    program_.check();
    program_.save(folder_ / "program.json");
  }
  std::string line(const std::string& more = "", const std::string& camera = "") const {
    return source(camera) + " ! " + kSmall +
           " ! queue name=before ! lightstagesync name=sync program=" + (folder_ / "program.json") +
           " camera-trigger=aravis-software " + more +
           " ! appsink name=out sync=false max-buffers=2";
  }
  guint64 sync_stat(const char* name) { return stat<guint64>(element("sync"), name); }
  /// What the lights of a frame are by its label; nothing without one.
  static std::vector<float> label(GstBuffer* frame) {
    const GstLightStageMeta* meta = gst_buffer_get_light_stage_meta(frame);
    return floats_of(meta ? meta->colors : nullptr);
  }
  static uint64_t trigger(GstBuffer* frame) {
    return gst_buffer_get_light_stage_meta(frame)->trigger;
  }

  TemporaryFolder folder_;
  LightProgram program_;
};

/// Receives the lights' levels and records which were on when a frame left the camera.
struct Witness {
  Witness(const LightProgram& program, const std::vector<uint32_t>& universes)
      : patch(program, 1), receiver("127.0.0.1:0", universes) {}
  void see(GstBuffer* frame) {
    const std::lock_guard lock(mutex);
    receiver.poll();
    lit[GST_BUFFER_OFFSET(frame)] = patch.colors(receiver.levels());
  }
  DmxPatch patch;
  sacn::Receiver receiver;
  std::mutex mutex;
  std::map<uint64_t, std::vector<LightColor>> lit;
};

TEST_F(AravisSync, EveryFrameIsLabeledWithTheLightItWasTakenIn) {
  write_program(11);  // 154 frames and the marker's: ids wrap
  Witness witness(program_, {1});
  ASSERT_NO_FATAL_FAILURE(
      play(line("backend=sacn host=127.0.0.1:" + std::to_string(witness.receiver.port()) +
                " tuning=trigger-timeout=2")));
  watch_buffers(element("before"), "sink", [&](GstBuffer* frame) { witness.see(frame); });
  take(1000);  // to the end
  EXPECT_EQ(error(0), "");
  ASSERT_EQ(frames_.size(), 157U);
  EXPECT_EQ(sync_stat("triggers"), 157U);
  EXPECT_EQ(sync_stat("labeled"), 157U);
  EXPECT_EQ(sync_stat("triggers-dropped") + sync_stat("frames-doubtful"), 0U);
  size_t compared = 0;
  for (size_t i = 0; i < frames_.size(); ++i) {
    ASSERT_EQ(trigger(frames_[i]), i);
    const auto expected = program_.colors(program_.at(i));
    const auto labeled = label(frames_[i]);
    ASSERT_EQ(labeled.size(), 3 * expected.size());
    const auto seen = witness.lit.find(GST_BUFFER_OFFSET(frames_[i]));
    if (seen == witness.lit.end()) continue;  // it left before the probe was there
    ++compared;
    for (size_t light = 0; light < expected.size(); ++light)
      for (size_t c = 0; c < 3; ++c) {
        EXPECT_EQ(labeled[3 * light + c], expected[light][c]);
        EXPECT_NEAR(seen->second[light][c], expected[light][c], .5F / 255 + 1e-6F)
            << "trigger " << i << " light " << light;
      }
  }
  EXPECT_GE(compared, 140U);
  EXPECT_LT(GST_BUFFER_OFFSET(frames_.back()), 65400U) << "ids did not wrap";
}

TEST_F(AravisSync, GoesOnAfterAPauseAndStartsAgain) {
  write_program(0);
  ASSERT_NO_FATAL_FAILURE(play(line()));
  ASSERT_NO_FATAL_FAILURE(take_all(10));
  gst_element_set_state(pipeline_, GST_STATE_PAUSED);
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  gst_element_set_state(pipeline_, GST_STATE_PLAYING);
  ASSERT_NO_FATAL_FAILURE(take_all(20));
  // The step in which the pause began may be without a frame. None comes twice.
  uint64_t gaps = 0;
  for (size_t i = 1; i < frames_.size(); ++i) {
    ASSERT_GT(trigger(frames_[i]), trigger(frames_[i - 1]));
    gaps += trigger(frames_[i]) - trigger(frames_[i - 1]) - 1;
  }
  EXPECT_LE(gaps, 2U);
  gst_element_set_state(pipeline_, GST_STATE_NULL);
  forget();
  ASSERT_NE(gst_element_set_state(pipeline_, GST_STATE_PLAYING), GST_STATE_CHANGE_FAILURE)
      << error(0);
  ASSERT_NO_FATAL_FAILURE(take_all(10));
  EXPECT_EQ(trigger(frames_.front()), 0U);
  EXPECT_EQ(error(0), "");
}

TEST_F(AravisSync, LostFramesAreTakenAgain) {
  ASSERT_NO_FATAL_FAILURE(start_camera("15"));
  write_program(6);
  ASSERT_NO_FATAL_FAILURE(play(line("tuning=trigger-timeout=0.4:trigger-retries=5")));
  take(1000);
  EXPECT_EQ(error(0), "");
  EXPECT_GE(sync_stat("triggers-retried"), 1U);
  ASSERT_EQ(frames_.size() + sync_stat("triggers-dropped"), 87U);
  EXPECT_GE(frames_.size(), 85U);
}

TEST_F(AravisSync, ACameraThatDisappearsIsAnError) {
  write_program(0);
  ASSERT_NO_FATAL_FAILURE(play(line()));
  ASSERT_NO_FATAL_FAILURE(take_all(10));
  fake_.reset();
  EXPECT_NE(error(20), "");
  const auto began = std::chrono::steady_clock::now();
  close();
  EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(30));
}

TEST_F(AravisSync, LatencyHasNoTermForCamerasThatMayBeTriggeredAgain) {
  write_program(1);
  make(
      "lightstagesync name=sync camera-trigger=aravis-software tuning=trigger-timeout=2 "
      "timeout=0.3 "
      "program=" +
      (folder_ / "program.json") +
      " sync.src_0 ! appsink name=out sync=false sync.src_1 ! fakesink " + source("") + " ! " +
      kSmall + " ! tee name=both ! queue ! sync.sink_0 both. ! queue ! sync.sink_1");
  ASSERT_NE(gst_element_set_state(pipeline_, GST_STATE_PAUSED), GST_STATE_CHANGE_FAILURE)
      << error(0);
  GstPad* pad = gst_element_get_static_pad(element("sync"), "src_0");
  GstQuery* query = gst_query_new_latency();
  EXPECT_TRUE(gst_pad_query(pad, query));
  GstClockTime smallest = 0;
  gst_query_parse_latency(query, nullptr, &smallest, nullptr);
  EXPECT_GE(smallest, 300 * GST_MSECOND);
  EXPECT_LT(smallest, GST_SECOND);  // sets wait for 10 s
  gst_query_unref(query);
  gst_object_unref(pad);
  close();
}

TEST_F(AravisSync, IncompatibleSettingsAreErrors) {
  write_program(1);
  const auto fails = [&](const std::string& line, const std::string& text) {
    make(line);
    EXPECT_EQ(gst_element_set_state(pipeline_, GST_STATE_PLAYING), GST_STATE_CHANGE_FAILURE);
    expect_contains(error(1), text);
    close();
  };
  fails("videotestsrc ! lightstagesync camera-trigger=aravis-software ! fakesink",
        "no camera to trigger upstream of sink_0");
  fails(line("", "trigger-source=Line0"), "trigger-source=Line0");
  // Lights are spoken to while the cameras start.
  make(line("backend=serial serial-port=/dev/no-such-port"));
  gst_element_set_state(pipeline_, GST_STATE_PLAYING);
  expect_contains(error(20), "/dev/no-such-port");
}

}  // namespace
}  // namespace inverse::testing
