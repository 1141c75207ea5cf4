// SPDX-License-Identifier: LGPL-2.1-or-later
// soak [--quick] [--decomposer FACTORY] [--frames N] [--caps-changes N] [--cycles N] [--scenes N]
//      [--sizes N] [--device-slack MIB]
//
// Long runs through a decomposer and an editing chain, monitored for growth: frames with flushing
// seeks, caps changes, start-stop cycles, extreme changes of scene, rounds of sizes up to 8192x8192
// before a slow sink (12 GB on a software device). Without --decomposer and
// --quick, some hundred frames of each of the thesis' elements, of limematerial with materialclone,
// and of olatrelight follow. Exit status 1 if memory, open files or threads grow, an element posts
// an error, or nothing happens for a minute.
#include <gst/app/gstappsrc.h>
#include <gst/gst.h>
#include <gst/video/video.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <random>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "growth.hpp"
#include "line.hpp"
#include "scenes.hpp"
#include "tests/has_element.hpp"

namespace inverse::soak {
namespace {

constexpr const char* kChain =
    " name=decomposer ! intrinsicrecolor cluster=0 ! intrinsicrecolor key=0xffff0000 ! "
    "intrinsiccompose";
constexpr const char* kEnd = " ! video/x-raw ! fakesink name=sink sync=false signal-handoffs=true";

/// A phase with count 0 is skipped.
struct Plan {
  std::string decomposer = "intrinsicdecomp";
  std::string chain = kChain;  ///< the element's name, properties, and what follows it
  unsigned frames = 10000, caps_changes = 200, cycles = 50, scenes = 1000, sizes = 5;
  /// Pools grow by a plane (0.1 MiB) whenever frames in flight first need one more, depending on
  /// timing; leaks per frame, seek or scene are far larger.
  Slack slack{.device_mib = 0.5};
};

std::string line_of(const Plan& plan, const std::string& source) {
  return source + " ! " + plan.decomposer + plan.chain + kEnd;
}

void progress(const char* phase, unsigned done, unsigned all, const Holding& now) {
  fprintf(stderr,
          "%-12s %6u of %u: %.1f MiB resident, %.2f MiB on the device, %.0f files, %.0f threads\n",
          phase, done, all, now.resident_mib, now.device_mib, now.descriptors, now.threads);
}

/// Frames at one size; two samples to a seek.
Growth soak_frames(const Plan& plan) {
  Growth growth("frames", plan.slack);
  Line line(line_of(
      plan,
      "videotestsrc pattern=ball ! video/x-raw,format=RGBA,width=96,height=72,framerate=30/1"));
  line.set_state(GST_STATE_PLAYING);
  std::mt19937 random(1);
  constexpr unsigned kSamples = 60;
  for (unsigned i = 1; i <= kSamples; ++i) {
    line.wait_for(plan.frames * i / kSamples);
    growth.sample_now(line.device_bytes());
    if (i % 2 == 0) line.seek(random() % 600 * GST_SECOND);
    if (i % 10 == 0) progress("frames", line.frames(), plan.frames, growth.last());
  }
  return growth;
}

/// Sizes and formats in turn; a sample after each round. Stats describe the last frame that is
/// done, which has begun at most kFramesInFlight frames ago: of five frames, it is the second or a
/// later one, by which time all that a size needs is allocated.
Growth soak_caps(const Plan& plan) {
  struct Caps {
    const char* format;
    int width, height;
  };
  constexpr Caps kRound[] = {
      {"RGBA", 96, 72}, {"NV12", 64, 48}, {"YUY2", 130, 74}, {"I420", 35, 29}};
  constexpr int kFrames = 5;
  Growth growth("caps", plan.slack);
  Line line(line_of(plan, "appsrc name=source format=time block=true max-buffers=2"));
  GstElement* source = line.find("source");
  line.set_state(GST_STATE_PLAYING);
  std::mt19937 random(2);
  unsigned frames = 0;
  for (unsigned change = 0; change < plan.caps_changes; ++change) {
    const Caps& caps = kRound[change % std::size(kRound)];
    GstVideoInfo info;
    gst_video_info_set_format(&info, gst_video_format_from_string(caps.format),
                              static_cast<guint>(caps.width), static_cast<guint>(caps.height));
    info.fps_n = 30;
    GstCaps* text = gst_video_info_to_caps(&info);
    gst_app_src_set_caps(GST_APP_SRC(source), text);
    gst_caps_unref(text);
    for (int i = 0; i < kFrames; ++i) {
      GstBuffer* buffer = gst_buffer_new_allocate(nullptr, info.size, nullptr);
      gst_buffer_memset(buffer, 0, static_cast<guint8>(random()), info.size);
      GST_BUFFER_PTS(buffer) = gst_util_uint64_scale(frames++, GST_SECOND, 30);
      GST_BUFFER_DURATION(buffer) = GST_SECOND / 30;
      if (gst_app_src_push_buffer(GST_APP_SRC(source), buffer) != GST_FLOW_OK) break;
    }
    line.wait_for(frames);
    if ((change + 1) % std::size(kRound) != 0) continue;
    growth.sample_now(line.device_bytes());
    if ((change + 1) % 40 == 0) progress("caps", change + 1, plan.caps_changes, growth.last());
  }
  return growth;
}

/// NULL → PLAYING → NULL, alternately at the end of the stream and in the middle; every fifth time
/// with a new pipeline.
Growth soak_cycles(const Plan& plan) {
  constexpr const char* kSource =
      "videotestsrc num-buffers=6 ! video/x-raw,format=NV12,width=96,height=72,framerate=30/1";
  Growth growth("start-stop", plan.slack);
  auto line = std::make_unique<Line>(line_of(plan, kSource));
  for (unsigned cycle = 0; cycle < plan.cycles; ++cycle) {
    if (cycle % 5 == 4) {
      line.reset();
      line = std::make_unique<Line>(line_of(plan, kSource));
    }
    const unsigned before = line->frames();
    line->set_state(GST_STATE_PLAYING);
    if (cycle % 2)
      line->wait_for(before + 2);
    else
      line->wait_for_end();
    const uint64_t device_bytes = line->device_bytes();
    line->set_state(GST_STATE_NULL);
    growth.sample_now(device_bytes);
    if ((cycle + 1) % 10 == 0) progress("start-stop", cycle + 1, plan.cycles, growth.last());
  }
  return growth;
}

/// A few frames of each size, with queues that hold layers before a slow sink.
Growth soak_sizes(const Plan& plan) {
  constexpr std::pair<int, int> kSizes[] = {{3840, 2160}, {4096, 2160}, {7680, 4320},
                                            {8192, 8192}, {32767, 1},   {1, 32767}};
  Slack slack = plan.slack;
  slack.resident_mib = 64;  // what the heap keeps of them differs by 50; a frame is 130 and more
  Growth growth("sizes", slack);
  for (unsigned round = 0; round < plan.sizes; ++round) {
    for (const auto& [width, height] : kSizes) {
      Line line("videotestsrc num-buffers=4 ! video/x-raw,format=RGBA,framerate=30/1,width=" +
                std::to_string(width) + ",height=" + std::to_string(height) + " ! " +
                plan.decomposer + " name=decomposer ! queue ! " +
                "intrinsicrecolor key=0xffff0000 ! queue ! intrinsiccompose ! " +
                "identity sleep-time=300000" + kEnd);
      line.set_state(GST_STATE_PLAYING);
      line.wait_for_end();
      const uint64_t device_bytes = line.device_bytes();
      line.set_state(GST_STATE_NULL);
      if (&width == &std::rbegin(kSizes)->first) growth.sample_now(device_bytes);
    }
    progress("sizes", round + 1, plan.sizes, growth.last());
  }
  return growth;
}

unsigned number(const char* text) {
  char* end = nullptr;
  const unsigned long value = strtoul(text, &end, 10);
  if (*end || value == 0) throw std::runtime_error(std::string(text) + " is no number above 0");
  return static_cast<unsigned>(value);
}

/// For the thesis' elements, which are many times slower.
Plan of_thesis(const char* decomposer) {
  Plan plan;
  plan.decomposer = decomposer;
  plan.frames = plan.scenes = 300;
  plan.caps_changes = plan.cycles = plan.sizes = 0;
  return plan;
}

/// Objects come and go with the scenes; their light and their clone with them.
Plan of_materials() {
  Plan plan;
  plan.decomposer = "limematerial";
  plan.chain = " name=decomposer show=input estimate-light=true";
  if (testing::has_element("materialclone")) plan.chain += " ! materialclone";
  plan.frames = 600;
  plan.caps_changes = 24;
  plan.cycles = 8;
  plan.scenes = 200;
  plan.sizes = 0;
  return plan;
}

/// Halves of an image as pairs; odd widths are unsupported, so that sizes stay, and the output
/// differs from the input.
Plan of_relighting(const char* model) {
  Plan plan;
  plan.decomposer = "olatrelight";
  plan.chain = std::string(" name=decomposer model=") + model;
  plan.frames = 600;
  plan.cycles = 8;
  plan.caps_changes = plan.scenes = plan.sizes = 0;
  return plan;
}

std::vector<Plan> parse(int count, char** words) {
  static const std::map<std::string, unsigned Plan::*> kCounts{
      {"--frames", &Plan::frames},
      {"--caps-changes", &Plan::caps_changes},
      {"--cycles", &Plan::cycles},
      {"--scenes", &Plan::scenes},
      {"--sizes", &Plan::sizes}};
  Plan plan;
  bool others = true;
  for (int i = 1; i < count; ++i) {
    const std::string word = words[i];
    const bool more = i + 1 < count;
    if (word == "--quick") {
      plan.frames = 300;
      plan.caps_changes = 24;
      plan.cycles = 8;
      plan.slack.resident_mib = 16;  // a few samples of what swings by 10 from one to the next
      plan.scenes = 120;
      plan.sizes = 0;
      others = false;
    } else if (word == "--decomposer" && more) {
      const std::string name = words[++i];
      if (name == "limematerial")
        plan = of_materials();
      else if (name == "olatrelight")
        plan = of_relighting("network");
      else
        plan.decomposer = name;
      others = false;
    } else if (word == "--device-slack" && more) {
      plan.slack.device_mib = number(words[++i]);
    } else if (const auto named = kCounts.find(word); named != kCounts.end() && more) {
      plan.*named->second = number(words[++i]);
    } else {
      throw std::runtime_error(
          "soak [--quick] [--decomposer FACTORY] [--frames N] [--caps-changes N] [--cycles N] "
          "[--scenes N] [--sizes N] [--device-slack MIB]");
    }
  }
  std::vector<Plan> plans{plan};
  if (others)
    for (const char* name : {"intrinsicdecompthesis", "globalintrinsicthesis"})
      plans.push_back(of_thesis(name));
  if (others) {
    plans.push_back(of_materials());
    if (testing::has_element("olatrelight"))
      for (const char* model : {"cosine-lobe", "network"}) plans.push_back(of_relighting(model));
  }
  return plans;
}

bool run(const Plan& plan) {
  const auto start = Clock::now();
  std::vector<Growth> phases;
  if (plan.frames > 0) phases.push_back(soak_frames(plan));
  if (plan.caps_changes > 0) phases.push_back(soak_caps(plan));
  if (plan.cycles > 0) phases.push_back(soak_cycles(plan));
  if (plan.scenes > 0) phases.push_back(soak_scenes(plan.decomposer, plan.scenes, plan.slack));
  if (plan.sizes > 0) phases.push_back(soak_sizes(plan));
  printf("%-12s %-20s %10s %10s %10s %8s\n", "phase", "holds", "warm", "end", "growth", "slack");
  bool good = true;
  for (const Growth& phase : phases) good = phase.judge() && good;
  printf(
      "%s: %u frames, %u caps changes, %u start-stop cycles, %u extreme frames of %s in %.0f s\n",
      good ? "no growth" : "GREW", plan.frames, plan.caps_changes, plan.cycles, plan.scenes,
      plan.decomposer.c_str(), std::chrono::duration<double>(Clock::now() - start).count());
  fflush(stdout);
  return good;
}

}  // namespace
}  // namespace inverse::soak

int main(int count, char** words) {
  gst_init(nullptr, nullptr);
  g_thread_pool_set_max_unused_threads(0);  // idle threads of its pools would count as growth
  try {
    bool good = true;
    for (const auto& plan : inverse::soak::parse(count, words))
      good = inverse::soak::run(plan) && good;
    return good ? 0 : 1;
  } catch (const std::exception& error) {
    fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
