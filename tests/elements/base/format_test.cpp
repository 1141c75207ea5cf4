// SPDX-License-Identifier: LGPL-2.1-or-later
// Every format of raw video through an element, against GStreamer's own converter.
#include <algorithm>
#include <cmath>

#include "tests/elements/element_test.hpp"

namespace inverse::testing {
namespace {

/// The formats of a pad template in system memory.
std::vector<std::string> formats_of(const char* factory, const char* pad) {
  GstElementFactory* found = gst_element_factory_find(factory);
  std::vector<std::string> names;
  for (const GList* item = gst_element_factory_get_static_pad_templates(found); item;
       item = item->next) {
    auto* pad_template = static_cast<GstStaticPadTemplate*>(item->data);
    if (std::string(pad_template->name_template) != pad) continue;
    GstCaps* caps = gst_static_pad_template_get_caps(pad_template);
    for (guint i = 0; i < gst_caps_get_size(caps); ++i) {
      const GValue* list = gst_structure_get_value(gst_caps_get_structure(caps, i), "format");
      if (gst_caps_features_is_equal(gst_caps_get_features(caps, i),
                                     GST_CAPS_FEATURES_MEMORY_SYSTEM_MEMORY))
        for (guint k = 0; GST_VALUE_HOLDS_LIST(list) && k < gst_value_list_get_size(list); ++k)
          names.emplace_back(g_value_get_string(gst_value_list_get_value(list, k)));
    }
    gst_caps_unref(caps);
  }
  gst_object_unref(found);
  return names;
}

/// A frame converted by GStreamer, without dithering, and without changing curve or primaries.
std::vector<uint8_t> converted(const std::string& from, const std::string& to,
                               const std::vector<uint8_t>& frame) {
  GstVideoInfo in = info_of(from), out = info_of(to);
  GstVideoConverter* converter = gst_video_converter_new(
      &in, &out,
      gst_structure_new("options", GST_VIDEO_CONVERTER_OPT_DITHER_METHOD,
                        GST_TYPE_VIDEO_DITHER_METHOD, GST_VIDEO_DITHER_NONE,
                        GST_VIDEO_CONVERTER_OPT_CHROMA_MODE, GST_TYPE_VIDEO_CHROMA_MODE,
                        GST_VIDEO_CHROMA_MODE_FULL, nullptr));
  const Buffer source(gst_buffer_new_memdup(frame.data(), frame.size())),
      target(gst_buffer_new_allocate(nullptr, out.size, nullptr));
  GstVideoFrame a, b;
  gst_video_frame_map(&a, &in, source.get(), GST_MAP_READ);
  gst_video_frame_map(&b, &out, target.get(), GST_MAP_WRITE);
  gst_video_converter_frame(converter, &a, &b);
  gst_video_frame_unmap(&a);
  gst_video_frame_unmap(&b);
  gst_video_converter_free(converter);
  return bytes_of(target.get());
}

/// Values of 0…1, of the pixels of an RGBA64_LE frame at least `border` from its edges.
std::vector<double> inner(const std::vector<uint8_t>& frame, int width, int height, int border) {
  std::vector<double> values;
  for (int y = border; y < height - border; ++y)
    for (int i = 4 * border; i < 4 * (width - border); ++i) {
      const size_t at =
          2 * (static_cast<size_t>(y) * static_cast<size_t>(width) * 4 + static_cast<size_t>(i));
      values.push_back((frame[at] | frame[at + 1] << 8) / 65535.0);
    }
  return values;
}

constexpr int kWidth = 48, kHeight = 32;

/// A smooth picture in RGBA64_LE: where colors turn abruptly, ways to interpolate chroma differ.
std::vector<uint8_t> smooth_picture() {
  std::vector<uint8_t> frame;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const int sample[] = {6000 + 1100 * x, 6000 + 1600 * y, 55000 - 500 * x - 700 * y,
                            20000 + 900 * x};
      for (const int value : sample) {
        frame.push_back(static_cast<uint8_t>(value & 255));
        frame.push_back(static_cast<uint8_t>(value >> 8));
      }
    }
  return frame;
}

}  // namespace

/// What cameras, capture cards and files send, and a format of each other kind of layout.
constexpr const char* kSent[] = {
    "RGBA",      "BGR",       "NV12",      "YUY2",       "P010_10LE",   "NV21",        "YV12",
    "Y42B",      "Y444",      "NV16",      "VUYA",       "AYUV",        "xRGB",        "ARGB",
    "xBGR",      "ABGR",      "RGBA64_BE", "GRAY16_BE",  "I422_10LE",   "Y444_10LE",   "Y210",
    "v210",      "Y410",      "P012_LE",   "BGR10A2_LE", "RGB10A2_LE",  "r210",        "Y412_LE",
    "I420_12LE", "I422_12LE", "GBR_12LE",  "Y444_16LE",  "GRAY10_LE32", "NV12_10LE32", "P016_LE",
    "RGB16",     "Y41B",      "VYUY",      "v216",       "A420_10LE",   "GBRA",        "AV12"};

TEST(Format, AllThatIsSentIsTaken) {
  const auto formats = formats_of("intrinsicdecomp", "sink");
  for (const char* name : kSent)
    EXPECT_NE(std::find(formats.begin(), formats.end(), name), formats.end()) << name;
  EXPECT_EQ(formats_of("intrinsicdecomp", "src"), formats);
}

// An element converts on the way in and on the way out; the label of the picture stays the same.
TEST(Format, EachIsReadAndWrittenAsGStreamerDoes) {
  const std::string color = "colorimetry=(string)bt709, chroma-site=(string)mpeg2";
  const std::string rgb_color = "colorimetry=(string)1:1:5:1";
  const std::string rgb = VideoHarness::caps("RGBA64_LE", kWidth, kHeight, rgb_color);
  const auto picture = smooth_picture();
  for (const std::string name : kSent) {
    const GstVideoFormatInfo* format =
        gst_video_format_get_info(gst_video_format_from_string(name.c_str()));
    const bool yuv = GST_VIDEO_FORMAT_INFO_IS_YUV(format),
               gray = GST_VIDEO_FORMAT_INFO_IS_GRAY(format);
    const std::string caps = VideoHarness::caps(name, kWidth, kHeight,
                                                yuv    ? color
                                                : gray ? "colorimetry=(string)1:3:5:1"
                                                       : rgb_color);
    const auto coded = converted(rgb, caps, picture);
    // Both round to the codes of the format; GStreamer also in between, to 8 or 16 bits, and the
    // matrices of Y'CbCr and gray, to 8 bits.
    const double code =
        1.0 / (std::ldexp(1.0, static_cast<int>(GST_VIDEO_FORMAT_INFO_DEPTH(format, 0))) - 1);
    const bool eight = gst_video_format_get_info(format->unpack_format)->bits == 8;
    const double allowed = eight         ? std::max(3 * code, 4.0 / 255)
                           : yuv || gray ? 2.0 / 255
                                         : 3 * code + 8.0 / 65535;

    VideoHarness reads("intrinsicdecomp show=input", caps, rgb);
    const auto seen = reads.process(coded);
    ASSERT_FALSE(seen.empty()) << name;
    const auto got = inner(seen, kWidth, kHeight, 4),
               expected = inner(converted(caps, rgb, coded), kWidth, kHeight, 4);
    double worst = 0;
    for (size_t i = 0; i < got.size(); ++i) {
      // GStreamer's formats without an alpha flag have none, although a few have its bits.
      if (i % 4 == 3 && !GST_VIDEO_FORMAT_INFO_HAS_ALPHA(format)) continue;
      const bool alpha_of_two_bits = i % 4 == 3 && GST_VIDEO_FORMAT_INFO_DEPTH(format, 3) == 2;
      worst = std::max(worst, alpha_of_two_bits && std::abs(got[i] - expected[i]) <= 0.34
                                  ? 0
                                  : std::abs(got[i] - expected[i]));
    }
    EXPECT_LE(worst, allowed) << "reading " << name;

    VideoHarness writes("intrinsicdecomp show=input", rgb, caps);
    const auto written = writes.process(picture);
    ASSERT_EQ(written.size(), coded.size()) << name;
    const auto ours = inner(converted(caps, rgb, written), kWidth, kHeight, 4),
               theirs = inner(converted(caps, rgb, coded), kWidth, kHeight, 4);
    worst = 0;
    for (size_t i = 0; i < ours.size(); ++i)
      if (i % 4 < 3) worst = std::max(worst, std::abs(ours[i] - theirs[i]));
    EXPECT_LE(worst, allowed + code) << "writing " << name;
    EXPECT_TRUE(reads.errors().empty() && writes.errors().empty()) << name;
  }
}

TEST(Format, OddSizesGoThroughUnharmed) {
  constexpr std::pair<int, int> kSizes[] = {{1, 1}, {3, 5}, {19, 7}};
  size_t n = 0;
  for (const std::string name : kSent) {
    if (name == "NV12_10LE32") continue;  // the test below
    const auto [width, height] = kSizes[n++ % std::size(kSizes)];
    const std::string caps = VideoHarness::caps(name, width, height);
    VideoHarness harness("intrinsicdecomp show=input", caps, caps);
    const auto in = random_frame(caps, 5);
    EXPECT_EQ(harness.process(in, 2).size(), in.size()) << name << " " << width << "x" << height;
    EXPECT_TRUE(harness.errors().empty()) << name;
  }
}

// GStreamer's rows of these two lack the last chroma sample at odd multiples of three.
TEST(Format, SizesWithoutRoomForChromaAreRefused) {
  for (const char* name : {"NV12_10LE32", "NV16_10LE32"}) {
    const std::string caps = VideoHarness::caps(name, 3, 5);
    VideoHarness harness("intrinsicdecomp show=input", caps, caps);
    EXPECT_NE(harness.push(random_frame(caps, 1)), GST_FLOW_OK) << name;
    expect_one(harness.errors(), "even width");
    const std::string even = VideoHarness::caps(name, 4, 5);
    VideoHarness good("intrinsicdecomp show=input", even, even);
    EXPECT_FALSE(good.process(random_frame(even, 1)).empty()) << name;
  }
}

// pngenc takes 16 bits of gray, big-endian.
TEST(Format, GrayOfSixteenBitsBecomesSuchAPng) {
  const std::string deep = VideoHarness::caps("GRAY16_LE", 64, 48);
  const char* line = "intrinsicdecomp show=reflectance ! pngenc";
  VideoHarness harness(line, deep);
  ASSERT_EQ(harness.push(random_frame(deep, 1)), GST_FLOW_OK);
  const auto png = harness.pull();
  ASSERT_GT(png.size(), 26u);
  EXPECT_EQ(png[24], 16) << "bits";
  EXPECT_EQ(png[25], 0) << "gray";
}

// What follows takes none of ten bits and color in this format: the next best, not the first.
TEST(Format, OfMoreThanEightBitsStaysDeep) {
  const struct {
    const char *in, *offered, *expected;
  } cases[] = {
      {"v210", "{ RGBA, NV12, I422_10LE, RGBA64_LE }", "I422_10LE"},
      {"I420_12LE", "{ NV12, GRAY16_LE, P010_10LE, RGBA64_LE }", "RGBA64_LE"},
      {"P012_LE", "{ GRAY16_LE, RGBA }", "RGBA"},
      {"GRAY16_BE", "{ RGBA, GRAY8, GRAY16_LE }", "GRAY16_LE"},
      {"YV12", "{ RGBA, I420 }", "RGBA"},
  };
  for (const auto& each : cases) {
    VideoHarness harness("intrinsicdecomp show=input", VideoHarness::caps(each.in, 32, 32),
                         std::string("video/x-raw, format=") + each.offered);
    ASSERT_FALSE(harness.process(random_frame(VideoHarness::caps(each.in, 32, 32), 1)).empty());
    EXPECT_NE(caps_out_of(harness.harness()).find(std::string("format=(string)") + each.expected),
              std::string::npos)
        << each.in << " to " << each.offered << ": " << caps_out_of(harness.harness());
  }
}

TEST(Format, OneThatIsNotSupportedIsAnErrorThatNamesTheNearest) {
  for (const auto& [name, nearest] : {std::pair{"UYVP", "v210"}, {"YUV9", "I420"}}) {
    const auto send = [caps = VideoHarness::caps(name, 64, 48)](GstElement* pipeline) {
      GstElement* source = gst_bin_get_by_name(GST_BIN(pipeline), "in");
      gst_util_set_object_arg(G_OBJECT(source), "caps", caps.c_str());
      const auto frame = random_frame(caps, 1);
      GstFlowReturn flow{};
      for (int i = 0; i < 2; ++i) {
        GstBuffer* buffer = gst_buffer_new_memdup(frame.data(), frame.size());
        g_signal_emit_by_name(source, "push-buffer", buffer, &flow);
        gst_buffer_unref(buffer);
      }
      g_signal_emit_by_name(source, "end-of-stream", &flow);
      gst_object_unref(source);
    };
    const LineResult result =
        run_line("appsrc name=in format=time ! intrinsicdecomp ! fakesink", 60, send);
    std::vector<std::string> ours;
    for (const std::string& error : result.errors)
      if (error.starts_with("intrinsicdecomp")) ours.push_back(error);
    expect_one(ours, nearest);
    expect_contains(ours.at(0), "videoconvert");
  }
}

}  // namespace inverse::testing
