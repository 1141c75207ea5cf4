// SPDX-License-Identifier: LGPL-2.1-or-later
// What rgbdsrc makes of small recordings.
#pragma once
#include <cmath>
#include <iomanip>
#include <sstream>

#include "recorded.hpp"

namespace inverse::testing {

struct Played {
  LineResult line;
  std::vector<RgbdBuffer> buffers;
  guint64 skipped = 0, unpaired = 0, posed = 0;
};

/// `settings` is what follows "rgbdsrc", its location first.
inline Played play(const std::string& settings, const std::string& more = "",
                   const std::function<void(size_t n)>& seen = {}) {
  Played played;
  played.line = run_line(
      "rgbdsrc name=source location=" + settings + " ! " + more + " appsink name=out sync=false",
      60, [&](GstElement* pipeline) {
        watch_buffers(find_element(pipeline, "out"), "sink", [&, pipeline](GstBuffer* buffer) {
          played.buffers.push_back(rgbd_buffer(buffer));
          GstElement* source = find_element(pipeline, "source");
          played.skipped = stat<guint64>(source, "skipped");
          played.unpaired = stat<guint64>(source, "unpaired");
          played.posed = stat<guint64>(source, "posed");
          if (seen) seen(played.buffers.size() - 1);
        });
      });
  return played;
}

/// Whether frames are those that write_color made with these values of red.
inline void expect_red(const Played& played, const std::vector<uint8_t>& red) {
  ASSERT_EQ(played.line.frames.size(), red.size()) << played.line.first_error();
  for (size_t n = 0; n < red.size(); ++n) {
    const auto& frame = played.line.frames[n];
    ASSERT_EQ(frame.size(), size_t{64 * 48 * 3});
    for (const auto& [x, y] : {std::pair{0U, 0U}, {63U, 0U}, {5U, 7U}, {63U, 47U}}) {
      const uint8_t* pixel = &frame[3 * (size_t{64} * y + x)];
      EXPECT_EQ(pixel[0], red[n]) << "frame " << n;
      EXPECT_EQ(pixel[1], x);
      EXPECT_EQ(pixel[2], y);
    }
  }
}

inline void expect_depth(const RgbdBuffer& buffer, uint16_t first) {
  ASSERT_TRUE(buffer.has_depth);
  EXPECT_EQ(buffer.meta.stride, 2 * buffer.meta.width);
  EXPECT_EQ(buffer.steps[0], 0);
  EXPECT_EQ(buffer.steps[1], 0) << "65535 is unknown, too";
  for (size_t i = 2; i < buffer.steps.size(); ++i) ASSERT_EQ(buffer.steps[i], first + i);
}

/// Frames of `count` numbers: red 10, 20 …, depth from 1000, 2000 … on.
inline void write_folders(const TemporaryFolder& folder, int count,
                          const std::string& color = "color/",
                          const std::string& depth = "depth/") {
  for (int n = 0; n < count; ++n) {
    const std::string number = std::to_string(n + 8);  // 8, 9, 10: not in the order of letters
    write_color(folder, color + number + ".png", static_cast<uint8_t>(10 * (n + 1)));
    write_depth(folder, depth + number + ".png", static_cast<uint16_t>(1000 * (n + 1)));
  }
}

/// Four pictures; the third one's depth image is 22 ms away.
inline void write_tum(const TemporaryFolder& folder) {
  folder.write("rgb.txt",
               "# color images\n# timestamp filename\n100.000 rgb/a.png\n100.030 rgb/b.png\n"
               "100.060 rgb/c.png\n100.105 rgb/d.png\n");
  folder.write(
      "depth.txt",
      "99.995 depth/a.png\n100.082 depth/c.png\n100.034 depth/b.png\n100.100 depth/d.png\n");
  std::string truth = "# timestamp tx ty tz qx qy qz qw\n";
  for (int n = 0; n < 8; ++n) {  // along x, and turning about y by a degree in 10 ms
    const double half = n * M_PI / 360;
    std::ostringstream line;
    line << std::setprecision(15) << 100.005 + 0.01 * n << " " << n << " 2 3 0 " << std::sin(half)
         << " 0 " << std::cos(half) << "\n";
    truth += line.str();
  }
  folder.write("groundtruth.txt", truth);
  for (uint8_t n = 0; n < 4; ++n) {
    const std::string name(1, static_cast<char>('a' + n));
    write_color(folder, "rgb/" + name + ".png", static_cast<uint8_t>(10 * (n + 1)));
    write_depth(folder, "depth/" + name + ".png", static_cast<uint16_t>(1000 * (n + 1)));
  }
}

}  // namespace inverse::testing
