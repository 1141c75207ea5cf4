// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
// Drawing over frames of a clip (NV12, system memory) for benchmarks through the elements.
#include <gst/video/video.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>

namespace inverse::bench {

/// Calls work(frame) with the pixels of a writable buffer; does nothing if it cannot be mapped.
template <typename Work>
void on_pixels(GstBuffer* buffer, int width, int height, const Work& work) {
  GstVideoInfo info;
  gst_video_info_set_format(&info, GST_VIDEO_FORMAT_NV12, static_cast<guint>(width),
                            static_cast<guint>(height));
  GstVideoFrame frame;
  if (!gst_video_frame_map(&frame, &info, buffer, GST_MAP_READWRITE)) return;
  work(frame);
  gst_video_frame_unmap(&frame);
}

/// Draws a shaded ball with a diameter of a tenth of the frame's width at position `number` of a
/// path that bounces off the frame's borders.
inline void draw_ball(GstBuffer* buffer, int width, int height, int number) {
  const double radius = width / 20.0;
  const auto bounce = [](double way, double room) {
    way = std::fmod(way, 2 * room);
    return way < room ? way : 2 * room - way;
  };
  const double x0 = radius + bounce(0.2 * width + 0.2 * radius * number, width - 2 * radius);
  const double y0 = radius + bounce(0.25 * height + 0.13 * radius * number, height - 2 * radius);
  on_pixels(buffer, width, height, [&](GstVideoFrame& frame) {
    for (int plane = 0; plane < 2; ++plane) {
      const int half = plane + 1;
      auto* data = static_cast<uint8_t*>(GST_VIDEO_FRAME_PLANE_DATA(&frame, plane));
      for (int y = 0; y < height / half; ++y)
        for (int x = 0; x < width / half; ++x) {
          const double u = (x * half - x0) / radius, v = (y * half - y0) / radius;
          if (u * u + v * v >= 1) continue;
          uint8_t* sample = data + y * GST_VIDEO_FRAME_PLANE_STRIDE(&frame, plane) + x * half;
          const double light =
              0.35 + 0.65 * std::max(0.0, -0.5 * u - 0.6 * v + 0.62 * std::sqrt(1 - u * u - v * v));
          if (plane == 0)
            *sample = static_cast<uint8_t>(16 + 150 * light);
          else
            sample[0] = static_cast<uint8_t>(128 - 18 * light),
            sample[1] = static_cast<uint8_t>(128 + 30 * light);
        }
    }
  });
}

/// Adds a camera's noise to the luma: normal, standard deviation 1.5 codes.
inline void add_noise(GstBuffer* buffer, int width, int height, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, 1.5);
  on_pixels(buffer, width, height, [&](GstVideoFrame& frame) {
    auto* data = static_cast<uint8_t*>(GST_VIDEO_FRAME_PLANE_DATA(&frame, 0));
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        uint8_t& sample = data[y * GST_VIDEO_FRAME_PLANE_STRIDE(&frame, 0) + x];
        sample = static_cast<uint8_t>(std::clamp(std::lround(sample + normal(random)), 16L, 235L));
      }
  });
}

}  // namespace inverse::bench
