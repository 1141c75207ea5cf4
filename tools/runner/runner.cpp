// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner.hpp"

#include <glib-unix.h>
#include <gst/pbutils/pbutils.h>
#include <gst/video/video.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <utility>
#include <vector>

#include "common/replace_file.hpp"
#include "contact_sheet.hpp"
#include "paint.hpp"

namespace inverse::run {
namespace {

using Clock = std::chrono::steady_clock;

// Compressed sound that Matroska accepts; other sound is decoded and stored as samples.
constexpr const char* kVideoOrSound =
    "video/x-raw(ANY); audio/mpeg, mpegversion=1; audio/mpeg, mpegversion={2,4}, "
    "stream-format=raw; "
    "audio/x-vorbis; audio/x-opus; audio/x-flac, framed=true; audio/x-ac3; audio/x-eac3; "
    "audio/x-dts; audio/x-alaw; audio/x-mulaw; audio/x-tta; audio/x-raw";

// Fast enough for real time on two cores, at a quality sufficient to judge the image.
constexpr const char* kFileSink =
    "queue max-size-buffers=4 ! videoconvert ! vp8enc deadline=1 cpu-used=8 threads=4 "
    "end-usage=cq cq-level=16 target-bitrate=20000000 keyframe-max-dist=60";

std::runtime_error failure(GError* error, const std::string& about) {
  const std::string text = about + (error ? error->message : "unknown reason");
  g_clear_error(&error);
  return std::runtime_error(text);
}

GstElement* make(const char* factory, const char* package) {
  GstElement* element = gst_element_factory_make(factory, nullptr);
  if (!element)
    throw std::runtime_error(std::string("the element ") + factory + " is missing; install " +
                             package);
  return element;
}

GstElement* parse_bin(const std::string& line) {
  GError* error = nullptr;
  GstElement* bin = gst_parse_bin_from_description(line.c_str(), TRUE, &error);
  if (error) {
    if (bin) gst_object_unref(bin);
    throw failure(error, "cannot make sense of \"" + line + "\": ");
  }
  return bin;
}

/// The sink for a window on the display of the environment; empty if no display is available. Not
/// autovideosink, which also tries frame buffers.
std::string window_sink() {
  const auto set = [](const char* name) {
    const char* value = getenv(name);
    return value && *value;
  };
  const auto works = [](const char* factory) {
    GstElement* sink = gst_element_factory_make(factory, nullptr);
    if (!sink) return false;
    const bool ready = gst_element_set_state(sink, GST_STATE_READY) != GST_STATE_CHANGE_FAILURE;
    gst_element_set_state(sink, GST_STATE_NULL);
    gst_object_unref(sink);
    return ready;
  };
  if (set("WAYLAND_DISPLAY") && works("waylandsink")) return "waylandsink";
  if (set("DISPLAY"))
    for (const char* factory : {"xvimagesink", "ximagesink"})
      if (works(factory)) return factory;
  if ((set("WAYLAND_DISPLAY") || set("DISPLAY")) && works("glimagesink")) return "glimagesink";
  return {};
}

class Session {
 public:
  explicit Session(const Options& options);
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;
  ~Session();
  void play();

 private:
  void add_source();
  void add_paint();
  void add_window();
  void add_file();
  void check_place(const std::string& result) const;
  void publish() const;
  static void on_pad(GstElement*, GstPad* pad, Session* self) { self->connect(pad); }
  static gboolean see(GstElement*, GstPad*, const GstCaps* caps, Session* self) {
    if (is_list(caps)) self->list_ = true;
    return TRUE;
  }
  void connect(GstPad* pad);
  void connect_sound(GstPad* pad);
  void limit(GstPad* pad);
  void on_no_more_pads();
  void on_input(GstPad* pad, GstBuffer* buffer);
  void on_frame(GstPad* pad, GstBuffer* buffer);
  void on_message(GstMessage* message);
  void on_error(GstMessage* message);
  void tick();
  void report() const;

  const Options& options_;
  const std::string window_sink_;
  const bool window_;
  const std::string movie_, sheet_path_;
  const std::string draft_;  // of the movie, until it is whole
  GstElement* pipeline_ = gst_pipeline_new("run");
  GstElement* chain_ = nullptr;
  GstElement* mux_ = nullptr;
  std::unique_ptr<Paint> paint_;
  GMainLoop* loop_ = g_main_loop_new(nullptr, FALSE);
  std::vector<guint> sources_;
  std::string error_;
  std::vector<std::string> missing_;
  std::atomic<bool> stopping_{false}, arrived_{false}, list_{false};
  bool first_reported_ = false;
  Clock::time_point shown_ = Clock::now();

  mutable std::mutex mutex_;  // the rest, shared with streaming threads
  bool video_ = false;
  int sounds_ = 0;
  uint64_t frames_ = 0;
  int width_ = 0, height_ = 0;
  Clock::time_point started_, first_, last_;
  std::map<std::string, std::vector<double>>
      milliseconds_;  // device time per frame, of elements with stats
  ContactSheet sheet_;
};

Session::Session(const Options& options)
    : options_(options),
      window_sink_(options.view == View::file ? "" : window_sink()),
      window_(!window_sink_.empty()),
      movie_(options.folder + "/decomposition.mkv"),
      sheet_path_(options.folder + "/contact-sheet.png"),
      draft_(options.folder + "/.decomposition." + std::to_string(getpid()) + ".mkv") {
  if (options.view == View::window && !window_)
    throw std::runtime_error(
        "no window can be shown: neither DISPLAY nor WAYLAND_DISPLAY names a display that answers");
  chain_ = parse_bin(options.chain);
  GstPad* in = gst_element_get_static_pad(chain_, "sink");
  GstPad* out = gst_element_get_static_pad(chain_, "src");
  const bool open = in && out;
  if (in) gst_object_unref(in);
  if (!open) {
    if (out) gst_object_unref(out);
    gst_object_unref(chain_);
    throw std::runtime_error("\"" + options.chain +
                             "\" must take video at its beginning and give video at its end; the "
                             "source and the sink are added around it");
  }
  gst_pad_add_probe(
      out, GST_PAD_PROBE_TYPE_BUFFER,
      +[](GstPad* pad, GstPadProbeInfo* info, gpointer self) {
        static_cast<Session*>(self)->on_frame(pad, GST_PAD_PROBE_INFO_BUFFER(info));
        return GST_PAD_PROBE_OK;
      },
      this, nullptr);
  gst_object_unref(out);

  // A newer frame of a camera replaces a waiting one.
  GstElement* queue = make("queue", "gstreamer1.0-plugins-base");
  if (options.input.live) gst_util_set_object_arg(G_OBJECT(queue), "leaky", "downstream");
  g_object_set(queue, "max-size-buffers", options.input.live ? 1 : 4, nullptr);
  gst_element_set_name(queue, "entry");
  gst_bin_add_many(GST_BIN(pipeline_), queue, chain_, nullptr);
  gst_element_link(queue, chain_);
  window_ ? add_window() : add_file();
  add_source();
  if (!options.paint.empty()) add_paint();
}

Session::~Session() {
  for (const guint source : sources_) g_source_remove(source);
  gst_element_set_state(pipeline_, GST_STATE_NULL);
  gst_object_unref(pipeline_);
  g_main_loop_unref(loop_);
  if (!error_.empty() || frames_ == 0) unlink(draft_.c_str());  // if it is there
}

void Session::add_source() {
  GstElement* decoder = nullptr;
  if (options_.input.live) {
    GstElement* camera = make("v4l2src", "gstreamer1.0-plugins-good");
    g_object_set(camera, "device", options_.input.location.c_str(), nullptr);
    decoder = make("decodebin", "gstreamer1.0-plugins-base");
    gst_bin_add_many(GST_BIN(pipeline_), camera, decoder, nullptr);
    gst_element_link(camera, decoder);
  } else {
    decoder = make("uridecodebin", "gstreamer1.0-plugins-base");
    g_object_set(decoder, "uri", options_.input.location.c_str(), nullptr);
    if (!window_) gst_util_set_object_arg(G_OBJECT(decoder), "caps", kVideoOrSound);
    gst_bin_add(GST_BIN(pipeline_), decoder);
    g_signal_connect(decoder, "autoplug-continue", G_CALLBACK(see), this);
  }
  g_signal_connect(decoder, "pad-added", G_CALLBACK(on_pad), this);
  g_signal_connect(decoder, "no-more-pads",
                   G_CALLBACK(+[](GstElement*, Session* self) { self->on_no_more_pads(); }), this);
}

void Session::add_paint() {
  GstElement* recolor = gst_bin_get_by_name(GST_BIN(chain_), options_.paint.c_str());
  if (!recolor) throw std::runtime_error("no element is called " + options_.paint);
  paint_ = std::make_unique<Paint>(recolor);
  gst_object_unref(recolor);
  if (gst_uri_has_protocol(options_.input.location.c_str(), "file"))
    paint_->choose_for(options_.input.location);
}

void Session::add_window() {
  GstElement* sink =
      parse_bin("videoconvert ! " + window_sink_ + (options_.input.live ? " sync=false" : ""));
  gst_bin_add(GST_BIN(pipeline_), sink);
  gst_element_link(chain_, sink);
}

void Session::add_file() {
  std::error_code code;
  std::filesystem::create_directories(options_.folder, code);
  if (code || access(options_.folder.c_str(), W_OK) != 0)
    throw std::runtime_error("cannot write into the folder " + options_.folder);
  for (const std::string& result : {movie_, sheet_path_}) check_place(result);
  GstElement* encoder = parse_bin(kFileSink);
  mux_ = make("matroskamux", "gstreamer1.0-plugins-good");
  GstElement* file = make("filesink", "gstreamer1.0-plugins-base");
  g_object_set(file, "location", draft_.c_str(), nullptr);
  gst_bin_add_many(GST_BIN(pipeline_), encoder, mux_, file, nullptr);
  gst_element_link_many(chain_, encoder, mux_, file, nullptr);
}

/// Throws if a result would replace the input, or what is there without `overwrite`.
void Session::check_place(const std::string& result) const {
  std::error_code none;
  gchar* input = g_filename_from_uri(options_.input.location.c_str(), nullptr, nullptr);
  const bool same = input && std::filesystem::equivalent(input, result, none);
  g_free(input);
  if (same)
    throw std::runtime_error("the result would replace the input " + result +
                             ": name another folder with --out");
  if (!options_.overwrite &&
      std::filesystem::symlink_status(result, none).type() != std::filesystem::file_type::not_found)
    throw std::runtime_error(result +
                             " is there already: name another folder with --out, or give "
                             "--overwrite to replace it");
}

/// Gives the movie its name.
void Session::publish() const {
  try {
    check_place(movie_);  // a file may have come meanwhile
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(std::string(error.what()) + "; the new one is " + draft_);
  }
  sync_path(draft_);
  std::filesystem::rename(draft_, movie_);
  sync_path(options_.folder);
}

void Session::connect(GstPad* pad) {
  GstCaps* caps = gst_pad_get_current_caps(pad);
  if (!caps) caps = gst_pad_query_caps(pad, nullptr);
  const std::string kind = gst_structure_get_name(gst_caps_get_structure(caps, 0));
  gst_caps_unref(caps);
  if (kind.rfind("audio/", 0) == 0) return connect_sound(pad);
  if (kind != "video/x-raw") return;
  {
    std::lock_guard lock(mutex_);
    if (video_) return;  // the first stream of several
    video_ = true;
  }
  GstElement* entry = gst_bin_get_by_name(GST_BIN(pipeline_), "entry");
  GstPad* sink = gst_element_get_static_pad(entry, "sink");
  gst_pad_link(pad, sink);
  gst_object_unref(sink);
  gst_object_unref(entry);
  gst_pad_add_probe(
      pad, GST_PAD_PROBE_TYPE_BUFFER,
      +[](GstPad* from, GstPadProbeInfo* info, gpointer data) {
        static_cast<Session*>(data)->on_input(from, GST_PAD_PROBE_INFO_BUFFER(info));
        return GST_PAD_PROBE_OK;
      },
      this, nullptr);
  limit(pad);
}

void Session::on_input(GstPad* pad, GstBuffer* buffer) {
  arrived_ = true;
  if (!paint_ || paint_->chosen()) return;
  GstCaps* caps = gst_pad_get_current_caps(pad);
  paint_->offer(buffer, caps);
  if (caps) gst_caps_unref(caps);
}

/// Ends the stream of this pad after a stop request.
void Session::limit(GstPad* pad) {
  gst_pad_add_probe(
      pad, GST_PAD_PROBE_TYPE_BUFFER,
      +[](GstPad*, GstPadProbeInfo* info, gpointer data) {
        auto* self = static_cast<Session*>(data);
        GstBuffer* buffer = GST_PAD_PROBE_INFO_BUFFER(info);
        const bool late =
            self->options_.seconds > 0 && GST_BUFFER_PTS_IS_VALID(buffer) &&
            static_cast<double>(GST_BUFFER_PTS(buffer)) >= self->options_.seconds * GST_SECOND;
        if (!late && !self->stopping_) return GST_PAD_PROBE_OK;
        GST_PAD_PROBE_INFO_FLOW_RETURN(info) = GST_FLOW_EOS;
        gst_buffer_unref(buffer);
        return GST_PAD_PROBE_HANDLED;
      },
      this, nullptr);
}

void Session::connect_sound(GstPad* pad) {
  // The file interleaves sound and video: this queue must not block the demuxer.
  GstElement* branch = window_
                           ? parse_bin("queue ! audioconvert ! audioresample ! autoaudiosink")
                           : parse_bin("queue max-size-buffers=0 max-size-bytes=0 max-size-time=0");
  gst_bin_add(GST_BIN(pipeline_), branch);
  // By name: the queue would match the pad for subtitles as well.
  if (!window_) gst_element_link_pads(branch, "src", mux_, "audio_%u");
  GstPad* sink = gst_element_get_static_pad(branch, "sink");
  gst_pad_link(pad, sink);
  gst_object_unref(sink);
  gst_element_sync_state_with_parent(branch);
  limit(pad);
  std::lock_guard lock(mutex_);
  ++sounds_;
}

void Session::on_no_more_pads() {
  std::lock_guard lock(mutex_);
  if (video_) return;
  GST_ELEMENT_ERROR(pipeline_, STREAM, FORMAT,
                    ("no video in %s that can be decoded", options_.input.described.c_str()),
                    (nullptr));
}

void Session::on_frame(GstPad* pad, GstBuffer* buffer) {
  GstCaps* caps = gst_pad_get_current_caps(pad);
  std::lock_guard lock(mutex_);
  if (frames_++ == 0) first_ = Clock::now();
  last_ = Clock::now();
  if (caps) {
    const GstStructure* structure = gst_caps_get_structure(caps, 0);
    gst_structure_get_int(structure, "width", &width_);
    gst_structure_get_int(structure, "height", &height_);
    if (!window_) sheet_.offer(buffer, caps);
    gst_caps_unref(caps);
  }
  GstIterator* elements = gst_bin_iterate_recurse(GST_BIN(chain_));
  GValue item = G_VALUE_INIT;
  while (gst_iterator_next(elements, &item) == GST_ITERATOR_OK) {
    GObject* element = G_OBJECT(g_value_get_object(&item));
    const GParamSpec* spec = g_object_class_find_property(G_OBJECT_GET_CLASS(element), "stats");
    GstStructure* stats = nullptr;
    if (spec && spec->value_type == GST_TYPE_STRUCTURE)
      g_object_get(element, "stats", &stats, nullptr);
    double milliseconds = 0;
    if (stats && gst_structure_has_name(stats, "inverse-stats") &&
        gst_structure_get_double(stats, "device-ms", &milliseconds))
      milliseconds_[GST_OBJECT_NAME(element)].push_back(milliseconds);
    if (stats) gst_structure_free(stats);
    g_value_reset(&item);
  }
  if (G_IS_VALUE(&item)) g_value_unset(&item);
  gst_iterator_free(elements);
}

void Session::on_message(GstMessage* message) {
  switch (GST_MESSAGE_TYPE(message)) {
    case GST_MESSAGE_EOS:
      g_main_loop_quit(loop_);
      break;
    case GST_MESSAGE_ERROR:
      on_error(message);
      break;
    case GST_MESSAGE_ELEMENT:
      if (gst_is_missing_plugin_message(message)) {
        gchar* what = gst_missing_plugin_message_get_description(message);
        missing_.push_back(what);
        g_free(what);
      }
      break;
    case GST_MESSAGE_LATENCY:
      gst_bin_recalculate_latency(GST_BIN(pipeline_));
      break;
    default:
      break;
  }
}

void Session::on_error(GstMessage* message) {
  GError* error = nullptr;
  gchar* debug = nullptr;
  gst_message_parse_error(message, &error, &debug);
  // The error of all window sinks when their window is closed.
  const bool closed = window_ &&
                      g_error_matches(error, GST_RESOURCE_ERROR, GST_RESOURCE_ERROR_NOT_FOUND) &&
                      strstr(error->message, "window was closed");
  if (!closed && error_.empty() && list_) {
    error_ =
        "it is a list of streams, which may be on other hosts: open one of them by its address, if "
        "you trust it";
  } else if (!closed && error_.empty()) {
    error_ = std::string(GST_OBJECT_NAME(GST_MESSAGE_SRC(message))) + ": " + error->message;
    // basesrc's message only repeats that something failed; the details contain the reason.
    if (debug && g_error_matches(error, GST_STREAM_ERROR, GST_STREAM_ERROR_FAILED))
      error_ += std::string("\n") + debug;
    for (const std::string& what : missing_)
      error_ +=
          "\nmissing: " + what + " (gstreamer1.0-libav and gstreamer1.0-plugins-bad have most)";
  }
  g_free(debug);
  g_error_free(error);
  g_main_loop_quit(loop_);
}

void Session::tick() {
  gint64 position = -1, duration = -1;
  gst_element_query_position(pipeline_, GST_FORMAT_TIME, &position);
  const bool terminal = isatty(STDERR_FILENO);
  if (!terminal && Clock::now() - shown_ < std::chrono::seconds(2)) return;
  shown_ = Clock::now();
  std::lock_guard lock(mutex_);
  const char* const format = terminal ? "\r\033[K%s" : "%s\n";
  std::string line;
  if (!frames_) {
    const auto waited =
        std::chrono::duration_cast<std::chrono::seconds>(Clock::now() - started_).count();
    line = arrived_ ? "waiting for the first frame while the Vulkan device compiles its kernels, "
                    : "waiting for the input, ";
    fprintf(stderr, format, (line + std::to_string(waited) + " s").c_str());
    fflush(stderr);
    return;
  }
  if (!std::exchange(first_reported_, true))
    fprintf(stderr, terminal ? "\r\033[Kfirst frame after %.1f s\n" : "first frame after %.1f s\n",
            std::chrono::duration<double>(first_ - started_).count());
  const double elapsed = std::chrono::duration<double>(last_ - first_).count();
  if (!options_.input.live && gst_element_query_duration(pipeline_, GST_FORMAT_TIME, &duration) &&
      duration > 0) {
    double whole = static_cast<double>(duration) / GST_SECOND;
    if (options_.seconds > 0) whole = std::min(whole, options_.seconds);
    line = std::to_string(std::clamp(
               std::lround(static_cast<double>(position) / GST_SECOND / whole * 100), 0l, 100l)) +
           " %, ";
  }
  char rate[64];
  snprintf(rate, sizeof rate, "%.1f frames/s",
           elapsed > 0 ? static_cast<double>(frames_ - 1) / elapsed : 0.0);
  line += "frame " + std::to_string(frames_) + ", " + rate;
  fprintf(stderr, format, line.c_str());
  fflush(stderr);
}

void Session::play() {
  GstBus* bus = gst_element_get_bus(pipeline_);
  sources_.push_back(gst_bus_add_watch(
      bus,
      +[](GstBus*, GstMessage* message, gpointer self) -> gboolean {
        static_cast<Session*>(self)->on_message(message);
        return G_SOURCE_CONTINUE;
      },
      this));
  gst_object_unref(bus);
  const auto interrupt = +[](gpointer self) -> gboolean {
    auto* session = static_cast<Session*>(self);
    // The first time ends the streams in order; the second time, for a camera without frames, at
    // once.
    if (session->stopping_.exchange(true)) g_main_loop_quit(session->loop_);
    return G_SOURCE_CONTINUE;
  };
  sources_.push_back(g_unix_signal_add(SIGINT, interrupt, this));
  sources_.push_back(g_unix_signal_add(SIGTERM, interrupt, this));
  sources_.push_back(g_timeout_add(
      100,
      +[](gpointer self) -> gboolean {
        static_cast<Session*>(self)->tick();
        return G_SOURCE_CONTINUE;
      },
      this));
  fprintf(stderr, "%s %s; Ctrl-C ends\n", window_ ? "showing" : "decomposing",
          options_.input.described.c_str());
  started_ = Clock::now();
  if (!window_) NewFile(draft_).close();
  gst_element_set_state(pipeline_, GST_STATE_PLAYING);
  g_main_loop_run(loop_);
  if (isatty(STDERR_FILENO)) fprintf(stderr, "\r\033[K");
  gst_element_set_state(pipeline_, GST_STATE_NULL);
  if (!error_.empty()) {
    if (!window_ && frames_ > 0 && !std::filesystem::exists(movie_)) publish();
    throw std::runtime_error("cannot play " + options_.input.described + ": " + error_);
  }
  if (!window_) {
    if (frames_ > 0) publish();
    check_place(sheet_path_);
    sheet_.write(sheet_path_);
    printf("wrote %s (%dx%d, VP8%s)\nwrote %s\n", movie_.c_str(), width_, height_,
           sounds_ ? ", sound as it came" : "", sheet_path_.c_str());
  }
  report();
}

void Session::report() const {
  const double elapsed = std::chrono::duration<double>(last_ - first_).count();
  printf("%llu frames", static_cast<unsigned long long>(frames_));
  if (frames_ > 1 && elapsed > 0)
    printf(" in %.1f s: %.1f frames/s", elapsed, static_cast<double>(frames_ - 1) / elapsed);
  const char* separator = "; median device time a frame: ";
  for (auto [name, values] : milliseconds_) {
    const auto middle = values.begin() + static_cast<ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    printf("%s%s %.1f ms", separator, name.c_str(), *middle);
    separator = ", ";
  }
  printf("\n");
}

}  // namespace

void run(const Options& options) { Session(options).play(); }

}  // namespace inverse::run
