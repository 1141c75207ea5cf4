// SPDX-License-Identifier: LGPL-2.1-or-later
#include "camera_trigger.hpp"

#include "gst/lightstage/camera/aravis_camera.hpp"
#include "gst/lightstage/sync/shared/upstream.hpp"

namespace inverse {
namespace {

constexpr const char* kSoftware = "Software";

GParamSpec* property_of(GstElement* element, const char* name) {
  return g_object_class_find_property(G_OBJECT_GET_CLASS(element), name);
}

bool has_camera(GstElement* element) {
  const GParamSpec* spec = property_of(element, "camera");
  return spec && (spec->flags & G_PARAM_READABLE) && g_type_is_a(spec->value_type, ARV_TYPE_CAMERA);
}

}  // namespace

struct CameraTrigger::Camera {
  ObjectRef<ArvCamera> object;
};

std::unique_ptr<CameraTrigger> CameraTrigger::find(GstPad* sink) {
  GstElement* source = upstream_element(sink, has_camera);
  if (!source) {
    gchar* pad = gst_object_get_name(GST_OBJECT(sink));
    const std::string name = pad;
    g_free(pad);
    throw Error(ErrorKind::unsupported, "there is no camera to trigger upstream of " + name +
                                            ": it takes lightstagearavissrc (or aravissrc) there");
  }
  return std::unique_ptr<CameraTrigger>(new CameraTrigger(source));
}

CameraTrigger::CameraTrigger(GstElement* source)
    : source_(source), camera_(std::make_unique<Camera>()) {}

CameraTrigger::~CameraTrigger() {
  if (set_source_) g_object_set(source_, "trigger-source", "", nullptr);
  gst_object_unref(source_);
}

void CameraTrigger::prepare() {
  if (!property_of(source_, "trigger-source")) return;
  gchar* trigger = nullptr;
  g_object_get(source_, "trigger-source", &trigger, nullptr);
  const std::string set = trigger ? trigger : "";
  g_free(trigger);
  if (set.empty()) {
    g_object_set(source_, "trigger-source", kSoftware, nullptr);
    set_source_ = true;
  } else if (set != kSoftware) {
    throw Error(ErrorKind::unsupported, name() + " has trigger-source=" + set +
                                            ", so software cannot trigger it: leave that out");
  }
}

void CameraTrigger::configure() {
  ArvCamera* camera = nullptr;
  g_object_get(source_, "camera", &camera, nullptr);
  camera_->object = ObjectRef<ArvCamera>(camera);
  if (!camera) throw Error(ErrorKind::connection, "the camera of " + name() + " is not open");
  const std::lock_guard lock(mutex_of(camera));
  AravisError error;
  if (!arv_camera_is_software_trigger_supported(camera, error.out()))
    throw Error(ErrorKind::unsupported,
                "the camera of " + name() +
                    " has no software trigger; wire one of its lines to the lights' controller "
                    "and label its frames by time");
  const char* mode = arv_camera_get_string(camera, "TriggerMode", nullptr);
  const bool on = g_strcmp0(mode, "On") == 0;
  if (on && g_strcmp0(arv_camera_get_trigger_source(camera, nullptr), kSoftware) == 0) return;
  // Many cameras refuse it while they send.
  const std::string cannot = "cannot make the camera of " + name() + " wait for triggers";
  arv_camera_stop_acquisition(camera, error.out());
  error.check(cannot);
  arv_camera_set_trigger(camera, kSoftware, error.out());
  error.check(cannot);
  arv_camera_start_acquisition(camera, error.out());
  error.check(cannot);
}

void CameraTrigger::end() { gst_element_send_event(source_, gst_event_new_eos()); }

std::string CameraTrigger::name() const {
  gchar* name = gst_object_get_name(GST_OBJECT(source_));
  std::string text = name;
  g_free(name);
  return text;
}

void CameraTrigger::fire() {
  ArvCamera* camera = camera_->object.get();
  if (!camera) throw Error(ErrorKind::internal, "the camera of " + name() + " was not made ready");
  const std::lock_guard lock(mutex_of(camera));
  AravisError error;
  arv_camera_software_trigger(camera, error.out());
  error.check("the camera of " + name() + " refused the trigger");
}

uint32_t CameraTrigger::frame_id_bits() const {
  guint bits = 0;
  if (property_of(source_, "frame-id-bits")) g_object_get(source_, "frame-id-bits", &bits, nullptr);
  return bits;
}

bool CameraTrigger::has_times() const { return property_of(source_, "frame-id-bits") != nullptr; }

}  // namespace inverse
