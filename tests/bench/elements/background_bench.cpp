// SPDX-License-Identifier: LGPL-2.1-or-later
// Whether frames of globalintrinsicthesis wait for its background work: the time of each frame
// without background work, while base colors are refined, and while the color of a marked region is
// decided.
//
// usage: background-bench [--clip FILE] [--size 160x120] [--frames N] [--json FILE]
// N frames of each kind, in alternating blocks of one kind, so that other load affects all alike.
#include <gst/check/gstharness.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include "tests/bench/support/clip_frames.hpp"
#include "tests/bench/support/timing.hpp"

namespace {

using inverse::bench::Clock;
using inverse::bench::milliseconds;

enum Kind : size_t { kAlone, kRefining, kCorrecting, kKinds };
constexpr std::array<const char*, kKinds> kNames{"alone", "refining", "correcting"};
constexpr int kMaxRegions = 15;

struct Background {
  bool refining = false;
  guint regions = 0, decided = 0;
};

/// An endless stream.
class Stream {
 public:
  Stream(const std::vector<GstBuffer*>& clip, const std::string& caps, int width, int height)
      : clip_(clip),
        width_(width),
        height_(height),
        harness_(gst_harness_new_parse("globalintrinsicthesis")),
        element_(gst_harness_find_element(harness_, "globalintrinsicthesis")) {
    gst_harness_set_caps_str(harness_, caps.c_str(), caps.c_str());
  }
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;
  ~Stream() {
    gst_object_unref(element_);
    gst_harness_teardown(harness_);
  }

  /// Milliseconds of the next frame. The clip plays forwards and backwards, because a jump would be
  /// a cut.
  double next() {
    const size_t period = std::max<size_t>(1, 2 * (clip_.size() - 1)), at = frames_ % period;
    GstBuffer* buffer = gst_buffer_copy_deep(clip_[at < clip_.size() ? at : period - at]);
    GST_BUFFER_PTS(buffer) = frames_ * (GST_SECOND / 25);
    GST_BUFFER_FLAG_UNSET(buffer, GST_BUFFER_FLAG_DISCONT);
    ++frames_;
    const auto start = Clock::now();
    gst_harness_push(harness_, buffer);
    gst_buffer_unref(gst_harness_pull(harness_));
    return milliseconds(Clock::now() - start);
  }

  /// Background work during the last frame.
  Background background() const {
    Background found;
    gboolean refining = FALSE;
    GstStructure* stats = nullptr;
    g_object_get(element_, "stats", &stats, nullptr);
    gst_structure_get(stats, "refining", G_TYPE_BOOLEAN, &refining, "regions", G_TYPE_UINT,
                      &found.regions, "regions-decided", G_TYPE_UINT, &found.decided, nullptr);
    gst_structure_free(stats);
    found.refining = refining;
    return found;
  }

  void refine() { g_signal_emit_by_name(element_, "refine"); }
  /// Clicks at a cyclic list of positions.
  void mark() {
    constexpr int kColumns = 5, kRows = 4;
    const int place = marked_++ % (kColumns * kRows);
    g_signal_emit_by_name(element_, "mark", width_ * (place % kColumns + 1) / (kColumns + 1),
                          height_ * (place / kColumns + 1) / (kRows + 1));
  }
  void unmark() {
    for (int region = 1; region <= kMaxRegions; ++region)
      g_signal_emit_by_name(element_, "unmark", region);
  }

 private:
  const std::vector<GstBuffer*>& clip_;
  int width_, height_;
  GstHarness* harness_;
  GstElement* element_;
  guint64 frames_ = 0;
  int marked_ = 0;
};

struct Found {
  std::array<std::vector<double>, kKinds> times;
  int refinements = 0, decisions = 0;
};

/// Processes frames until `max` of a kind were measured or it takes too long; other frames are not
/// counted.
void block(Stream& stream, Kind kind, size_t max, Found& found) {
  const size_t enough = found.times[kind].size() + max;
  Background before = stream.background();
  for (size_t shown = 0; shown < 4 * max && found.times[kind].size() < enough; ++shown) {
    if (kind == kRefining && !before.refining) stream.refine(), ++found.refinements;
    if (kind == kCorrecting && before.decided == before.regions) {
      found.decisions += before.regions > 0;
      stream.unmark();
      stream.mark();
    }
    const double took = stream.next();
    const Background now = stream.background();
    const bool correcting = now.regions > now.decided;
    const Kind is = now.refining ? kRefining : correcting ? kCorrecting : kAlone;
    if (is == kind && !(now.refining && correcting)) found.times[kind].push_back(took);
    before = now;
  }
  stream.unmark();
  for (int k = 0; k < 4 * kMaxRegions && (before.refining || before.regions > 0); ++k) {
    stream.next();
    before = stream.background();
  }
}

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[static_cast<size_t>(share * static_cast<double>(values.size() - 1) + 0.5)];
}

}  // namespace

int main(int count, char** arguments) {
  gst_init(&count, &arguments);
  std::string clip = "media/clip.webm", size = "160x120", json;
  size_t frames = 60;
  for (int i = 1; i < count; ++i) {
    const std::string argument = arguments[i];
    const auto next = [&] { return std::string(++i < count ? arguments[i] : ""); };
    if (argument == "--clip")
      clip = next();
    else if (argument == "--size")
      size = next();
    else if (argument == "--frames")
      frames = static_cast<size_t>(std::max(10, std::stoi(next())));
    else if (argument == "--json")
      json = next();
    else
      return std::fprintf(stderr, "%s?\n", argument.c_str()), 2;
  }
  int width = 0, height = 0;
  if (std::sscanf(size.c_str(), "%dx%d", &width, &height) != 2) return 2;
  const std::string caps = "video/x-raw, format=NV12, width=" + std::to_string(width) +
                           ", height=" + std::to_string(height) + ", framerate=25/1";
  const auto video = inverse::bench::load_clip(clip, caps, 40);
  if (video.size() < 4) {
    std::fprintf(stderr, "cannot read %s\n", clip.c_str());
    return 1;
  }
  constexpr size_t kBlocks = 3;
  Found found;
  {
    Stream stream(video, caps, width, height);
    for (int k = 0; k < 4 || (k < 40 && stream.background().refining); ++k) stream.next();
    for (size_t b = 0; b < kBlocks; ++b)
      for (const Kind kind : {kAlone, kRefining, kCorrecting}) {
        std::fprintf(stderr, "@progress %.3f %s\n",
                     static_cast<double>(kKinds * b + kind) / static_cast<double>(kKinds * kBlocks),
                     kNames[kind]);
        block(stream, kind, frames / kBlocks, found);
      }
  }
  std::string text;
  std::printf("| frames | number | median ms | 95 %% | most |\n|---|---|---|---|---|\n");
  for (size_t kind = 0; kind < kKinds; ++kind) {
    const auto& times = found.times[kind];
    std::printf("| %s | %zu | %.1f | %.1f | %.1f |\n", kNames[kind], times.size(),
                quantile(times, 0.5), quantile(times, 0.95), quantile(times, 1));
    text += std::string(kind > 0 ? ", " : "") + "\"" + kNames[kind] + "\": [";
    for (size_t k = 0; k < times.size(); ++k)
      text += (k > 0 ? ", " : "") + std::to_string(times[k]);
    text += "]";
  }
  std::printf("%d refinements, %d regions decided\n", found.refinements, found.decisions);
  for (GstBuffer* buffer : video) gst_buffer_unref(buffer);
  if (!json.empty() &&
      !(std::ofstream(json) << "{\"width\": " << width << ", \"height\": " << height
                            << ", \"refinements\": " << found.refinements << ", \"decisions\": "
                            << found.decisions << ", \"times_ms\": {" << text << "}}\n")
           .flush()) {
    std::fprintf(stderr, "cannot write %s\n", json.c_str());
    return 1;
  }
  return 0;
}
