// SPDX-License-Identifier: LGPL-2.1-or-later
// lightstagearavissrc: frames of an industrial camera with the number and the time that the camera
// gave them.
#include <gst/base/gstpushsrc.h>
#include <gst/video/video.h>

#include <memory>

#include "aravis_source.hpp"
#include "gst/base/element_class.hpp"
#include "gst/base/log/errors.hpp"
#include "gst/base/log/log.hpp"
#include "gst/base/pads/caps.hpp"

using inverse::AravisSource;

struct GstLightStageAravisSrc {
  GstPushSrc parent;
  std::shared_ptr<AravisSource>* body;  // Aravis' threads have references, too
};

namespace inverse {
namespace {

using Class = ElementClass<GstLightStageAravisSrc>;

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

AravisSource& source_of(gpointer object) { return *Class::body_of(object); }

std::string text_of(const GValue* value) {
  const char* text = g_value_get_string(value);
  return text ? text : "";
}

void get_property(GObject* object, guint id, GValue* value, GParamSpec* spec) {
  AravisSource& source = source_of(object);
  if (id == PROP_STATS) return g_value_take_boxed(value, source.stats());
  const std::lock_guard lock(source.mutex);
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

/// Sends a value that can change during capture to the camera, if it is open.
template <typename Send>
void set_live(GObject* object, Send send) {
  std::shared_ptr<AravisCamera> camera;
  {
    const std::lock_guard lock(source_of(object).mutex);
    camera = source_of(object).camera;
  }
  if (!camera) return;
  try {
    send(*camera);
  } catch (const Error& error) {
    post_warning(log_of(GST_ELEMENT(object)), GST_RESOURCE_ERROR, GST_RESOURCE_ERROR_SETTINGS, "%s",
                 error.what());
  }
}

void set_property(GObject* object, guint id, const GValue* value, GParamSpec* spec) {
  AravisSource& source = source_of(object);
  AravisSource::Lock lock(source.mutex);
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
  return guarded(GST_ELEMENT(base), [&] { source_of(base).open(); });
}

gboolean stop(GstBaseSrc* base) {
  source_of(base).close();
  return TRUE;
}

GstCaps* get_caps(GstBaseSrc* base, GstCaps* filter) {
  const auto [camera, triggered] = source_of(base).opened();
  GstCaps* caps = nullptr;
  if (camera && !guarded(GST_ELEMENT(base), [&, &camera = camera, triggered = triggered] {
        caps = camera->caps(triggered);
      }))
    caps = gst_caps_new_empty();
  if (!caps) caps = gst_pad_get_pad_template_caps(base->srcpad);
  return filter_caps(caps, filter);
}

GstCaps* fixate(GstBaseSrc* base, GstCaps* caps) {
  const auto [camera, triggered] = source_of(base).opened();
  return camera ? camera->fixate(caps, triggered) : gst_caps_fixate(caps);
}

gboolean set_caps(GstBaseSrc* base, GstCaps* caps) {
  GST_CAT_INFO_OBJECT(log_of(GST_ELEMENT(base)).category, base, "caps: %" GST_PTR_FORMAT, caps);
  source_of(base).end();
  if (!guarded(GST_ELEMENT(base), [&] { source_of(base).begin(caps); })) return FALSE;
  gst_element_post_message(GST_ELEMENT(base), gst_message_new_latency(GST_OBJECT(base)));
  return TRUE;
}

/// Reports the camera's formats if downstream accepts none of them.
gboolean negotiate(GstBaseSrc* base) {
  if (GST_BASE_SRC_CLASS(Class::parent_class)->negotiate(base)) return TRUE;
  GstCaps* own = get_caps(base, nullptr);
  GstCaps* wanted = gst_pad_peer_query_caps(base->srcpad, nullptr);
  if (wanted && !gst_caps_is_empty(own) && !gst_caps_can_intersect(own, wanted)) {
    gchar* has = gst_caps_to_string(own);
    gchar* asked = gst_caps_to_string(wanted);
    GST_ELEMENT_ERROR(base, STREAM, FORMAT,
                      ("the camera does not offer the requested format; it offers %s", has),
                      ("asked for: %s", asked));
    g_free(has);
    g_free(asked);
  }
  gst_clear_caps(&wanted);
  gst_caps_unref(own);
  return FALSE;
}

gboolean unlock(GstBaseSrc* base) {
  source_of(base).set_flushing(true);
  return TRUE;
}

gboolean unlock_stop(GstBaseSrc* base) {
  source_of(base).set_flushing(false);
  return TRUE;
}

GstFlowReturn create(GstPushSrc* push, GstBuffer** buffer) {
  GstFlowReturn flow = GST_FLOW_ERROR;
  guarded(GST_ELEMENT(push), [&] { flow = source_of(push).next(GST_ELEMENT(push), buffer); });
  return flow;
}

gboolean query(GstBaseSrc* base, GstQuery* asked) {
  if (GST_QUERY_TYPE(asked) != GST_QUERY_LATENCY)
    return GST_BASE_SRC_CLASS(Class::parent_class)->query(base, asked);
  AravisSource& source = source_of(base);
  const std::lock_guard lock(source.mutex);
  // A frame is stamped when it begins and is there when it ends.
  const double time = source.layout.frame_time;
  const auto frame = static_cast<GstClockTime>(time * GST_SECOND);
  gst_query_set_latency(asked, TRUE, frame, frame ? frame * source.buffers : GST_CLOCK_TIME_NONE);
  return TRUE;
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
      g_param_spec_string("camera-name", "camera name",
                          "Camera name, as arv-tool-0.8 lists it; empty = the first one found", "",
                          fixed));
  put(PROP_CAMERA, g_param_spec_object("camera", "camera",
                                       "The open ArvCamera, for triggering; null up to READY",
                                       ARV_TYPE_CAMERA, readable));
  put(PROP_EXPOSURE,
      g_param_spec_double("exposure", "exposure", "Exposure time in µs; -1 = the camera's setting",
                          -1, 1e8, -1, live));
  put(PROP_GAIN,
      g_param_spec_double("gain", "gain",
                          "Gain in the camera's unit (mostly dB); -1 = the camera's setting", -1,
                          500, -1, live));
  put(PROP_FEATURES,
      g_param_spec_string(
          "features", "features",
          "Other features of the camera as \"Name=Value Command\", set last before it starts", "",
          fixed));
  put(PROP_PACKET_SIZE, g_param_spec_uint("packet-size", "packet size",
                                          "Packet size of a GigE Vision camera, bytes; 0 = its "
                                          "setting, 9000 for networks with jumbo frames",
                                          0, 65535, 0, fixed));
  put(PROP_TRIGGER_SOURCE,
      g_param_spec_string("trigger-source", "trigger source",
                          "Trigger of each frame by the camera's name: Software, Line0 …; empty = "
                          "the frame rate of the caps",
                          "", fixed));
  put(PROP_NUM_BUFFERS_QUEUED,
      g_param_spec_uint(
          "num-buffers-queued", "num buffers queued",
          "Number of frame buffers; downstream can hold half of them, further frames are copied", 4,
          1024, 16, fixed));
  put(PROP_TIMEOUT,
      g_param_spec_uint(
          "timeout", "timeout",
          "Time without a complete frame that is an error, ms, at least three frames; 0 = never", 0,
          3600000, 2000, live));
  put(PROP_FRAME_ID_BITS,
      g_param_spec_uint("frame-id-bits", "frame id bits",
                        "Bits of the camera's frame ids (GST_BUFFER_OFFSET); 0 = no camera is open",
                        0, 64, 0, readable));
  put(PROP_STATS, g_param_spec_boxed("stats", "stats",
                                     "Counts of frames, losses, copies and packets, and the "
                                     "correction of the camera's clock, since READY",
                                     GST_TYPE_STRUCTURE, readable));
}

void class_init(GstElementClass* element) {
  auto* object = G_OBJECT_CLASS(element);
  object->get_property = get_property;
  object->set_property = set_property;
  install(object);
  add_pad_template(
      element, "src", GST_PAD_SRC, GST_PAD_ALWAYS,
      gst_caps_from_string(
          "video/x-raw, format=(string){ GRAY8, GRAY16_LE, RGB, RGBA, BGR, BGRA, UYVY, YUY2 }, "
          "width=[1,max], height=[1,max], framerate=(fraction)[0/1,max]; "
          "video/x-bayer, format=(string){ bggr, rggb, grbg, gbrg }, "
          "width=[1,max], height=[1,max], framerate=(fraction)[0/1,max]"));
  auto* base = GST_BASE_SRC_CLASS(element);
  base->start = start;
  base->stop = stop;
  base->get_caps = get_caps;
  base->fixate = fixate;
  base->set_caps = set_caps;
  base->negotiate = negotiate;
  base->unlock = unlock;
  base->unlock_stop = unlock_stop;
  base->query = query;
  GST_PUSH_SRC_CLASS(element)->create = create;
}

void instance_init(GstLightStageAravisSrc* self) {
  self->body = new std::shared_ptr<AravisSource>(std::make_shared<AravisSource>());
  gst_base_src_set_live(GST_BASE_SRC(self), TRUE);
  gst_base_src_set_format(GST_BASE_SRC(self), GST_FORMAT_TIME);
}

constexpr Class kClass{
    "lightstagearavissrc",
    "GstLightStageAravisSrc",
    "Light stage camera",
    "Source/Video/Hardware",
    "Frames of a GigE Vision or USB3 Vision camera with the camera's own numbers and times",
    gst_push_src_get_type,
    class_init,
    instance_init};

}  // namespace

gboolean register_lightstagearavissrc(GstPlugin* plugin);
gboolean register_lightstagearavissrc(GstPlugin* plugin) { return kClass.register_element(plugin); }

}  // namespace inverse
