// SPDX-License-Identifier: LGPL-2.1-or-later
// lightstagetestsrc, by whole lines.
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <numbers>

#include "kernels/lightstage/controllers/light_driver.hpp"
#include "kernels/lightstage/program/light_program.hpp"
#include "kernels/lightstage/virtual_stage/camera_schedule.hpp"
#include "test_source_shots.hpp"
#include "tests/pipeline.hpp"
#include "tests/temporary_folder.hpp"

namespace inverse::testing {
namespace {

namespace fs = std::filesystem;

TEST(LightStageTestSrc, FollowsItsProgramToTheEnd) {
  const LightProgram program = light_program("static:12", 50);
  const Shots shots = shoot("is-live=false program=static:12 rate=50 tuning=label=true");
  EXPECT_TRUE(shots.line.eos) << shots.line.first_error();
  ASSERT_EQ(shots.frames.size(), program.triggers().value());
  EXPECT_EQ(GST_VIDEO_INFO_FPS_N(&shots.line.info), 50);
  for (size_t i = 0; i < shots.frames.size(); ++i) {
    const Frame& frame = shots.frames[i];
    const auto position = program.at(i);
    const bool marker = position.part == LightProgram::Position::Part::marker;
    EXPECT_EQ(frame.time, i * GST_SECOND / 50);
    EXPECT_EQ(frame.duration, GST_SECOND / 50);
    ASSERT_TRUE(frame.labeled);
    EXPECT_EQ(frame.meta.program, program.id());
    EXPECT_EQ(frame.meta.trigger, i);
    EXPECT_EQ(frame.meta.step, marker ? -1 : static_cast<int>(position.index));
    EXPECT_EQ(frame.meta.lights, 12U);
    const auto colors = program.colors(position);
    for (size_t l = 0; l < 12; ++l)
      for (size_t c = 0; c < 3; ++c) EXPECT_EQ(frame.colors[3 * l + c], colors[l][c]);
    const bool olat = program.kind(position) == StepKind::olat;
    EXPECT_EQ(frame.meta.kind == GST_LIGHT_STAGE_OLAT, olat);
    EXPECT_EQ(frame.meta.light, olat ? static_cast<int>(program.steps[position.index].light) : -1);
  }
  // A marker is black, full on, black.
  const auto bright = [&](size_t i) {
    return std::any_of(shots.line.frames[i].begin(), shots.line.frames[i].end(),
                       [](uint8_t x) { return x > 100; });
  };
  EXPECT_FALSE(bright(0));
  EXPECT_TRUE(bright(1));
  EXPECT_FALSE(bright(2));
}

TEST(LightStageTestSrc, LightAddsUp) {
  const LightProgram program = light_program("static:12", 60);
  const Shots shots = shoot("is-live=false program=static:12 gain=0.3", linear16(64, 48));
  ASSERT_EQ(shots.line.frames.size(), program.triggers().value()) << shots.line.first_error();
  std::vector<std::vector<double>> frames;
  for (const auto& frame : shots.line.frames) frames.push_back(samples(frame));
  for (const StepKind kind : {StepKind::tracking, StepKind::gradient_a, StepKind::gradient_b}) {
    size_t at = LightProgram::kMarkerSteps, checked = 0;
    for (const LightStep& step : program.steps) {
      const auto& frame = frames[at++];
      if (step.kind != kind) continue;
      const auto colors = program.colors(step);
      double brightest = 0;
      for (size_t i = 0; i < frame.size(); ++i) {
        if (i % 4 == 3) continue;
        double sum = 0;
        size_t olat = LightProgram::kMarkerSteps;
        for (const LightStep& other : program.steps) {
          if (other.kind == StepKind::olat)
            sum += double{colors[other.light][i % 4]} * frames[olat][i];
          ++olat;
        }
        // Every frame is rounded to 16 bits.
        ASSERT_NEAR(frame[i], sum, .5 * 13 + 1e-6 * sum) << i;
        brightest = std::max(brightest, frame[i]);
      }
      EXPECT_GT(brightest, 3000);
      EXPECT_LT(brightest, 65535);  // nothing is clipped
      ++checked;
    }
    EXPECT_GE(checked, 1U);
  }
}

TEST(LightStageTestSrc, LosesAndRepeatsFramesAsSpecified) {
  const Shots shots = shoot(
      "is-live=false program=performance:4 num-buffers=400 frame-ids=true frame-id-bits=16 "
      "tuning=first-frame-id=65400:drop-rate=0.05:duplicate-rate=0.04:jitter=0.33:late-rate=0.05:"
      "seed=3");
  ASSERT_EQ(shots.frames.size(), 400U) << shots.line.first_error();
  const CameraFaults faults{.05F, .04F, .05F, .33F, 3};
  size_t at = 0, dropped = 0, doubled = 0;
  GstClockTime last = 0;
  for (uint64_t n = 0; at < 400; ++n) {
    const FrameFate fate = fate_of(n, faults);
    if (fate.dropped) {
      ++dropped;
      continue;
    }
    const double expected =
        std::max((static_cast<double>(n) + fate.shift) / 60 * 1e9, static_cast<double>(last));
    for (int copy = 0; copy <= (fate.duplicated ? 1 : 0) && at < 400; ++copy, ++at) {
      EXPECT_EQ(shots.frames[at].offset, frame_id(n, 65400, 16));
      EXPECT_NEAR(static_cast<double>(shots.frames[at].time), expected, 1e4);
      EXPECT_GE(shots.frames[at].time, last);
      last = shots.frames[at].time;
      if (copy) {
        ++doubled;
        EXPECT_EQ(shots.line.frames[at], shots.line.frames[at - 1]);
      }
    }
  }
  EXPECT_GT(dropped, 8U);
  EXPECT_GT(doubled, 5U);
}

TEST(LightStageTestSrc, StartsLaterOnRequest) {
  const Shots shots = shoot(
      "is-live=false program=static:2 rate=20 start=0.35 frame-ids=true "
      "tuning=label=true:first-frame-id=5");
  const LightProgram program = light_program("static:2", 20);
  ASSERT_EQ(shots.frames.size(), 7 + program.triggers().value()) << shots.line.first_error();
  for (size_t i = 0; i < shots.frames.size(); ++i) {
    EXPECT_EQ(shots.frames[i].time, i * GST_SECOND / 20);
    EXPECT_EQ(shots.frames[i].offset, 5 + i);
    EXPECT_EQ(shots.frames[i].meta.trigger, i < 7 ? 0 : i - 7);
    const auto kind = i < 7 ? StepKind::black : program.kind(program.at(i - 7));
    EXPECT_EQ(shots.frames[i].meta.kind == GST_LIGHT_STAGE_BLACK, kind == StepKind::black) << i;
  }
}

/// Rendering takes a while; the program does not pass meanwhile.
TEST(LightStageTestSrc, LiveProgramsBeginWithTheirMarker) {
  const Shots shots =
      shoot("program=static:60 tuning=label=true num-buffers=2", "width=320,height=240");
  ASSERT_EQ(shots.frames.size(), 2U) << shots.line.first_error();
  EXPECT_EQ(shots.frames[0].meta.trigger, 0U);
  EXPECT_LE(shots.frames[1].meta.trigger, 3U);  // nor does it while kernels are built
  const double periods = static_cast<double>(shots.frames[0].time) * 60 / GST_SECOND;
  EXPECT_NEAR(periods, std::round(periods), 1e-6);
}

TEST(LightStageTestSrc, SeedsRepeatNoise) {
  const std::string source =
      "is-live=false program=performance:4 num-buffers=3 noise=0.1 tuning=seed=";
  const auto first = shoot(source + "1").line.frames, again = shoot(source + "1").line.frames,
             other = shoot(source + "2").line.frames;
  ASSERT_EQ(first.size(), 3U);
  EXPECT_EQ(first, again);
  EXPECT_NE(first, other);
  EXPECT_NE(first[0], first[2]);  // both black but for noise
}

TEST(LightStageTestSrc, MotionIsAsSpecified) {
  // Two steps of tracking: all that changes is motion.
  const TemporaryFolder folder;
  const std::string path = folder / "still.json";
  LightProgram program = light_program("performance:6", 60);
  program.steps.assign(1, {StepKind::tracking});
  program.marker = LightProgram::Marker::none;
  program.save(path);
  const int width = 64, height = 48;
  const auto still =
      shoot("is-live=false num-buffers=10 gain=0.1 program=" + path, linear16(width, height))
          .line.frames;
  const auto moved = shoot(
                         "is-live=false num-buffers=10 gain=0.1 motion=6 tuning=motion-period=0.5 "
                         "program=" +
                             path,
                         linear16(width, height))
                         .line.frames;
  ASSERT_EQ(moved.size(), 10U);
  const auto rest = samples(still[0]);
  for (size_t n = 0; n < moved.size(); ++n) {
    const auto frame = samples(moved[n]);
    const double sway = 6 * std::sin(2 * std::numbers::pi * static_cast<double>(n) / 60 / .5);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        for (int c = 0; c < 3; ++c) {
          const double from = std::clamp(x - sway * (1 - y / (height - 1.0)), 0.0, width - 1.0);
          const int left = std::min(static_cast<int>(from), width - 2);
          const double f = from - left;
          const auto at = [&](int column) { return rest[4 * (y * width + column) + c]; };
          ASSERT_NEAR(frame[4 * (y * width + x) + c], at(left) * (1 - f) + at(left + 1) * f, 2.5)
              << n << " " << x << " " << y;
        }
  }
  EXPECT_NE(still[0], moved[5]);
}

TEST(LightStageTestSrc, SizesAndFormats) {
  for (const char* caps :
       {"format=RGBA,width=16,height=16", "format=RGB,width=1,height=1",
        "format=I420,width=33,height=17", "format=P010_10LE,width=50,height=30",
        "format=YUY2,width=31,height=9", "format=GRAY16_LE,width=8,height=300"}) {
    const Shots shots = shoot("is-live=false program=performance:3 num-buffers=5", caps);
    EXPECT_EQ(shots.line.frames.size(), 5U) << caps << " " << shots.line.first_error();
  }
  // Not requested.
  const LineResult line = run_line(
      "lightstagetestsrc is-live=false program=performance:2 num-buffers=2 ! appsink name=out",
      120);
  EXPECT_EQ(GST_VIDEO_INFO_WIDTH(&line.info), 320);
  EXPECT_EQ(GST_VIDEO_INFO_HEIGHT(&line.info), 240);
  EXPECT_EQ(GST_VIDEO_INFO_FPS_N(&line.info), 60);
  EXPECT_EQ(GST_VIDEO_INFO_FORMAT(&line.info), GST_VIDEO_FORMAT_RGBA);
}

TEST(LightStageTestSrc, CapsMayChange) {
  Pipeline pipeline(
      "lightstagetestsrc is-live=false program=performance:3 ! capsfilter name=filter "
      "caps-change-mode=delayed "
      "caps=video/x-raw,format=RGBA,width=32,height=24 ! "
      "appsink name=out sync=false max-buffers=2");
  pipeline.set(GST_STATE_PLAYING);
  for (const auto& [width, height] : {std::pair{32, 24}, {40, 30}, {40, 20}, {16, 16}}) {
    GstCaps* caps = gst_caps_new_simple("video/x-raw", "format", G_TYPE_STRING, "RGBA", "width",
                                        G_TYPE_INT, width, "height", G_TYPE_INT, height, nullptr);
    g_object_set(pipeline.find("filter"), "caps", caps, nullptr);
    gst_caps_unref(caps);
    bool came = false;
    for (int i = 0; i < 100 && !came; ++i) {
      GstSample* sample = pipeline.sample("out");
      ASSERT_NE(sample, nullptr);
      gint now = 0;
      gst_structure_get_int(gst_caps_get_structure(gst_sample_get_caps(sample), 0), "height", &now);
      came = now == height;
      gst_sample_unref(sample);
    }
    EXPECT_TRUE(came) << height;
  }
}

TEST(LightStageTestSrc, IsAsSlowAsTime) {
  const auto start = std::chrono::steady_clock::now();
  const Shots shots = shoot("program=performance:3 num-buffers=31 rate=30");
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  EXPECT_EQ(shots.frames.size(), 31U) << shots.line.first_error();
  EXPECT_GT(took.count(), 30 / 30.0);
  // A machine that is busy loses frames, as cameras do; those that come are in their places.
  for (const Frame& frame : shots.frames) {
    const double n = static_cast<double>(frame.time) * 30 / GST_SECOND;
    EXPECT_NEAR(n, std::round(n), 1e-6);
  }
}

void expect_stops_soon(Pipeline& pipeline) {
  const auto start = std::chrono::steady_clock::now();
  pipeline.set(GST_STATE_NULL);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(20));
}

TEST(LightStageTestSrc, StopsWhileItWaits) {
  Pipeline pipeline(
      "lightstagetestsrc program=performance:2 rate=1 ! "
      "video/x-raw,width=16,height=16 ! fakesink");
  for (int i = 0; i < 3; ++i) {
    pipeline.set(GST_STATE_PLAYING);
    gst_element_get_state(pipeline.get(), nullptr, nullptr, GST_SECOND);
    expect_stops_soon(pipeline);
  }
}

TEST(LightStageTestSrc, StopsWhileItRenders) {
  Pipeline pipeline(
      "lightstagetestsrc tuning=stack-limit=8192 ! video/x-raw,width=1024,height=768 ! fakesink");
  pipeline.set(GST_STATE_PLAYING);
  g_usleep(1500000);  // all of it takes a minute and more
  expect_stops_soon(pipeline);
  EXPECT_EQ(pipeline.error(0), "");
}

TEST(LightStageTestSrc, FollowsPackets) {
  const LightProgram program = light_program("performance:5", 60);
  const std::string port = std::to_string(20000 + getpid() % 10000);
  LightDriverSettings settings;
  settings.backend = LightDriverSettings::Backend::sacn;
  settings.sacn.destination = "127.0.0.1:" + port;
  const auto driver = make_light_driver(settings);
  Pipeline pipeline(
      "lightstagetestsrc is-live=false tuning=label=true program=performance:5 gain=0.5 "
      "listen=127.0.0.1:" +
      port + " ! video/x-raw," + linear16(32, 24) + " ! appsink name=out sync=false max-buffers=1");
  pipeline.set(GST_STATE_PLAYING);
  const auto next = [&](std::vector<float>& colors) {
    std::vector<uint8_t> bytes;
    GstSample* sample = pipeline.sample("out");
    if (!sample) return bytes;
    GstBuffer* buffer = gst_sample_get_buffer(sample);
    bytes = bytes_of(buffer);
    colors = floats_of(gst_buffer_get_light_stage_meta(buffer)->colors);
    gst_sample_unref(sample);
    return bytes;
  };
  const Shots truth =
      shoot("is-live=false num-buffers=5 program=performance:5 gain=0.5", linear16(32, 24));
  ASSERT_EQ(truth.line.frames.size(), 5U) << truth.line.first_error();
  std::vector<float> colors;
  ASSERT_FALSE(next(colors).empty());  // it listens
  EXPECT_EQ(colors, std::vector<float>(15));
  driver->upload(program);
  for (uint64_t trigger = 1; trigger < 5; ++trigger) {
    driver->show(trigger);
    std::vector<uint8_t> frame;
    for (int i = 0; i < 4; ++i) frame = next(colors);  // those that were on their way are older
    const auto expected = program.colors(program.at(trigger));
    for (size_t l = 0; l < 5; ++l)
      for (size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(colors[3 * l + c], expected[l][c], .5 / 255 + 1e-6);
    const auto got = samples(frame), wanted = samples(truth.line.frames[trigger]);
    for (size_t i = 0; i < got.size(); ++i)
      EXPECT_NEAR(got[i], wanted[i], 65535 * .01) << "trigger " << trigger << ", sample " << i;
  }
  driver->black();
  for (int i = 0; i < 4; ++i) next(colors);
  EXPECT_EQ(colors, std::vector<float>(15));
  // The port is taken.
  const Shots second =
      shoot("is-live=false num-buffers=1 program=performance:5 listen=127.0.0.1:" + port);
  expect_contains(second.line.first_error(), "another program listens");
}

TEST(LightStageTestSrc, InvalidSettingsAreErrors) {
  expect_contains(error_of("program=/no/such/program.json"), "/no/such/program.json");
  expect_contains(error_of("program=performance:0"), "the number of lights");
  expect_contains(error_of("", "width=8000,height=4000"), "use a smaller frame");
  expect_contains(error_of("tuning=stack-limit=1", "width=320,height=240"), "the limit is 1 MiB");
  expect_contains(error_of("listen=nowhere.invalid"), "cannot find the host");
  expect_contains(error_of("device=no-such-device"), "no-such-device");
}

}  // namespace
}  // namespace inverse::testing
