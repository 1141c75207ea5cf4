// SPDX-License-Identifier: LGPL-2.1-or-later
#include "scenes.hpp"

#include <gst/app/gstappsink.h>
#include <gst/app/gstappsrc.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <vector>

#include "line.hpp"

namespace inverse::soak {
namespace {

constexpr unsigned kWidth = 90, kHeight = 70;
using Frame = std::vector<uint8_t>;  // RGBA

/// Kinds of scenes with difficult transitions.
enum class Scene {
  black,
  white,
  one_color,
  noise,
  faint_noise,
  checkerboard,
  hot_pixel,
  half_black,
  flashing,
  picture,
  dimmed_picture,
  moving_picture,
  kinds
};

/// A mosaic of a few paints under a light with a border, `shift` pixels along.
uint8_t painted(unsigned x, unsigned y, unsigned channel, unsigned seed, unsigned shift) {
  const unsigned patch = (x + shift) / 15 * 7 + y / 11 * 3 + seed;
  const unsigned paint = (patch * 2654435761U >> (8 * channel + 3)) % 200 + 40;
  return static_cast<uint8_t>(x + 2 * y > kWidth ? paint : paint / 3);
}

Frame frame_of(Scene scene, unsigned number, unsigned seed, std::mt19937& random) {
  const auto value = [&](unsigned x, unsigned y, unsigned c) -> unsigned {
    switch (scene) {
      case Scene::white:
        return 255;
      case Scene::one_color:
        return seed >> (8 * c);
      case Scene::noise:
        return static_cast<unsigned>(random());
      case Scene::faint_noise:
        return static_cast<unsigned>(random() % 2);
      case Scene::checkerboard:
        return (x + y + number) % 2 ? 255 : 0;
      case Scene::half_black:
        return 2 * x < kWidth ? 0 : 255;
      case Scene::flashing:
        return number % 2 ? 255 : 0;
      case Scene::picture:
        return painted(x, y, c, seed, 0);
      case Scene::dimmed_picture:
        return painted(x, y, c, seed, 0) >> (number % 8);
      case Scene::moving_picture:
        return painted(x, y, c, seed, 3 * number);
      case Scene::black:
      case Scene::hot_pixel:
      case Scene::kinds:
        return 0;
    }
    return 0;
  };
  Frame frame(4 * kWidth * kHeight, 255);
  for (unsigned y = 0; y < kHeight; ++y)
    for (unsigned x = 0; x < kWidth; ++x)
      for (unsigned c = 0; c < 3; ++c)
        frame[4 * (y * kWidth + x) + c] = static_cast<uint8_t>(value(x, y, c));
  if (scene == Scene::hot_pixel) std::fill_n(&frame[4 * (seed % (kWidth * kHeight))], 3, 255);
  return frame;
}

void push(GstElement* source, const Frame& frame, unsigned number) {
  GstBuffer* buffer = gst_buffer_new_memdup(frame.data(), frame.size());
  GST_BUFFER_PTS(buffer) = gst_util_uint64_scale(number, GST_SECOND, 30);
  GST_BUFFER_DURATION(buffer) = GST_SECOND / 30;
  if (gst_app_src_push_buffer(GST_APP_SRC(source), buffer) != GST_FLOW_OK)
    throw std::runtime_error("a frame was refused");
}

/// The largest difference of the next frame that comes out from `expected`.
int next_difference(GstElement* sink, const Frame& expected) {
  GstSample* sample = gst_app_sink_try_pull_sample(GST_APP_SINK(sink), 60 * GST_SECOND);
  if (!sample) throw std::runtime_error("no frame for a minute");
  const Frame frame = testing::bytes_of(gst_sample_get_buffer(sample));
  gst_sample_unref(sample);
  int largest = frame.size() == expected.size() ? 0 : 256;
  for (size_t i = 0; largest < 256 && i < frame.size(); ++i)
    largest = std::max(largest, std::abs(int{frame[i]} - int{expected[i]}));
  return largest;
}

}  // namespace

Growth soak_scenes(const std::string& decomposer, unsigned frames, const Slack& slack) {
  Growth growth("scenes", slack);
  Line line(
      "appsrc name=source format=time block=true max-buffers=2 "
      "caps=video/x-raw,format=RGBA,width=" +
      std::to_string(kWidth) + ",height=" + std::to_string(kHeight) + ",framerate=30/1 ! " +
      decomposer +
      " name=decomposer ! intrinsiccompose ! video/x-raw,format=RGBA ! "
      "appsink name=sink sync=false");
  GstElement *source = line.find("source"), *sink = line.find("sink");
  line.set_state(GST_STATE_PLAYING);
  std::mt19937 random(3);
  Scene scene = Scene::picture;
  unsigned seed = 0, left = 0;
  const unsigned every = std::max(frames / 60, 1U);
  for (unsigned number = 0; number < frames; ++number) {
    if (left == 0) {
      scene = static_cast<Scene>(random() % static_cast<unsigned>(Scene::kinds));
      seed = static_cast<unsigned>(random());
      left = 1 + static_cast<unsigned>(random()) % 12;
    }
    --left;
    const Frame frame = frame_of(scene, number, seed, random);
    push(source, frame, number);
    line.check();
    const int difference = next_difference(sink, frame);
    if (difference > 1)
      throw std::runtime_error("frame " + std::to_string(number) + ", scene " +
                               std::to_string(static_cast<int>(scene)) +
                               ", comes back changed by " + std::to_string(difference));
    if (number % every == every - 1) growth.sample_now(line.device_bytes());
  }
  fprintf(stderr, "%-12s %6u frames came back as they were\n", "scenes", frames);
  return growth;
}

}  // namespace inverse::soak
