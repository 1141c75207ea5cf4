// SPDX-License-Identifier: LGPL-2.1-or-later
// Benefit of motion compensation, of B to A and of single lights to the last tracking frame: a
// swaying head on the virtual stage, compared with the same frames of a static head. Through the
// elements. Option: --noise SHARE.
#include <gst/app/gstappsink.h>
#include <gst/video/video.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "gst/inverse/inverse_light_stage_meta.h"
#include "kernels/lightstage/program/light_program.hpp"
#include "tests/bench/support/command_line.hpp"
#include "tests/temporary_folder.hpp"

namespace {

using namespace inverse;

struct Frame {
  int kind, light;
  std::vector<float> light_of_pixels;  // linear RGB
};
using Frames = std::map<uint64_t, Frame>;  // by trigger

/// Labeled frames at the end of a pipeline.
Frames run(const std::string& line) {
  GError* error = nullptr;
  GstElement* pipeline =
      gst_parse_launch((line + " ! appsink name=out sync=false").c_str(), &error);
  if (error)
    throw std::runtime_error(std::string(error->message) + " (in ./dev shell it is found)");
  GstElement* out = gst_bin_get_by_name(GST_BIN(pipeline), "out");
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  std::vector<float> curve(65536);
  for (size_t i = 0; i < curve.size(); ++i)
    curve[i] = static_cast<float>(gst_video_transfer_function_decode(
        GST_VIDEO_TRANSFER_SRGB, static_cast<double>(i) / 65535));
  Frames frames;
  while (GstSample* sample = gst_app_sink_pull_sample(GST_APP_SINK(out))) {
    GstBuffer* buffer = gst_sample_get_buffer(sample);
    if (const GstLightStageMeta* meta = gst_buffer_get_light_stage_meta(buffer)) {
      Frame& frame = frames[meta->trigger];
      frame.kind = meta->kind;
      frame.light = meta->light;
      GstMapInfo map;
      gst_buffer_map(buffer, &map, GST_MAP_READ);
      const auto* codes = reinterpret_cast<const uint16_t*>(map.data);
      for (size_t i = 0; i < map.size / 2; ++i)
        if (i % 4 != 3) frame.light_of_pixels.push_back(curve[codes[i]]);
      gst_buffer_unmap(buffer, &map);
    }
    gst_sample_unref(sample);
  }
  GstBus* bus = gst_element_get_bus(pipeline);
  GstMessage* message = gst_bus_pop_filtered(bus, GST_MESSAGE_ERROR);
  gst_object_unref(bus);
  gst_element_set_state(pipeline, GST_STATE_NULL);
  gst_object_unref(out);
  gst_object_unref(pipeline);
  if (message) {
    gst_message_parse_error(message, &error, nullptr);
    throw std::runtime_error(error->message);
  }
  return frames;
}

/// Sum of differences over the sum of the expected values, in linear light.
class Error {
 public:
  void add(const float* seen, const float* truth, size_t count) {
    for (size_t i = 0; i < count; ++i) {
      off_ += std::abs(static_cast<double>(seen[i] - truth[i]));
      whole_ += static_cast<double>(truth[i]);
    }
  }
  double share() const { return off_ / whole_; }

 private:
  double off_ = 0, whole_ = 0;
};

struct Stage {
  static constexpr float motion = 12;  // of the top of the picture, either way
  static constexpr int lights = 96, width = 320, height = 240;
  float noise = 0.002F;

  std::string source(const std::string& program, double sway, double seconds, int frames) const {
    char text[512];
    std::snprintf(text, sizeof text,
                  "lightstagetestsrc is-live=false program=%s num-buffers=%d motion=%g "
                  "tuning=label=true:motion-period=%g noise=%g ! "
                  "video/x-raw,format=RGBA64_LE,width=%d,height=%d",
                  program.c_str(), frames, sway, seconds,
                  sway != 0 ? static_cast<double>(noise) : 0, width, height);
    return text;
  }
};

void captures(const Stage& stage) {
  const std::string program = "static:" + std::to_string(stage.lights);
  const LightProgram steps = light_program(program);
  uint64_t last = 0;
  for (uint64_t n = 0; n < *steps.triggers(); ++n)
    if (steps.kind(steps.at(n)) == StepKind::tracking) last = n;
  // The last tracking frame shows the head in its rest position.
  const double period = static_cast<double>(last) / 60;
  const auto frames = static_cast<int>(*steps.triggers());
  const std::string moving =
      stage.source(program, static_cast<double>(stage.motion), period, frames);
  const Frames truth = run(stage.source(program, 0, period, frames));
  const Frames seen = run(moving);
  const Frames moved = run(moving + " ! lightstagesync assemble=olat program=" + program);
  Error as_seen, compensated;
  for (const auto& [trigger, frame] : truth) {
    if (frame.kind != GST_LIGHT_STAGE_OLAT) continue;
    const auto &a = seen.at(trigger), &b = moved.at(trigger);
    as_seen.add(a.light_of_pixels.data(), frame.light_of_pixels.data(),
                frame.light_of_pixels.size());
    compensated.add(b.light_of_pixels.data(), frame.light_of_pixels.data(),
                    frame.light_of_pixels.size());
  }
  std::printf("| %d single lights to the last tracking frame | %.4f | %.4f | %.2f |\n",
              stage.lights, as_seen.share(), compensated.share(),
              as_seen.share() / compensated.share());
}

void pairs(const Stage& stage) {
  constexpr int kFrames = 123;
  const double period = 2;
  const testing::TemporaryFolder folder;
  LightProgram program =
      performance(stage_lights(geodesic_directions(static_cast<uint32_t>(stage.lights))));
  const std::string forth = folder / "ab.json", back = folder / "ba.json";
  program.save(forth);
  // The light of B at A's time: the ideal B.
  std::swap(program.steps[0], program.steps[1]);
  program.save(back);
  const std::string source =
      stage.source(forth, static_cast<double>(stage.motion), period, kFrames);
  Stage clean = stage;
  clean.noise = 0;
  const Frames truth = run(clean.source(back, static_cast<double>(stage.motion), period, kFrames));
  const std::string sync = " ! lightstagesync assemble=pairs program=" + forth;
  Error errors[2];
  for (const int aligned : {0, 1}) {
    const Frames paired = run(source + sync + (aligned ? " align=flow" : ""));
    for (const auto& [trigger, pair] : paired) {
      const auto& b = truth.at(trigger);
      const size_t row = size_t{3} * static_cast<size_t>(stage.width);
      for (size_t y = 0; y < static_cast<size_t>(stage.height); ++y)
        errors[aligned].add(&pair.light_of_pixels[(2 * y + 1) * row], &b.light_of_pixels[y * row],
                            row);
    }
  }
  std::printf("| B onto A, %d pairs | %.4f | %.4f | %.2f |\n", (kFrames - 3) / 2, errors[0].share(),
              errors[1].share(), errors[0].share() / errors[1].share());
}

}  // namespace

int main(int argc, char** argv) try {
  Stage stage;
  const bench::Options known{{"--noise", bench::number(stage.noise)}};
  if (!bench::read(known, argc, argv, "stage_motion_bench.cpp")) return 2;
  gst_init(nullptr, nullptr);
  std::printf(
      "%dx%d, the top of the picture sways %g pixels to either side; noise %g of white. "
      "l1 error over the sum of light\n\n| | as seen | moved | ratio |\n|---|---|---|---|\n",
      stage.width, stage.height, static_cast<double>(stage.motion),
      static_cast<double>(stage.noise));
  captures(stage);
  pairs(stage);
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "stage-motion-bench: %s\n", error.what());
  return 1;
}
