// SPDX-License-Identifier: LGPL-2.1-or-later
// Cost of an element in an application: frames that the host writes and reads. They are those of
// the bundled clip, scaled, and lie where the element asks for them; elements take turns, so that
// other load affects all alike. Wall, processor and device time are of frames whose stages are not
// timed; the last frames of a round are for the stages alone.
//
// usage: element-bench [--clip FILE] [--sizes 640x480,…] [--frames N] [--rounds N] [--still]
//                      [--ball] [--json FILE] [ELEMENT …]
// --still repeats one frame of the clip; --ball moves a small ball over it. Without ELEMENT: every
// element, at sizes of its own unless --sizes names others. SIZE in a line stands for caps of it.
// What a device cannot do is reported.
#include <gst/check/gstharness.h>
#include <gst/video/video.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <functional>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "tests/bench/support/clip_frames.hpp"
#include "tests/bench/support/clip_scenes.hpp"
#include "tests/bench/support/command_line.hpp"
#include "tests/bench/support/json.hpp"
#include "tests/bench/support/timing.hpp"

namespace {

using inverse::bench::Clock;
using inverse::bench::mean;
using inverse::bench::median;
using inverse::bench::milliseconds;
using inverse::bench::processor_ms;

struct Size {
  int width, height;
  bool operator==(const Size&) const = default;
};

/// Caps of a source.
std::string made_caps(Size size) {
  return "video/x-raw, width=" + std::to_string(size.width) +
         ", height=" + std::to_string(size.height);
}

std::string caps_of(Size size, const char* format) {
  return made_caps(size) + ", format=" + format + ", framerate=25/1";
}

std::string line_at(std::string line, Size size) {
  if (const size_t at = line.find("SIZE"); at != std::string::npos)
    line.replace(at, 4, made_caps(size));
  return line;
}

/// What is measured: elements of a launch line, and the sizes at which they are measured.
struct Subject {
  std::string line;
  std::vector<Size> sizes;
};

constexpr Size kSmall{640, 480}, kLarge{1920, 1080};
// Without lightstagearavissrc, which needs a camera. A light stage keeps a picture of every light.
const std::vector<Subject> kEveryElement{
    {"intrinsicdecomp", {kSmall, {1280, 720}, kLarge, {3840, 2160}, {7680, 4320}}},
    {"globalintrinsic", {kSmall, kLarge}},
    {"intrinsicdecompthesis", {kSmall}},
    {"globalintrinsicthesis", {kSmall}},
    {"intrinsicdecomp ! intrinsiccompose", {kSmall, kLarge}},
    {"intrinsicdecomp ! intrinsicrecolor key=0xffe01e32 target=0xff2878f0 ! intrinsiccompose",
     {kSmall, kLarge}},
    {"intrinsicdecomp ! intrinsicselect "
     "strokes::list=\"{\\\"frame\\\":[640,480],\\\"strokes\\\":[{\\\"kind\\\":\\\"add\\\","
     "\\\"points\\\":[[390,300]]}]}\" ! intrinsicrecolor target=0xff2878f0 ! intrinsiccompose",
     {kSmall, kLarge}},
    {"intrinsicdecomp ! intrinsickey", {kSmall, kLarge}},
    {"intrinsicdecomp ! intrinsictone look=metal ! intrinsiccompose", {kSmall, kLarge}},
    {"intrinsicdecomp ! intrinsicstylize ! intrinsiccompose", {kSmall, kLarge}},
    {"intrinsicdecomp ! intrinsicrelight "
     "lamps=\"[{\\\"kind\\\":\\\"point\\\",\\\"position\\\":[200,200,0.3]}]\" ! intrinsiccompose",
     {kSmall, kLarge}},
    {"intrinsicedit layer=shading effect=\"gaussianblur sigma=4\"", {kSmall, kLarge}},
    {"intrinsicdecomp ! intrinsicrecolor ! intrinsictone ! intrinsicstylize "
     "strength=0 ! intrinsicrelight ! intrinsicmerge ! intrinsiccompose",
     {kSmall, kLarge}},
    {"globalintrinsic ! intrinsicdespill key=0xffe01e32 ! intrinsiccompose", {kSmall, kLarge}},
    {"intrinsicdecomp ! intrinsicsplit name=split split.reflectance ! identity", {kSmall, kLarge}},
    {"limematerial", {kSmall, kLarge}},
    {"materialclone", {kSmall, kLarge}},
    {"lightstagetestsrc is-live=false", {{320, 240}}},
    {"lightstagetestsrc is-live=false ! SIZE ! sync.sink_0 lightstagesync name=sync assemble=pairs "
     "sync.src_0 ! olatrelight",
     {{320, 240}}}};

/// Counts of a frame's `stats`.
const char* const kCounts[] = {"dispatches",        "transfers",           "barriers",
                               "bytes-transferred", "bytes-uploaded",      "bytes-downloaded",
                               "scene-blocks",      "scene-blocks-visible"};

struct Figures {
  std::vector<double> wall, processor, device, first;
  std::map<std::string, std::vector<double>> stages, counts;
  std::string device_name;
  double device_bytes = 0;
  int layers = 0;     ///< of indirect light; 0: none
  std::string error;  ///< why it cannot be measured
};

void for_elements(GstHarness* harness, const std::function<void(GstElement*)>& visit) {
  GstIterator* elements = gst_bin_iterate_recurse(GST_BIN(harness->element));
  GValue item = G_VALUE_INIT;
  while (gst_iterator_next(elements, &item) == GST_ITERATOR_OK) {
    visit(GST_ELEMENT(g_value_get_object(&item)));
    g_value_reset(&item);
  }
  g_value_unset(&item);
  gst_iterator_free(elements);
}

/// Elements time their stages while their category logs at DEBUG; main() lets nothing print that.
void time_stages(GstHarness* harness, bool wanted) {
  for_elements(harness, [&](GstElement* element) {
    const char* category = gst_plugin_feature_get_name(gst_element_get_factory(element));
    if (wanted)
      gst_debug_set_threshold_for_name(category, GST_LEVEL_DEBUG);
    else
      gst_debug_unset_threshold_for_name(category);
  });
}

/// Adds the last frame's `stats` of all elements of a line: its stages, or all but them.
void add_stats(GstHarness* harness, bool of_stages, Figures& figures) {
  double device = 0;
  std::map<std::string, double> stages, counts;
  for_elements(harness, [&](GstElement* element) {
    if (!g_object_class_find_property(G_OBJECT_GET_CLASS(element), "stats")) return;
    GstStructure* stats = nullptr;
    g_object_get(element, "stats", &stats, nullptr);
    for (int field = 0; field < gst_structure_n_fields(stats); ++field) {
      const std::string name = gst_structure_nth_field_name(stats, static_cast<guint>(field));
      gdouble value = 0;
      if (!name.ends_with("-ms") || name == "wall-ms" ||
          !gst_structure_get_double(stats, name.c_str(), &value))
        continue;
      (name == "device-ms" ? device : stages[name.substr(0, name.size() - 3)]) += value;
    }
    for (const char* name : kCounts) {
      guint count = 0;
      guint64 bytes = 0;
      if (gst_structure_get_uint(stats, name, &count)) counts[name] += count;
      if (gst_structure_get_uint64(stats, name, &bytes)) counts[name] += static_cast<double>(bytes);
    }
    guint64 bytes = 0;  // of all elements on the device
    if (gst_structure_get_uint64(stats, "device-bytes-peak", &bytes))
      figures.device_bytes = std::max(figures.device_bytes, static_cast<double>(bytes));
    if (const char* name = gst_structure_get_string(stats, "device")) figures.device_name = name;
    guint colors = 0;
    if (!gst_structure_get_int(stats, "indirect-layers", &figures.layers) &&
        gst_structure_get_uint(stats, "colors", &colors))
      figures.layers = static_cast<int>(colors);
    gst_structure_free(stats);
  });
  for (const auto& [name, value] : stages)
    if (of_stages) figures.stages[name].push_back(value);
  if (of_stages) return;
  figures.device.push_back(device);
  for (const auto& [name, value] : counts) figures.counts[name].push_back(value);
}

/// The first error that an element posted; empty if none did.
std::string error_on(GstBus* bus) {
  GstMessage* message = gst_bus_pop_filtered(bus, GST_MESSAGE_ERROR);
  if (!message) return {};
  GError* error = nullptr;
  gst_message_parse_error(message, &error, nullptr);
  std::string text = error->message;
  g_error_free(error);
  gst_message_unref(message);
  return text;
}

/// Why the elements of a line cannot start; empty if they can. GstHarness would end the process.
std::string reason_not_to_start(const std::string& line) {
  GError* error = nullptr;
  GstElement* bin = gst_parse_bin_from_description(line.c_str(), FALSE, &error);
  std::string reason = error ? error->message : "";
  g_clear_error(&error);
  if (!bin) return reason;
  GstBus* bus = gst_bus_new();
  gst_element_set_bus(bin, bus);
  if (gst_element_set_state(bin, GST_STATE_PAUSED) == GST_STATE_CHANGE_FAILURE) {
    reason = error_on(bus);
    if (reason.empty()) reason = "it does not start";
  }
  gst_element_set_state(bin, GST_STATE_NULL);
  gst_element_set_bus(bin, nullptr);
  gst_object_unref(bus);
  gst_object_unref(bin);
  return reason;
}

/// The next frame of a source; null, and what it posted, if there was an error.
GstBuffer* pull_from_source(GstHarness* harness, GstBus* bus, std::string& error) {
  for (;;) {
    if (GstBuffer* buffer = gst_harness_try_pull(harness)) return buffer;
    error = error_on(bus);
    if (!error.empty()) return nullptr;
    g_usleep(200);
  }
}

/// A pool of the memory that the first element asks for, as a decoder would make it.
GstBufferPool* pool_for(GstHarness* harness, const GstVideoInfo& info) {
  GstCaps* caps = gst_video_info_to_caps(&info);
  GstQuery* query = gst_query_new_allocation(caps, TRUE);
  GstBufferPool* pool = nullptr;
  if (gst_pad_peer_query(harness->srcpad, query) && gst_query_get_n_allocation_pools(query) > 0)
    gst_query_parse_nth_allocation_pool(query, 0, &pool, nullptr, nullptr, nullptr);
  if (!pool) {
    pool = gst_video_buffer_pool_new();
    GstStructure* config = gst_buffer_pool_get_config(pool);
    const auto bytes = static_cast<guint>(GST_VIDEO_INFO_SIZE(&info));
    gst_buffer_pool_config_set_params(config, caps, bytes, 1, 0);
    gst_buffer_pool_set_config(pool, config);
  }
  gst_buffer_pool_set_active(pool, TRUE);
  gst_query_unref(query);
  gst_caps_unref(caps);
  return pool;
}

/// A copy of a frame in memory of a pool.
GstBuffer* copy_to(GstBufferPool* pool, const GstVideoInfo& info, GstBuffer* frame) {
  GstBuffer* copy = nullptr;
  if (gst_buffer_pool_acquire_buffer(pool, &copy, nullptr) != GST_FLOW_OK) return nullptr;
  GstVideoFrame from, to;
  if (gst_video_frame_map(&from, &info, frame, GST_MAP_READ)) {
    if (gst_video_frame_map(&to, &info, copy, GST_MAP_WRITE)) {
      gst_video_frame_copy(&to, &from);
      gst_video_frame_unmap(&to);
    }
    gst_video_frame_unmap(&from);
  }
  return copy;
}

/// Sends frames to and fro over the clip, so that none follows a cut. Sources make their own.
void measure(const Subject& subject, Size size, const std::vector<GstBuffer*>& clip, size_t count,
             Figures& figures) {
  const std::string line = line_at(subject.line, size);
  figures.error = reason_not_to_start(line);
  if (!figures.error.empty()) return;
  const std::string caps = caps_of(size, "NV12");
  GstVideoInfo info;
  gst_video_info_set_format(&info, GST_VIDEO_FORMAT_NV12, static_cast<guint>(size.width),
                            static_cast<guint>(size.height));
  const size_t plain = count - std::max<size_t>(count / 4, 1);  // frames without timed stages
  const auto start = Clock::now();
  GstHarness* harness = gst_harness_new_parse(line.c_str());
  GstBus* bus = gst_bus_new();
  gst_element_set_bus(harness->element, bus);
  if (harness->srcpad) {
    gst_harness_set_caps_str(harness, caps.c_str(), caps.c_str());
  } else {
    gst_harness_set_sink_caps_str(harness, made_caps(size).c_str());
    gst_harness_play(harness);
  }
  GstBufferPool* pool = nullptr;
  for (size_t i = 0; i < count; ++i) {
    GstBuffer* in = nullptr;
    if (i == plain) time_stages(harness, true);
    if (harness->srcpad) {
      const size_t period = std::max<size_t>(2 * clip.size() - 2, 1), at = i % period;
      if (!pool) pool = pool_for(harness, info);
      in = copy_to(pool, info, clip[std::min(at, period - at)]);
      if (!in) {
        figures.error = "the element's memory holds no frame";
        break;
      }
      GST_BUFFER_PTS(in) = i * (GST_SECOND / 25);
    }
    const double processor = processor_ms();
    const auto push = Clock::now();
    GstBuffer* out = nullptr;
    if (!in) {
      out = pull_from_source(harness, bus, figures.error);
    } else if (const GstFlowReturn flow = gst_harness_push(harness, in); flow == GST_FLOW_OK) {
      out = gst_harness_pull(harness);
    } else {
      figures.error = error_on(bus);
      if (figures.error.empty()) figures.error = gst_flow_get_name(flow);
    }
    if (!out) {
      if (figures.error.empty()) figures.error = error_on(bus);
      if (figures.error.empty()) figures.error = "no frame came out within a minute";
      break;
    }
    gst_buffer_unref(out);
    if (i == 0) figures.first.push_back(milliseconds(Clock::now() - start));
    if (i < 3) continue;  // start, and the first frames of a video
    if (i < plain) {
      figures.wall.push_back(milliseconds(Clock::now() - push));
      figures.processor.push_back(processor_ms() - processor);
    }
    if (i + 1 >= plain) add_stats(harness, i >= plain, figures);
  }
  time_stages(harness, false);
  if (pool) gst_buffer_pool_set_active(pool, FALSE);
  gst_clear_object(&pool);
  gst_element_set_bus(harness->element, nullptr);
  gst_object_unref(bus);
  gst_harness_teardown(harness);
}

/// Medians of values by name.
std::map<std::string, double> medians(const std::map<std::string, std::vector<double>>& values) {
  std::map<std::string, double> result;
  for (const auto& [name, all] : values) result[name] = median(all);
  return result;
}

/// The frames of the clip that are shown at a size, none if it cannot be read. Large ones are few,
/// and come again.
std::vector<GstBuffer*> load(const std::string& clip, Size size, int frames, bool still,
                             bool ball) {
  constexpr size_t kMaxBytes = size_t{512} << 20;
  const size_t bytes = static_cast<size_t>(size.width) * static_cast<size_t>(size.height) * 3 / 2;
  const size_t max = std::max<size_t>(kMaxBytes / std::max<size_t>(bytes, 1), 4);
  auto video = inverse::bench::load_clip(clip, caps_of(size, "NV12"),
                                         std::min(static_cast<size_t>(frames), max));
  if ((still || ball) && !video.empty())
    for (GstBuffer*& frame : video) gst_buffer_replace(&frame, video.front());
  if (ball)
    for (size_t k = 0; k < video.size(); ++k) {
      GstBuffer* copy = gst_buffer_copy_deep(video[k]);
      inverse::bench::draw_ball(copy, size.width, size.height, static_cast<int>(k));
      gst_buffer_unref(video[k]);
      video[k] = copy;
    }
  return video;
}

void print_row(const Subject& subject, Size size, const Figures& f) {
  std::printf("| %s | %dx%d | ", subject.line.c_str(), size.width, size.height);
  if (!f.error.empty()) {
    std::printf("not measured: %s |\n", f.error.c_str());
    return;
  }
  auto counts = medians(f.counts);
  const double pixels = static_cast<double>(size.width) * size.height;
  // The mean has what only some frames do.
  std::printf("%.2f | %.1f | %.1f | %.2f | %.0f | %.0f | %.0f | %.0f | %.0f | %.2f | ",
              median(f.wall), median(f.processor), mean(f.processor), median(f.device),
              median(f.wall) * 1e6 / pixels, f.first.front(), f.device_bytes / pixels,
              counts["dispatches"] + counts["transfers"], counts["barriers"],
              (counts["bytes-uploaded"] + counts["bytes-downloaded"]) / 1e6);
  for (const auto& [name, value] : medians(f.stages)) std::printf("%s %.2f ", name.c_str(), value);
  for (const auto& [name, value] : counts)
    if (name.starts_with("scene-")) std::printf("%s %.0f ", name.c_str(), value);
  std::printf("|\n");
}

std::string json_row(const Subject& subject, Size size, const Figures& f) {
  namespace json = inverse::bench::json;
  json::Object row;
  row.add("element", json::text(subject.line)).add("width", json::number(size.width));
  row.add("height", json::number(size.height)).add("device", json::text(f.device_name));
  if (!f.error.empty()) return row.add("error", json::text(f.error)).str();
  const double pixels = static_cast<double>(size.width) * size.height;
  row.add("wall_ms", json::number(median(f.wall)))
      .add("processor_ms", json::number(median(f.processor)))
      .add("device_ms", json::number(median(f.device)))
      .add("first_frame_ms", json::number(f.first.front()))
      .add("device_bytes_per_pixel", json::number(f.device_bytes / pixels))
      .add("layers", json::number(f.layers));
  for (const auto& [name, value] : medians(f.counts)) {
    std::string key = name;
    std::replace(key.begin(), key.end(), '-', '_');
    row.add(key, json::number(value));
  }
  json::Object stages;
  for (const auto& [name, value] : medians(f.stages)) stages.add(name, json::number(value));
  return row.add("stages_ms", stages.str()).str();
}

}  // namespace

int main(int count, char** arguments) {
  gst_init(&count, &arguments);
  if (!g_getenv("GST_DEBUG")) gst_debug_remove_log_function(nullptr);  // the default one
  std::string clip = "media/clip.webm", json;
  std::vector<Size> sizes;
  std::vector<std::string> lines;
  int frames = 40, rounds = 3;
  bool still = false, ball = false;
  namespace bench = inverse::bench;
  const auto read_sizes = [&sizes](const char* text) {
    sizes.clear();
    std::stringstream list(text);
    for (std::string item; std::getline(list, item, ',');) {
      Size size{};
      if (std::sscanf(item.c_str(), "%dx%d", &size.width, &size.height) != 2 || size.width < 1 ||
          size.height < 1)
        return false;
      sizes.push_back(size);
    }
    return true;
  };
  if (!bench::read({{"--clip", bench::text(clip)},
                    {"--sizes", {true, read_sizes}},
                    {"--frames", bench::integer(frames)},
                    {"--rounds", bench::integer(rounds)},
                    {"--still", bench::flag([&] { still = true; })},
                    {"--ball", bench::flag([&] { ball = true; })},
                    {"--json", bench::text(json)}},
                   count, arguments, "element_bench.cpp", &lines))
    return 2;
  frames = std::max(frames, 6);
  std::vector<Subject> subjects;
  subjects.reserve(lines.size());
  for (const std::string& line : lines)
    subjects.push_back({line, {{320, 240}, kSmall, {1280, 720}, kLarge}});
  if (subjects.empty()) subjects = kEveryElement;
  for (Subject& subject : subjects)
    if (!sizes.empty()) subject.sizes = sizes;
  std::vector<Size> all;
  for (const Subject& subject : subjects)
    for (const Size& size : subject.sizes)
      if (std::find(all.begin(), all.end(), size) == all.end()) all.push_back(size);

  std::string rows, device;
  for (const Size& size : all) {
    std::fprintf(stderr, "@progress %.3f %dx%d\n",
                 static_cast<double>(&size - all.data()) / static_cast<double>(all.size()),
                 size.width, size.height);
    const auto video = load(clip, size, frames, still, ball);
    if (video.size() < 4) {
      std::fprintf(stderr, "%dx%d: not measured: no frames from %s\n", size.width, size.height,
                   clip.c_str());
      continue;
    }
    std::vector<Figures> figures(subjects.size());
    for (int round = 0; round < rounds; ++round)
      for (size_t i = 0; i < subjects.size(); ++i) {
        const Subject& subject = subjects[i];
        const auto& wanted = subject.sizes;
        if (!figures[i].error.empty() ||
            std::find(wanted.begin(), wanted.end(), size) == wanted.end())
          continue;
        // The thesis' method takes seconds per frame at large sizes: a few frames suffice.
        const bool slow = subject.line.find("thesis") != std::string::npos;
        measure(subject, size, video, static_cast<size_t>(slow ? std::min(frames, 6) : frames),
                figures[i]);
      }
    for (size_t i = 0; i < subjects.size(); ++i) {
      if (figures[i].first.empty() && figures[i].error.empty()) continue;  // not at this size
      if (device.empty() && !figures[i].device_name.empty())
        std::printf(
            "device: %s\n\n| element | size | wall ms a frame | processor ms | its mean | device "
            "ms | ns a pixel | first frame ms | device bytes a pixel | commands | barriers | MB "
            "copied | stages, device ms "
            "|\n|---|---|---|---|---|---|---|---|---|---|---|---|---"
            "|\n",
            (device = figures[i].device_name).c_str());
      print_row(subjects[i], size, figures[i]);
      std::fflush(stdout);
      rows += (rows.empty() ? "" : ",\n") + json_row(subjects[i], size, figures[i]);
    }
    for (GstBuffer* buffer : video) gst_buffer_unref(buffer);
  }
  if (!json.empty() && !(std::ofstream(json) << '[' << rows << "]\n").flush()) {
    std::fprintf(stderr, "cannot write %s\n", json.c_str());
    return 1;
  }
  return device.empty() ? 1 : 0;
}
