// SPDX-License-Identifier: LGPL-2.1-or-later
// Frames of a light stage without one: a ball and a patterned ground that may move, under the
// lights of a program, for the tests of lightstagesync.
#pragma once
#include <gst/check/gstharness.h>

#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "gst/inverse/inverse_light_stage_meta.h"
#include "kernels/lightstage/program/light_program.hpp"
#include "tests/elements/element_test.hpp"
#include "tests/srgb.hpp"
#include "tests/temporary_folder.hpp"

namespace inverse::testing {

/// Draws RGBA frames of a white, patterned ball in front of black.
class BallOnStage {
 public:
  BallOnStage(const LightProgram& program, int width, int height)
      : program_(program), width_(width), height_(height) {}

  /// Under the lights at a trigger (before 0: none), the ball `shift` pixels further right; noise
  /// makes every frame another.
  std::vector<uint8_t> draw(int64_t trigger, double shift = 0, unsigned seed = 0) const {
    const auto colors = trigger < 0 ? std::vector<LightColor>(program_.lights.size())
                                    : program_.colors(program_.at(static_cast<uint64_t>(trigger)));
    std::mt19937 random(seed * 7919u + static_cast<unsigned>(trigger + 100000));
    std::vector<uint8_t> frame;
    const double radius = 0.42 * std::min(width_, height_);
    for (int y = 0; y < height_; ++y)
      for (int x = 0; x < width_; ++x) {
        const double u = (x + 0.5 - width_ / 2.0 - shift) / radius;
        const double v = -(y + 0.5 - height_ / 2.0) / radius;
        const double z2 = 1 - u * u - v * v;
        std::array<double, 3> light{0.004, 0.004, 0.004};
        if (z2 > 0) {
          const double albedo = 0.55 + 0.25 * std::sin(9 * u) * std::sin(8 * v + 1) +
                                0.15 * std::sin(23 * u + 11 * v);
          const double z = std::sqrt(z2);
          for (size_t i = 0; i < colors.size(); ++i) {
            const auto& d = program_.lights[i].direction;
            const double cosine = std::max(0.0, u * d[0] + v * d[1] + z * d[2]);
            for (size_t c = 0; c < 3; ++c)
              light[c] += 3.2 * albedo * cosine * static_cast<double>(colors[i][c]) * gain_ /
                          static_cast<double>(colors.size());
          }
        }
        for (const double value : light) {
          const int noisy = static_cast<int>(std::lround(255 * std::min(srgb_code(value), 1.0))) +
                            static_cast<int>(random() % 3) - 1;
          frame.push_back(static_cast<uint8_t>(std::clamp(noisy, 0, 255)));
        }
        frame.push_back(255);
      }
    return frame;
  }
  void set_gain(double gain) { gain_ = gain; }

 private:
  const LightProgram& program_;
  int width_, height_;
  double gain_ = 1;
};

inline double l1(const std::vector<uint8_t>& a, const std::vector<uint8_t>& b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += std::abs(int{a[i]} - int{b[i]});
  return sum / static_cast<double>(a.size());
}

/// lightstagesync with cameras, whose frames are pushed by hand.
class StageSync : public ::testing::Test {
 protected:
  static constexpr int kWidth = 48, kHeight = 32;

  void SetUp() override {
    element_ = gst_element_factory_make("lightstagesync", nullptr);
    ASSERT_NE(element_, nullptr);
    gst_element_set_bus(element_, bus_);
  }
  void TearDown() override {
    gst_element_set_bus(element_, nullptr);
    for (auto& [number, harness] : cameras_) gst_harness_teardown(harness);
    gst_object_unref(element_);
    gst_object_unref(bus_);
  }

  /// Call after properties are set: a harness starts the element.
  GstHarness* camera(unsigned number = 0, const char* sink_caps = nullptr) {
    GstHarness*& harness = cameras_[number];
    if (harness) return harness;
    harness = gst_harness_new_with_element(element_, ("sink_" + std::to_string(number)).c_str(),
                                           ("src_" + std::to_string(number)).c_str());
    if (sink_caps) gst_harness_set_sink_caps_str(harness, sink_caps);
    return harness;
  }
  static std::string caps(int width = kWidth, int height = kHeight, const char* rate = "60/1") {
    return "video/x-raw, format=RGBA, width=" + std::to_string(width) +
           ", height=" + std::to_string(height) + ", framerate=" + rate;
  }
  void start(unsigned number = 0, const std::string& which = caps()) {
    gst_harness_set_src_caps_str(camera(number), which.c_str());
  }
  static GstBuffer* buffer_of(const std::vector<uint8_t>& bytes, double trigger) {
    GstBuffer* buffer = gst_buffer_new_memdup(bytes.data(), bytes.size());
    GST_BUFFER_PTS(buffer) = static_cast<GstClockTime>((trigger + 100) * GST_SECOND / 60);
    GST_BUFFER_DURATION(buffer) = GST_SECOND / 60;
    return buffer;
  }
  /// A frame with the time of a trigger.
  GstFlowReturn push(const std::vector<uint8_t>& frame, double time, unsigned number = 0) {
    return gst_harness_push(camera(number), buffer_of(frame, time));
  }
  GstFlowReturn push(int64_t trigger, unsigned number = 0, double shift = 0) {
    const BallOnStage ball(program_, kWidth, kHeight);
    return push(ball.draw(trigger, shift, number), static_cast<double>(trigger), number);
  }
  /// Frames of these triggers from each of some cameras; every one is taken.
  void push_all(int64_t from, int64_t to, unsigned cameras = 1) {
    for (int64_t n = from; n < to; ++n)
      for (unsigned number = 0; number < cameras; ++number) ASSERT_EQ(push(n, number), GST_FLOW_OK);
  }
  /// The same with frames of another size or place.
  void push_all(const BallOnStage& ball, int64_t from, int64_t to) {
    for (int64_t n = from; n < to; ++n)
      ASSERT_EQ(push(ball.draw(n), static_cast<double>(n)), GST_FLOW_OK);
  }
  bool push_end() { return gst_harness_push_event(camera(), gst_event_new_eos()); }
  struct Out {
    int64_t trigger = -1;
    int kind = -1, light = -1, step = -2;
    GstClockTime pts = 0, duration = 0;
    std::vector<uint8_t> bytes;
    guint lights = 0;
    std::vector<float> colors;
  };
  /// The next frames that come out. Those that do not within a minute fail the test.
  std::vector<Out> pull(size_t count, unsigned number = 0) {
    std::vector<Out> all;
    while (all.size() < count) {
      const Buffer buffer(gst_harness_pull(camera(number)));  // a minute at most
      if (!buffer) break;
      Out out;
      out.pts = GST_BUFFER_PTS(buffer.get());
      out.duration = GST_BUFFER_DURATION(buffer.get());
      out.bytes = bytes_of(buffer.get());
      if (GstLightStageMeta* meta = gst_buffer_get_light_stage_meta(buffer.get())) {
        out.trigger = static_cast<int64_t>(meta->trigger);
        out.kind = meta->kind;
        out.light = meta->light;
        out.step = meta->step;
        out.lights = meta->lights;
        out.colors = floats_of(meta->colors);
      }
      all.push_back(out);
    }
    EXPECT_EQ(all.size(), count);
    all.resize(count);
    return all;
  }
  std::vector<std::string> errors() { return texts_of(bus_, GST_MESSAGE_ERROR); }
  std::vector<std::string> warnings() { return texts_of(bus_, GST_MESSAGE_WARNING); }
  /// Waits for a warning that has this in it.
  bool warned_of(const std::string& what, unsigned seconds = 30) {
    const gint64 until = g_get_monotonic_time() + gint64{seconds} * G_USEC_PER_SEC;
    while (g_get_monotonic_time() < until) {
      for (const std::string& text : warnings())
        if (text.find(what) != std::string::npos) return true;
      g_usleep(10000);
    }
    return false;
  }
  /// Waits for the end of the stream to come out.
  bool ends() {
    for (int i = 0; i < 500; ++i) {
      while (GstEvent* event = gst_harness_try_pull_event(camera())) {
        const bool end = GST_EVENT_TYPE(event) == GST_EVENT_EOS;
        gst_event_unref(event);
        if (end) return true;
      }
      g_usleep(10000);
    }
    return false;
  }
  guint64 count(const char* name) { return stat<guint64>(element_, name); }
  /// "performance" with fewer lights: faster to draw.
  void use(LightProgram program) {
    program_ = std::move(program);
    path_ = folder_ / "program.json";
    program_.save(path_);
    g_object_set(element_, "program", path_.c_str(), nullptr);
  }
  void use_performance() { use(performance(stage_lights(geodesic_directions(42)))); }
  /// The same, and the first cameras start.
  void start_performance(unsigned cameras = 1) {
    use_performance();
    for (unsigned number = 0; number < cameras; ++number) start(number);
  }

  GstBus* bus_ = gst_bus_new();
  GstElement* element_ = nullptr;
  std::map<unsigned, GstHarness*> cameras_;
  LightProgram program_;
  TemporaryFolder folder_;
  std::string path_;  // of the program's file in it
};

}  // namespace inverse::testing
