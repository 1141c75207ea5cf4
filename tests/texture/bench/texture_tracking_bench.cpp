// SPDX-License-Identifier: LGPL-2.1-or-later
// How well intrinsictexture follows a plane: a poster on a wall before a camera that is moved by
// hand, with an arm in front of it for a while, and out of the picture for another (tests/texture);
// corners against the truth, and what was painted against what should have been.
//
// usage: texture-tracking-bench [--poster FILE] [--picture FILE] [--size 640x480] [--element NAME]
// [--noise CODES]
//                               [--by-poster] [--png FOLDER]
// --poster is what hangs there (default: blobs), --picture what is hung over it (default: a plain
// color, which shares of painted pixels need). --by-poster finds it by its picture instead of
// corners in the first frame. --png writes every 15th frame. Only frames in which half of the
// poster or more is in the picture count.
#include <gst/check/gstharness.h>
#include <gst/video/video.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <string>
#include <vector>

#include "gst/base/pictures/picture_file.hpp"
#include "gst/texture/corners_text.hpp"
#include "tests/bench/support/command_line.hpp"
#include "tests/bench/support/timing.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/texture/wall_scene.hpp"

namespace {

using inverse::Corners;
using inverse::testing::WallScene;

/// Where a frame says that the plane is; none if it does not.
std::optional<Corners> place_of(GstBuffer* frame) {
  gpointer state = nullptr;
  while (GstMeta* meta = gst_buffer_iterate_meta_filtered(
             frame, &state, GST_VIDEO_REGION_OF_INTEREST_META_API_TYPE)) {
    const GstStructure* plane = gst_video_region_of_interest_meta_get_param(
        reinterpret_cast<GstVideoRegionOfInterestMeta*>(meta), "plane");
    if (plane) return inverse::read_corners(gst_structure_get_string(plane, "corners"));
  }
  return {};
}

double tracking_ms(GstElement* element) {
  GstStructure* stats = nullptr;
  g_object_get(element, "stats", &stats, nullptr);
  double ms = 0;
  gst_structure_get_double(stats, "tracking-ms", &ms);
  gst_structure_free(stats);
  return ms;
}

/// The share of a quadrilateral that is in the picture, and its pixels.
double share_in(const Corners& corners, const cv::Size& size, cv::Mat* inside) {
  std::vector<cv::Point2f> quad, common;
  for (const auto& p : corners)
    quad.emplace_back(static_cast<float>(p[0]), static_cast<float>(p[1]));
  const auto w = static_cast<float>(size.width), h = static_cast<float>(size.height);
  const std::vector<cv::Point2f> frame{{0, 0}, {w, 0}, {w, h}, {0, h}};
  const double area = std::abs(inverse::area_of(corners));
  const double share = cv::intersectConvexConvex(quad, frame, common) / area;
  if (inside) {
    *inside = cv::Mat(size, CV_8U, cv::Scalar(0));
    std::vector<cv::Point> whole(quad.begin(), quad.end());
    cv::fillConvexPoly(*inside, whole, 255);
    cv::erode(*inside, *inside, cv::Mat(), {-1, -1}, 2);
  }
  return share;
}

struct Errors {
  int frames = 0, missing = 0;
  double largest = 0, squares = 0;
  void add(const std::optional<Corners>& found, const Corners& truth) {
    ++frames;
    if (!found) {
      ++missing;
      return;
    }
    const double error = inverse::testing::corner_error(*found, truth);
    largest = std::max(largest, error);
    squares += error * error;
  }
  void print(const char* name) const {
    const int seen = std::max(frames - missing, 1);
    std::printf("| %s | %d | %d | %.2f | %.2f |\n", name, frames, missing, largest,
                std::sqrt(squares / seen));
  }
};

cv::Mat poster_of(const std::string& path) {
  if (path.empty()) return {};
  const inverse::Picture8 file = inverse::load_picture(path);
  const cv::Mat rgba(static_cast<int>(file.extent.height), static_cast<int>(file.extent.width),
                     CV_8UC4, const_cast<uint8_t*>(file.rgba.data()));
  cv::Mat rgb;
  cv::cvtColor(rgba, rgb, cv::COLOR_RGBA2RGB);
  return rgb;
}

}  // namespace

int main(int count, char** arguments) try {
  gst_init(&count, &arguments);
  std::string poster, picture, element = "intrinsicdecomp", png;
  cv::Size size(640, 480);
  double noise = 2;
  bool by_poster = false;
  namespace bench = inverse::bench;
  const auto read_size = [&size](const char* text) {
    return std::sscanf(text, "%dx%d", &size.width, &size.height) == 2;
  };
  if (!bench::read({{"--poster", bench::text(poster)},
                    {"--picture", bench::text(picture)},
                    {"--size", {true, read_size}},
                    {"--element", bench::text(element)},
                    {"--noise", bench::number(noise)},
                    {"--by-poster", bench::flag([&] { by_poster = true; })},
                    {"--png", bench::text(png)}},
                   count, arguments, "texture_tracking_bench.cpp"))
    return 2;
  const WallScene scene(size, poster_of(poster), noise);
  const inverse::testing::TemporaryFolder folder;
  if (picture.empty())
    picture =
        inverse::testing::write_picture(folder / "plain.png", {1, 1, CV_8UC3, {208, 32, 208}});
  std::string plane;
  if (by_poster) {
    plane = "poster=" + inverse::testing::write_picture(folder / "poster.png", scene.poster());
  } else {
    plane = "corners=\"" + inverse::text_of(scene.at(0).corners) + "\"";
  }
  const std::string caps = "video/x-raw, format=RGB, width=" + std::to_string(size.width) +
                           ", height=" + std::to_string(size.height) + ", framerate=30/1";
  GstHarness* harness =
      gst_harness_new_parse((element + " ! intrinsictexture name=t location=" + picture + " " +
                             plane + " ! intrinsiccompose")
                                .c_str());
  gst_harness_set_caps_str(harness, caps.c_str(), caps.c_str());
  GstElement* texture = gst_bin_get_by_name(GST_BIN(harness->element), "t");
  GstVideoInfo info;
  GstCaps* fixed = gst_caps_from_string(caps.c_str());
  gst_video_info_from_caps(&info, fixed);
  gst_caps_unref(fixed);
  std::vector<std::optional<Corners>> found;
  std::vector<double> tracking;
  double painted_over = 0, covered = 0, holes = 0, open = 0;
  for (int n = 0; n < WallScene::kFrames; ++n) {
    const WallScene::Frame frame = scene.at(n);
    GstBuffer* buffer = gst_buffer_new_allocate(nullptr, info.size, nullptr);
    GstMapInfo map;
    gst_buffer_map(buffer, &map, GST_MAP_WRITE);
    for (int y = 0; y < size.height; ++y)
      std::memcpy(map.data + y * info.stride[0], frame.picture.ptr(y),
                  static_cast<size_t>(size.width) * 3);
    gst_buffer_unmap(buffer, &map);
    GST_BUFFER_PTS(buffer) = static_cast<GstClockTime>(n) * GST_SECOND / 30;
    if (gst_harness_push(harness, buffer) != GST_FLOW_OK)
      throw std::runtime_error("a frame was refused");
    GstBuffer* out = gst_harness_pull(harness);
    found.push_back(place_of(out));
    tracking.push_back(tracking_ms(texture));
    gst_buffer_map(out, &map, GST_MAP_READ);
    const cv::Mat drawn(size, CV_8UC3, map.data, static_cast<size_t>(info.stride[0]));
    cv::Mat inside;
    if (share_in(frame.corners, size, &inside) > 0.5)
      for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x) {
          if (!inside.at<uchar>(y, x)) continue;
          const auto &a = drawn.at<cv::Vec3b>(y, x), &b = frame.picture.at<cv::Vec3b>(y, x);
          const bool painted =
              std::max({std::abs(a[0] - b[0]), std::abs(a[1] - b[1]), std::abs(a[2] - b[2])}) > 12;
          const float before = frame.occluder.at<float>(y, x);
          if (before > 0.99F) ++covered, painted_over += painted;
          if (before == 0) ++open, holes += !painted;
        }
    if (!png.empty() && n % 15 == 0) {
      std::filesystem::create_directories(png);
      char name[32];
      std::snprintf(name, sizeof name, "/%03d.png", n);
      cv::Mat strip;
      cv::hconcat(frame.picture, drawn, strip);
      inverse::testing::write_picture(png + name, strip);
    }
    gst_buffer_unmap(out, &map);
    gst_buffer_unref(out);
  }
  gst_object_unref(texture);
  gst_harness_teardown(harness);

  Errors all, arm, later;
  int away = 0, back = -1, again = -1;
  for (int n = 0; n < WallScene::kFrames; ++n) {
    const Corners truth = scene.corners_at(n);
    const auto& one = found[static_cast<size_t>(n)];
    if (share_in(truth, size, nullptr) < 0.5) {
      away += n > WallScene::kOccludedTo;
      continue;
    }
    if (away > 0 && back < 0) back = n;
    if (away > 0 && one && again < 0) again = n;
    all.add(one, truth);
    if (n >= WallScene::kOccludedFrom && n < WallScene::kOccludedTo) arm.add(one, truth);
    if (again >= 0) later.add(one, truth);
  }
  std::printf(
      "| frames | counted | not found | max error, px | rms error, px |\n|---|---|---|---|---|\n");
  all.print("all");
  arm.print("with an arm before the poster");
  later.print("after it left the picture and came back");
  std::sort(tracking.begin(), tracking.end());
  std::printf("\nframes until it was found again: %d\n", again - back);
  std::printf("arm painted over: %.1f %%; holes in the picture: %.1f %%\n",
              100 * painted_over / std::max(covered, 1.0), 100 * holes / std::max(open, 1.0));
  std::printf("tracking on the host, ms a frame: median %.1f, longest %.1f\n",
              bench::median(tracking), tracking.back());
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "texture-tracking-bench: %s\n", error.what());
  return 1;
}
