// SPDX-License-Identifier: LGPL-2.1-or-later
// lightstagearavissrc with Aravis' camera in software.
#include "aravis_fixture.hpp"
#include "kernels/lightstage/triggers/frame_ids.hpp"
#include "tests/pipeline.hpp"

namespace inverse::testing {
namespace {

using Clock = std::chrono::steady_clock;
using Aravis = FakeCamera;

const std::string kGray = "video/x-raw,format=GRAY8,width=128,height=64,framerate=100/1";
const std::string kOut = " ! appsink name=out sync=false max-buffers=400";

double seconds_since(Clock::time_point began) {
  return std::chrono::duration<double>(Clock::now() - began).count();
}

TEST_F(Aravis, IdsWrapAndEveryFrameIsItsOwn) {
  ASSERT_NO_FATAL_FAILURE(play(source() + " ! " + kGray + kOut));
  ASSERT_NO_FATAL_FAILURE(take_all(220));
  EXPECT_EQ(property<guint>(element("camera"), "frame-id-bits"), 16U);
  EXPECT_GE(camera_stat("frames"), 220U);
  // All stay in use: some are the camera's own memory, the others are copies.
  EXPECT_EQ(camera_stat("zero-copy"), 8U);
  EXPECT_GE(camera_stat("copied"), 212U);
  EXPECT_EQ(camera_stat("underruns"), 0U);
  const uint64_t missed = camera_stat("missed");
  close();

  FrameIds ids(16);
  uint64_t lost = 0;
  bool wrapped = false;
  for (size_t i = 0; i < frames_.size(); ++i) {
    GstBuffer* frame = frames_[i];
    const uint64_t id = GST_BUFFER_OFFSET(frame);
    ASSERT_GE(id, 1U);
    ASSERT_LE(id, 65535U);
    wrapped = wrapped || (ids.last() && *ids.last() > 65000 && id < 100);
    if (ids.last()) {
      ASSERT_GE(ids.after_last(id), 1);
    }
    lost += ids.missed_before(id);
    // The ramp (x + y + id) % 255, also after the stream has ended.
    const auto pixels = bytes_of(frame);
    ASSERT_EQ(pixels.size(), 128U * 64);
    for (const size_t x : {0U, 77U, 127U})
      for (const size_t y : {0U, 63U}) ASSERT_EQ(pixels[y * 128 + x], (x + y + id) % 255) << id;

    auto* meta = gst_buffer_get_reference_timestamp_meta(frame, nullptr);
    ASSERT_NE(meta, nullptr);
    EXPECT_TRUE(
        gst_structure_has_name(gst_caps_get_structure(meta->reference, 0), "timestamp/x-camera"));
    if (i == 0) continue;
    // The camera's clock, at most a thousandth off.
    const auto* before = gst_buffer_get_reference_timestamp_meta(frames_[i - 1], nullptr);
    const auto camera = static_cast<double>(meta->timestamp - before->timestamp);
    ASSERT_GT(GST_BUFFER_PTS(frame), GST_BUFFER_PTS(frames_[i - 1]));
    const auto ours = static_cast<double>(GST_BUFFER_PTS(frame) - GST_BUFFER_PTS(frames_[i - 1]));
    EXPECT_NEAR(ours, camera, 2e-3 * camera + 1000);
  }
  EXPECT_TRUE(wrapped) << "from " << GST_BUFFER_OFFSET(frames_.front()) << " to "
                       << GST_BUFFER_OFFSET(frames_.back());
  // A busy machine loses packets; the element says so.
  EXPECT_LE(lost, missed);
}

/// Rows whose length is no multiple of four, two bytes a pixel.
TEST_F(Aravis, RowsHaveGStreamersStride) {
  struct Case {
    const char* caps;
    size_t stride, bytes;
  };
  for (const Case& one :
       {Case{"video/x-raw,format=GRAY8", 104, 1}, Case{"video/x-raw,format=GRAY16_LE", 204, 2},
        Case{"video/x-bayer,format=rggb", 104, 0}}) {
    SCOPED_TRACE(one.caps);
    ASSERT_NO_FATAL_FAILURE(
        play(source() + " ! " + one.caps + ",width=101,height=33,framerate=50/1" + kOut));
    take(5);
    close();
    ASSERT_EQ(frames_.size(), 5U);
    for (GstBuffer* frame : frames_) {
      const auto pixels = bytes_of(frame);
      ASSERT_EQ(pixels.size(), one.stride * 33);
      const uint64_t id = GST_BUFFER_OFFSET(frame);
      for (size_t y = 0; y < 33 && one.bytes; ++y)
        for (size_t x = 0; x < 101; ++x) {
          const size_t at = y * one.stride + x * one.bytes;
          if (one.bytes == 1)
            ASSERT_EQ(pixels[at], (x + y + id) % 255);
          else
            ASSERT_EQ(pixels[at] + 256U * pixels[at + 1], 256 * (x + y + id) % 65535);
        }
    }
    forget();
  }
}

TEST_F(Aravis, StartsAgainAndGoesOnAfterAPause) {
  ASSERT_NO_FATAL_FAILURE(play(source() + " ! " + kGray + kOut));
  for (const GstState rest : {GST_STATE_NULL, GST_STATE_READY, GST_STATE_PAUSED}) {
    SCOPED_TRACE(gst_element_state_get_name(rest));
    ASSERT_NO_FATAL_FAILURE(take_all(20));
    const GstClockTime last = GST_BUFFER_PTS(frames_.back());
    ASSERT_EQ(gst_element_set_state(pipeline_, rest),
              rest == GST_STATE_PAUSED ? GST_STATE_CHANGE_NO_PREROLL : GST_STATE_CHANGE_SUCCESS);
    // All that the camera sends meanwhile is of no use.
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    forget();
    ASSERT_NE(gst_element_set_state(pipeline_, GST_STATE_PLAYING), GST_STATE_CHANGE_FAILURE);
    if (rest != GST_STATE_PAUSED) continue;
    take(300, 1);
    GstClockTime before = 0;
    uint64_t after = 0;
    for (GstBuffer* frame : frames_) {
      ASSERT_GT(GST_BUFFER_PTS(frame), before);
      before = GST_BUFFER_PTS(frame);
      after += before > last + GST_SECOND / 2;
    }
    EXPECT_GT(after, 20U) << "nothing comes after the pause";
    EXPECT_GT(camera_stat("stale"), 0U);
  }
  EXPECT_EQ(error(0), "");
}

TEST_F(Aravis, ACameraThatDisappearsIsAnError) {
  ASSERT_NO_FATAL_FAILURE(play(source("timeout=1000") + " ! " + kGray + kOut));
  ASSERT_NO_FATAL_FAILURE(take_all(10));
  fake_.reset();
  const auto began = Clock::now();
  expect_contains(error(5), "no frame came from the camera Aravis-Fake-" + serial_);
  EXPECT_LT(seconds_since(began), 4);
  close();
  EXPECT_LT(seconds_since(began), 30);
}

/// A camera that waits for triggers is quiet; only that it is gone is an error.
TEST_F(Aravis, ATriggeredCameraThatDisappearsIsAnError) {
  ASSERT_NO_FATAL_FAILURE(play(source("timeout=200 trigger-source=Software") +
                               " ! video/x-raw,format=GRAY8,width=128,height=64" + kOut));
  EXPECT_EQ(error(1.5), "");
  EXPECT_GT(camera_stat("timeouts"), 3U);
  fake_.reset();
  expect_contains(error(20), "does not answer any more");
}

TEST_F(Aravis, StopsAtOnceWhileItWaits) {
  ASSERT_NO_FATAL_FAILURE(play(source("timeout=0 trigger-source=Software") +
                               " ! video/x-raw,format=GRAY8,width=128,height=64" + kOut));
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  const auto began = Clock::now();
  gst_element_set_state(pipeline_, GST_STATE_READY);
  EXPECT_LT(seconds_since(began), 2.5);
  close();
}

TEST_F(Aravis, InvalidSettingsAreErrors) {
  ASSERT_NO_FATAL_FAILURE(play(source() + " ! " + kGray + kOut));
  take(1);
  // It has one controller.
  {
    Pipeline other(source() + " ! fakesink");
    EXPECT_EQ(other.set(GST_STATE_PLAYING), GST_STATE_CHANGE_FAILURE);
    expect_contains(other.error(1), "is in use by another program");
  }
  g_object_set(element("camera"), "exposure", 1e8, nullptr);
  expect_contains(message(GST_MESSAGE_WARNING, 1), "takes 10.000000 to 10000000.000000 µs");
  g_object_set(element("camera"), "exposure", 20000.0, "gain", 1.0, nullptr);
  EXPECT_EQ(message(GST_MESSAGE_WARNING, .2), "");
  close();

  make("lightstagearavissrc camera-name=Aravis-Fake-none ! fakesink");
  EXPECT_EQ(gst_element_set_state(pipeline_, GST_STATE_PLAYING), GST_STATE_CHANGE_FAILURE);
  expect_contains(error(1), "cannot find the camera Aravis-Fake-none; there are: ");
  expect_contains(error_, "Aravis-Fake-" + serial_);
  close();

  for (const auto& [line, text] : std::vector<std::pair<std::string, std::string>>{
           {source() + " ! video/x-raw,format=BGR ! fakesink",
            "does not offer the requested format"},
           {source("features=\"NoSuchThing=3\"") + " ! fakesink", "NoSuchThing"},
           {source("features=\"Width=64\"") + " ! " + kGray + " ! fakesink",
            "say size and format by caps"},
           {source("trigger-source=Line7") + " ! fakesink", "Line7"},
       }) {
    play(line);
    expect_contains(error(5), text);
    close();
  }
}

TEST_F(Aravis, LostPacketsAreCountedAndReported) {
  ASSERT_NO_FATAL_FAILURE(start_camera("15"));  // of a thousand, and a frame has nine
  ASSERT_NO_FATAL_FAILURE(play(source() + " ! " + kGray + kOut));
  ASSERT_NO_FATAL_FAILURE(take_all(200));
  EXPECT_GE(camera_stat("incomplete"), 5U);
  EXPECT_GE(camera_stat("missed"), 5U);
  expect_contains(message(GST_MESSAGE_WARNING, 1), "did not come whole");
  for (GstBuffer* frame : frames_) {
    const auto pixels = bytes_of(frame);
    for (size_t i = 0; i < pixels.size(); i += 97)
      ASSERT_EQ(pixels[i], (i % 128 + i / 128 + GST_BUFFER_OFFSET(frame)) % 255);
  }
}

}  // namespace
}  // namespace inverse::testing
