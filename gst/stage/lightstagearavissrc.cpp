// lightstagearavissrc: frames of an industrial camera with the number and the time that the camera
// gave them.
#include <gst/base/gstpushsrc.h>
#include <gst/video/video.h>

#include <condition_variable>
#include <memory>

#include "aravis_stream.hpp"
#include "base/errors.hpp"
#include "camera_clock.hpp"
#include "light_stage/frame_ids.hpp"

namespace inverse {
namespace {

using Lock = std::unique_lock<std::mutex>;

/// What the GObject owns.
struct Source {
  std::mutex mutex;  ///< of all below
  std::condition_variable news;

  std::string camera_name;
  CameraSettings settings;
  guint buffers = 16, timeout = 2000;

  std::shared_ptr<AravisCamera> camera;
  std::unique_ptr<AravisStream> stream;
  FrameLayout layout;
  GstCaps* reference = nullptr;  ///< of GstReferenceTimestampMeta
  uint32_t id_bits = 0;
  CameraClock clock;
  FrameIds ids{16};
  AravisStream::Counts before;  ///< of streams that ended
  uint64_t frames = 0, missed = 0, timeouts = 0, told = 0;
  bool flushing = false, lost = false;
};

}  // namespace
}  // namespace inverse

struct GstLightStageAravisSrc {
  GstPushSrc parent;
  std::shared_ptr<inverse::Source>* source;  // threads of Aravis hold it, too
};

struct GstLightStageAravisSrcClass {
  GstPushSrcClass parent;
};

namespace inverse {
namespace {

gpointer parent_class = nullptr;

enum : guint {
  PROP_CAMERA_NAME = 1,
  PROP_CAMERA,
  PROP_EXPOSURE,
  PROP_GAIN,
  PROP_FEATURES,
  PROP_PACKET_SIZE,
  PROP_TRIGGER_SOURCE,
  PROP_NUM_BUFFERS_QUEUED,
  PROP_TIMEOUT,
  PROP_FRAME_ID_BITS,
  PROP_STATS,
};

const std::shared_ptr<Source>& shared(gpointer object) {
  return *static_cast<GstLightStageAravisSrc*>(object)->source;
}
Source& source_of(gpointer object) { return *shared(object); }

std::string text_of(const GValue* value) {
  const char* text = g_value_get_string(value);
  return text ? text : "";
}

void add(AravisStream::Counts* sum, const AravisStream::Counts& more) {
  sum->incomplete += more.incomplete;
  sum->misfits += more.misfits;
  sum->stale += more.stale;
  sum->copied += more.copied;
  sum->lent += more.lent;
  sum->underruns += more.underruns;
  sum->resent_packets += more.resent_packets;
  sum->missing_packets += more.missing_packets;
}

GstStructure* stats(Source& source) {
  const Lock lock(source.mutex);
  AravisStream::Counts counts = source.before;
  if (source.stream) add(&counts, source.stream->counts());
  return gst_structure_new(
      "lightstagearavissrc", "frames", G_TYPE_UINT64, source.frames, "incomplete", G_TYPE_UINT64,
      counts.incomplete, "missed", G_TYPE_UINT64, source.missed, "timeouts", G_TYPE_UINT64,
      source.timeouts, "underruns", G_TYPE_UINT64, counts.underruns, "misfits", G_TYPE_UINT64,
      counts.misfits, "stale", G_TYPE_UINT64, counts.stale, "lent", G_TYPE_UINT64, counts.lent,
      "copied", G_TYPE_UINT64, counts.copied, "lent-now", G_TYPE_UINT,
      source.stream ? source.stream->lent_now() : 0U, "resent-packets", G_TYPE_UINT64,
      counts.resent_packets, "missing-packets", G_TYPE_UINT64, counts.missing_packets,
      "clock-jumps", G_TYPE_UINT64, source.clock.jumps(), "clock-correction-ppm", G_TYPE_DOUBLE,
      source.clock.correction_ppm(), nullptr);
}

void get_property(GObject* object, guint id, GValue* value, GParamSpec* spec) {
  Source& source = source_of(object);
  if (id == PROP_STATS) return g_value_take_boxed(value, stats(source));
  const Lock lock(source.mutex);
  switch (id) {
    case PROP_CAMERA_NAME:
      return g_value_set_string(value, source.camera_name.c_str());
    case PROP_CAMERA:
      return g_value_set_object(value, source.camera ? source.camera->get() : nullptr);
    case PROP_EXPOSURE:
      return g_value_set_double(value, source.settings.exposure);
    case PROP_GAIN:
      return g_value_set_double(value, source.settings.gain);
    case PROP_FEATURES:
      return g_value_set_string(value, source.settings.features.c_str());
    case PROP_PACKET_SIZE:
      return g_value_set_uint(value, source.settings.packet_size);
    case PROP_TRIGGER_SOURCE:
      return g_value_set_string(value, source.settings.trigger_source.c_str());
    case PROP_NUM_BUFFERS_QUEUED:
      return g_value_set_uint(value, source.buffers);
    case PROP_TIMEOUT:
      return g_value_set_uint(value, source.timeout);
    case PROP_FRAME_ID_BITS:
      return g_value_set_uint(value, source.id_bits);
    default:
      G_OBJECT_WARN_INVALID_PROPERTY_ID(object, id, spec);
  }
}

/// Sends a value that can change while frames come to the camera, if it is there.
template <typename Send>
void set_live(GObject* object, Send send) {
  std::shared_ptr<AravisCamera> camera;
  {
    const Lock lock(source_of(object).mutex);
    camera = source_of(object).camera;
  }
  if (!camera) return;
  try {
    send(*camera);
  } catch (const Error& error) {
    GST_ELEMENT_WARNING(object, RESOURCE, SETTINGS, ("%s", error.what()), (nullptr));
  }
}

void set_property(GObject* object, guint id, const GValue* value, GParamSpec* spec) {
  Source& source = source_of(object);
  Lock lock(source.mutex);
  switch (id) {
    case PROP_CAMERA_NAME:
      source.camera_name = text_of(value);
      break;
    case PROP_EXPOSURE: {
      const double exposure = source.settings.exposure = g_value_get_double(value);
      lock.unlock();
      if (exposure >= 0) set_live(object, [&](auto& camera) { camera.set_exposure(exposure); });
      break;
    }
    case PROP_GAIN: {
      const double gain = source.settings.gain = g_value_get_double(value);
      lock.unlock();
      if (gain >= 0) set_live(object, [&](auto& camera) { camera.set_gain(gain); });
      break;
    }
    case PROP_FEATURES:
      source.settings.features = text_of(value);
      break;
    case PROP_PACKET_SIZE:
      source.settings.packet_size = g_value_get_uint(value);
      break;
    case PROP_TRIGGER_SOURCE:
      source.settings.trigger_source = text_of(value);
      break;
    case PROP_NUM_BUFFERS_QUEUED:
      source.buffers = g_value_get_uint(value);
      break;
    case PROP_TIMEOUT:
      source.timeout = g_value_get_uint(value);
      break;
    default:
      G_OBJECT_WARN_INVALID_PROPERTY_ID(object, id, spec);
  }
}

gboolean start(GstBaseSrc* base) {
  Source& source = source_of(base);
  return guarded(GST_ELEMENT(base), [&] {
    std::string name;
    {
      const Lock lock(source.mutex);
      name = source.camera_name;
      source.flushing = source.lost = false;
    }
    auto camera = std::make_shared<AravisCamera>(name, [kept = shared(base)] {
      const Lock lock(kept->mutex);
      kept->lost = true;
      kept->news.notify_all();
    });
    const uint32_t bits = camera->frame_id_bits();
    GstCaps* reference =
        camera->has_shared_clock()
            ? gst_caps_new_simple("timestamp/x-ptp", "version", G_TYPE_STRING, "IEEE1588-2008",
                                  "domain", G_TYPE_INT, 0, nullptr)
            : gst_caps_new_simple("timestamp/x-camera", "camera", G_TYPE_STRING,
                                  camera->name().c_str(), nullptr);
    const Lock lock(source.mutex);
    source.camera = std::move(camera);
    source.reference = reference;
    source.id_bits = bits;
    source.before = {};
    source.frames = source.missed = source.timeouts = source.told = 0;
    source.clock.reset();
    source.ids = FrameIds(bits);
  });
}

/// Ends the stream; returns what it counted. Not under the mutex: its thread may wait for that.
void end_stream(Source& source) {
  std::unique_ptr<AravisStream> stream;
  std::shared_ptr<AravisCamera> camera;
  bool lost;
  {
    const Lock lock(source.mutex);
    stream = std::move(source.stream);
    camera = source.camera;
    lost = source.lost;
    if (stream) add(&source.before, stream->counts());
  }
  // What a camera that is gone does not hear has not to be waited for.
  if (camera && !lost) camera->stop();
}

gboolean stop(GstBaseSrc* base) {
  Source& source = source_of(base);
  end_stream(source);
  std::shared_ptr<AravisCamera> camera;  // closed after the lock: that joins threads that take it
  const Lock lock(source.mutex);
  camera = std::move(source.camera);
  source.id_bits = 0;
  gst_clear_caps(&source.reference);
  return TRUE;
}

/// The camera, and whether somebody triggers it.
std::pair<std::shared_ptr<AravisCamera>, bool> camera_of(Source& source) {
  const Lock lock(source.mutex);
  return {source.camera, !source.settings.trigger_source.empty()};
}

GstCaps* get_caps(GstBaseSrc* base, GstCaps* filter) {
  const auto [camera, triggered] = camera_of(source_of(base));
  GstCaps* caps = nullptr;
  if (camera && !guarded(GST_ELEMENT(base), [&, &camera = camera, triggered = triggered] {
        caps = camera->caps(triggered);
      }))
    caps = gst_caps_new_empty();
  if (!caps) caps = gst_pad_get_pad_template_caps(base->srcpad);
  if (!filter) return caps;
  GstCaps* both = gst_caps_intersect_full(filter, caps, GST_CAPS_INTERSECT_FIRST);
  gst_caps_unref(caps);
  return both;
}

GstCaps* fixate(GstBaseSrc* base, GstCaps* caps) {
  const auto [camera, triggered] = camera_of(source_of(base));
  return camera ? camera->fixate(caps, triggered) : gst_caps_fixate(caps);
}

gboolean set_caps(GstBaseSrc* base, GstCaps* caps) {
  Source& source = source_of(base);
  end_stream(source);
  return guarded(GST_ELEMENT(base), [&] {
    std::shared_ptr<AravisCamera> camera;
    CameraSettings settings;
    guint buffers;
    {
      const Lock lock(source.mutex);
      camera = source.camera;
      settings = source.settings;
      buffers = source.buffers;
    }
    if (!camera) throw Error(ErrorKind::internal, "caps before the camera is open");
    if (settings.exposure >= 0) camera->set_exposure(settings.exposure);
    if (settings.gain >= 0) camera->set_gain(settings.gain);
    const FrameLayout layout = camera->configure(caps, settings);
    auto stream = std::make_unique<AravisStream>(*camera, layout, buffers, [&source] {
      const Lock lock(source.mutex);
      source.news.notify_all();
    });
    {
      const Lock lock(source.mutex);
      source.layout = layout;
      source.stream = std::move(stream);
    }
    camera->start();
    gst_element_post_message(GST_ELEMENT(base), gst_message_new_latency(GST_OBJECT(base)));
  });
}

/// Says what there is where downstream takes none of it.
gboolean negotiate(GstBaseSrc* base) {
  if (GST_BASE_SRC_CLASS(parent_class)->negotiate(base)) return TRUE;
  GstCaps* own = get_caps(base, nullptr);
  GstCaps* wanted = gst_pad_peer_query_caps(base->srcpad, nullptr);
  if (wanted && !gst_caps_is_empty(own) && !gst_caps_can_intersect(own, wanted)) {
    gchar* has = gst_caps_to_string(own);
    gchar* asked = gst_caps_to_string(wanted);
    GST_ELEMENT_ERROR(base, STREAM, FORMAT,
                      ("the camera has no such frames as are asked for; it has %s", has),
                      ("asked for: %s", asked));
    g_free(has);
    g_free(asked);
  }
  gst_clear_caps(&wanted);
  gst_caps_unref(own);
  return FALSE;
}

gboolean unlock(GstBaseSrc* base) {
  const Lock lock(source_of(base).mutex);
  source_of(base).flushing = true;
  source_of(base).news.notify_all();
  return TRUE;
}

gboolean unlock_stop(GstBaseSrc* base) {
  const Lock lock(source_of(base).mutex);
  source_of(base).flushing = false;
  return TRUE;
}

/// Running time now; −1 without a clock.
int64_t running_time(GstElement* element) {
  GstClock* clock = gst_element_get_clock(element);
  if (!clock) return -1;
  const auto now = static_cast<int64_t>(gst_clock_get_time(clock) - element->base_time);
  gst_object_unref(clock);
  return now;
}

/// The time of frames without one of their own is when they came.
GstBuffer* finish(GstElement* element, Source& source, const CameraFrame& frame, int64_t now) {
  const int64_t arrival = std::max<int64_t>(now - frame.age, 0);
  GstBuffer* buffer = frame.pixels;
  if (now >= 0) {
    const int64_t time = frame.camera_time ? source.clock.map(frame.camera_time, arrival) : arrival;
    GST_BUFFER_PTS(buffer) = static_cast<GstClockTime>(time);
  }
  if (source.layout.frame_rate > 0)
    GST_BUFFER_DURATION(buffer) =
        static_cast<GstClockTime>(GST_SECOND / source.layout.frame_rate + 0.5);
  GST_BUFFER_OFFSET(buffer) = frame.id;
  GST_BUFFER_OFFSET_END(buffer) = GST_BUFFER_OFFSET_NONE;
  if (frame.camera_time)
    gst_buffer_add_reference_timestamp_meta(buffer, source.reference, frame.camera_time,
                                            GST_CLOCK_TIME_NONE);
  if (source.id_bits < 64 && frame.id > 65535) {  // so it counts further, after all
    source.id_bits = 64;
    source.ids = FrameIds(64);
  }
  const uint64_t missed = source.ids.missed_before(frame.id);
  source.missed += missed;
  ++source.frames;
  if (missed)
    GST_INFO_OBJECT(element,
                    "%" G_GUINT64_FORMAT " frames missing before number %" G_GUINT64_FORMAT, missed,
                    frame.id);
  return buffer;
}

/// Tells the user when frames get lost on the way, and again each time there are ten times as many.
void tell_incomplete(GstElement* element, Source& source, Lock& lock, const std::string& name) {
  const auto counts = source.stream->counts();
  const uint64_t bad = source.before.incomplete + counts.incomplete + counts.misfits;
  // The first one may be: Aravis asks for a buffer of the frames' size when it has come.
  if (bad < std::max<uint64_t>(source.told, 2)) return;
  source.told = 10 * bad;
  const uint64_t good = source.frames;
  lock.unlock();
  GST_ELEMENT_WARNING(
      element, RESOURCE, READ,
      ("%" G_GUINT64_FORMAT " frames of the camera %s did not come whole (%" G_GUINT64_FORMAT
       " did)",
       bad, name.c_str(), good),
      ("lower the frame rate or the size, or raise net.core.rmem_max and the packet size"));
  lock.lock();
}

GstFlowReturn create(GstPushSrc* push, GstBuffer** buffer) {
  auto* element = GST_ELEMENT(push);
  Source& source = source_of(push);
  GstFlowReturn flow = GST_FLOW_ERROR;
  guarded(element, [&] {
    using Time = std::chrono::steady_clock;
    Lock lock(source.mutex);
    const std::string name = source.camera ? source.camera->name() : "";
    const auto began = Time::now();
    auto quiet_since = began;
    for (;;) {
      if (source.flushing) {
        flow = GST_FLOW_FLUSHING;
        return;
      }
      if (source.lost || !source.stream)
        throw Error(ErrorKind::connection,
                    "the camera " + name +
                        " does not answer any more: look at its cable and its power, then start "
                        "again");
      const int64_t now = running_time(element);
      const GstClockTime since = gst_element_get_start_time(element);
      const auto stale = [&](int64_t age) {  // came while nobody played
        return now >= 0 &&
               now - age < (GST_CLOCK_TIME_IS_VALID(since) ? static_cast<int64_t>(since) : 0);
      };
      const auto frame = source.stream->take(stale);
      tell_incomplete(element, source, lock, name);
      if (frame) {
        *buffer = finish(element, source, *frame, now);
        flow = GST_FLOW_OK;
        return;
      }
      if (source.flushing || source.lost) continue;
      if (source.timeout == 0) {
        source.news.wait(lock);
        continue;
      }
      // Slow cameras have the time of three frames.
      const double rate = source.layout.frame_rate;
      const auto patience = std::chrono::duration_cast<Time::duration>(
          std::chrono::duration<double>(std::max(source.timeout * 1e-3, rate > 0 ? 3 / rate : 0)));
      if (Time::now() < quiet_since + patience) {
        source.news.wait_until(lock, quiet_since + patience);
        continue;
      }
      ++source.timeouts;
      if (source.settings.trigger_source.empty()) {
        const double seconds = std::chrono::duration<double>(Time::now() - began).count();
        throw Error(ErrorKind::connection,
                    "no frame came from the camera " + name + " in " + std::to_string(seconds) +
                        " seconds: is it connected, and does it run without a trigger? (timeout "
                        "sets the time, trigger-source says that it is triggered)");
      }
      // Nobody may have triggered it: that is no error. That it is gone is one.
      quiet_since = Time::now();
      const auto camera = source.camera;
      lock.unlock();
      const bool there = camera->answers();
      lock.lock();
      source.lost = source.lost || !there;
    }
  });
  return flow;
}

gboolean query(GstBaseSrc* base, GstQuery* asked) {
  if (GST_QUERY_TYPE(asked) != GST_QUERY_LATENCY)
    return GST_BASE_SRC_CLASS(parent_class)->query(base, asked);
  Source& source = source_of(base);
  const Lock lock(source.mutex);
  // A frame is stamped when it begins and is there when it ends.
  const double time = source.layout.frame_time;
  const auto frame = static_cast<GstClockTime>(time * GST_SECOND);
  gst_query_set_latency(asked, TRUE, frame, frame ? frame * source.buffers : GST_CLOCK_TIME_NONE);
  return TRUE;
}

void finalize(GObject* object) {
  delete static_cast<GstLightStageAravisSrc*>(static_cast<gpointer>(object))->source;
  G_OBJECT_CLASS(parent_class)->finalize(object);
}

void install(GObjectClass* object) {
  const int base = G_PARAM_READWRITE | G_PARAM_STATIC_STRINGS;
  const auto fixed = static_cast<GParamFlags>(base | GST_PARAM_MUTABLE_READY);
  const auto live = static_cast<GParamFlags>(base | GST_PARAM_MUTABLE_PLAYING);
  const auto readable = static_cast<GParamFlags>(G_PARAM_READABLE | G_PARAM_STATIC_STRINGS);
  const auto put = [&](guint id, GParamSpec* spec) {
    g_object_class_install_property(object, id, spec);
  };
  put(PROP_CAMERA_NAME,
      g_param_spec_string(
          "camera-name", "camera name",
          "The camera, as arv-tool-0.8 lists it; empty: the first one that is found", "", fixed));
  put(PROP_CAMERA,
      g_param_spec_object("camera", "camera",
                          "The open ArvCamera, for those who want to trigger it; null before READY "
                          "is left",
                          ARV_TYPE_CAMERA, readable));
  put(PROP_EXPOSURE,
      g_param_spec_double("exposure", "exposure", "Exposure time in µs; -1: as the camera has it",
                          -1, 1e8, -1, live));
  put(PROP_GAIN, g_param_spec_double("gain", "gain",
                                     "Gain in the camera's unit (mostly dB); -1: as the camera "
                                     "has it",
                                     -1, 500, -1, live));
  put(PROP_FEATURES,
      g_param_spec_string("features", "features",
                          "More of the camera's features, \"Name=Value Command\", set after all "
                          "else and before it starts",
                          "", fixed));
  put(PROP_PACKET_SIZE, g_param_spec_uint("packet-size", "packet size",
                                          "Bytes of a GigE Vision camera's packets; 0: as it is. "
                                          "Networks with jumbo frames take 9000",
                                          0, 65535, 0, fixed));
  put(PROP_TRIGGER_SOURCE,
      g_param_spec_string("trigger-source", "trigger source",
                          "What triggers each frame, by the camera's names: Software, Line0 …; "
                          "empty: it runs at the caps' frame rate",
                          "", fixed));
  put(PROP_NUM_BUFFERS_QUEUED,
      g_param_spec_uint("num-buffers-queued", "num buffers queued",
                        "Frames for which the camera has memory. Half of them can be held "
                        "downstream; further ones are copied",
                        4, 1024, 16, fixed));
  put(PROP_TIMEOUT,
      g_param_spec_uint("timeout", "timeout",
                        "Milliseconds without a complete frame after which it is an error (three "
                        "frames at least; without an error where frames are triggered and the "
                        "camera still answers); 0: never",
                        0, 3600000, 2000, live));
  put(PROP_FRAME_ID_BITS,
      g_param_spec_uint("frame-id-bits", "frame id bits",
                        "Bits of the camera's frame ids, which are the buffers' offsets: 16 go on "
                        "from 65535 to 1, 64 do not end; 0: no camera is open",
                        0, 64, 0, readable));
  put(PROP_STATS,
      g_param_spec_boxed(
          "stats", "stats",
          "Since READY was left: frames (count), incomplete (lost packets), missed (by the ids), "
          "timeouts, underruns (no memory was free), misfits (not as the caps say), stale (came "
          "while nobody played), lent, copied, lent-now, resent-packets, missing-packets, "
          "clock-jumps, clock-correction-ppm (the camera's clock to the pipeline's)",
          GST_TYPE_STRUCTURE, readable));
}

void class_init(gpointer klass, gpointer) {
  parent_class = g_type_class_peek_parent(klass);
  auto* object = G_OBJECT_CLASS(klass);
  object->get_property = get_property;
  object->set_property = set_property;
  object->finalize = finalize;
  install(object);
  auto* element = GST_ELEMENT_CLASS(klass);
  gst_element_class_set_static_metadata(
      element, "Light stage camera", "Source/Video/Hardware",
      "Frames of a GigE Vision or USB3 Vision camera with the camera's own numbers and times",
      "the gst-inverse authors");
  GstCaps* caps = gst_caps_from_string(
      "video/x-raw, format=(string){ GRAY8, GRAY16_LE, RGB, RGBA, BGR, BGRA, UYVY, YUY2 }, "
      "width=[1,max], height=[1,max], framerate=(fraction)[0/1,max]; "
      "video/x-bayer, format=(string){ bggr, rggb, grbg, gbrg }, "
      "width=[1,max], height=[1,max], framerate=(fraction)[0/1,max]");
  gst_element_class_add_pad_template(
      element, gst_pad_template_new("src", GST_PAD_SRC, GST_PAD_ALWAYS, caps));
  gst_caps_unref(caps);
  auto* base = GST_BASE_SRC_CLASS(klass);
  base->start = start;
  base->stop = stop;
  base->get_caps = get_caps;
  base->fixate = fixate;
  base->set_caps = set_caps;
  base->negotiate = negotiate;
  base->unlock = unlock;
  base->unlock_stop = unlock_stop;
  base->query = query;
  GST_PUSH_SRC_CLASS(klass)->create = create;
}

void instance_init(GTypeInstance* instance, gpointer) {
  reinterpret_cast<GstLightStageAravisSrc*>(instance)->source =
      new std::shared_ptr<Source>(std::make_shared<Source>());
  gst_base_src_set_live(GST_BASE_SRC(instance), TRUE);
  gst_base_src_set_format(GST_BASE_SRC(instance), GST_FORMAT_TIME);
}

GType source_type() {
  static const GType type = [] {
    GTypeInfo info{};
    info.class_size = sizeof(GstLightStageAravisSrcClass);
    info.class_init = class_init;
    info.instance_size = sizeof(GstLightStageAravisSrc);
    info.instance_init = instance_init;
    return g_type_register_static(GST_TYPE_PUSH_SRC, "GstLightStageAravisSrc", &info,
                                  static_cast<GTypeFlags>(0));
  }();
  return type;
}

}  // namespace

gboolean register_lightstagearavissrc(GstPlugin* plugin);
gboolean register_lightstagearavissrc(GstPlugin* plugin) {
  return gst_element_register(plugin, "lightstagearavissrc", GST_RANK_NONE, source_type());
}

}  // namespace inverse
