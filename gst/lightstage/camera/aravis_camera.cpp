// SPDX-License-Identifier: LGPL-2.1-or-later
#include "aravis_camera.hpp"

#include <gst/video/video.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "common/error.hpp"

namespace inverse {
namespace {

struct GFree {
  void operator()(void* memory) const { g_free(memory); }
};
template <typename T>
using Owned = std::unique_ptr<T, GFree>;

/// "Basler-21237813, Aravis-Fake-1"
std::string cameras_there() {
  arv_update_device_list();
  std::string list;
  for (unsigned i = 0; i < arv_get_n_devices(); ++i)
    list += (i ? ", " : "") + std::string(arv_get_device_id(i));
  return list.empty() ? "there is none; is it connected, and in the same subnet?"
                      : "there are: " + list;
}

/// GStreamer's caps for a pixel format; null if there are none, also for formats of Aravis whose
/// bits are packed in another way than GStreamer's.
GstStructure* structure_of(ArvPixelFormat format) {
  const char* text = arv_pixel_format_to_gst_caps_string(format);
  GstStructure* structure = text ? gst_structure_from_string(text, nullptr) : nullptr;
  if (!structure) return nullptr;
  const uint32_t bits = ARV_PIXEL_FORMAT_BIT_PER_PIXEL(format);
  uint32_t wanted = 8;  // Bayer
  if (gst_structure_has_name(structure, "video/x-raw")) {
    const char* name = gst_structure_get_string(structure, "format");
    const auto* info = gst_video_format_get_info(gst_video_format_from_string(name ? name : ""));
    // A subsampled pixel has half of the stride of two.
    wanted = info && info->format > GST_VIDEO_FORMAT_ENCODED
                 ? 8 * static_cast<uint32_t>(info->pixel_stride[0])
                 : 0;
  }
  if (bits == wanted) return structure;
  gst_structure_free(structure);
  return nullptr;
}

/// Significant bits of a 16-bit format.
uint32_t depth_of(ArvPixelFormat format) {
  switch (format) {
    case ARV_PIXEL_FORMAT_MONO_10:
      return 10;
    case ARV_PIXEL_FORMAT_MONO_12:
      return 12;
    case ARV_PIXEL_FORMAT_MONO_14:
      return 14;
    default:
      return 16;
  }
}

void set_range(GstStructure* structure, const char* field, int low, int high, int step) {
  low = std::max(low, 1);
  if (step > 1 && low % step == 0 && high - high % step > low) {
    GValue range = G_VALUE_INIT;
    g_value_init(&range, GST_TYPE_INT_RANGE);
    gst_value_set_int_range_step(&range, low, high - high % step, step);
    gst_structure_take_value(structure, field, &range);
  } else if (low < high) {
    gst_structure_set(structure, field, GST_TYPE_INT_RANGE, low, high, nullptr);
  } else {
    gst_structure_set(structure, field, G_TYPE_INT, low, nullptr);
  }
}

/// Numerator and denominator with three decimals; rates above a million make no sense to GStreamer.
std::pair<int, int> fraction(double rate) {
  int numerator = 0, denominator = 1;
  gst_util_double_to_fraction(std::clamp(rate, 0.0, 1e6), &numerator, &denominator);
  return {numerator, std::max(denominator, 1)};
}

}  // namespace

void AravisError::check(const std::string& what) const {
  if (!error_) return;
  const bool unreachable = is(ARV_DEVICE_ERROR_TIMEOUT) || is(ARV_DEVICE_ERROR_NOT_CONNECTED) ||
                           is(ARV_DEVICE_ERROR_TRANSFER_ERROR) ||
                           is(ARV_DEVICE_ERROR_NOT_CONTROLLER);
  throw Error(unreachable ? ErrorKind::connection : ErrorKind::unsupported, what + ": " + text());
}

std::mutex& mutex_of(ArvCamera* camera) {
  static std::mutex making;
  static const GQuark quark = g_quark_from_static_string("inverse-camera-mutex");
  const std::lock_guard lock(making);
  auto* mutex = static_cast<std::mutex*>(g_object_get_qdata(G_OBJECT(camera), quark));
  if (!mutex) {
    mutex = new std::mutex;
    g_object_set_qdata_full(G_OBJECT(camera), quark, mutex,
                            [](gpointer data) { delete static_cast<std::mutex*>(data); });
  }
  return *mutex;
}

AravisCamera::AravisCamera(const std::string& name, std::function<void()> lost) : name_(name) {
  if (name.rfind("Fake_", 0) == 0) arv_enable_interface("Fake");  // Aravis' own, in the process
  AravisError error;
  camera_ =
      ObjectRef<ArvCamera>(arv_camera_new(name.empty() ? nullptr : name.c_str(), error.out()));
  const std::string called = name.empty() ? "a camera" : "the camera " + name;
  if (!camera_ && (error.none() || error.is(ARV_DEVICE_ERROR_NOT_FOUND)))
    throw Error(ErrorKind::no_device, "cannot find " + called + "; " + cameras_there());
  if (!camera_)
    throw Error(ErrorKind::connection, "cannot open " + called + ": " + error.text() +
                                           "; is it in use by another program?");
  if (name.empty()) {
    const char* id = arv_camera_get_device_id(get(), error.out());
    name_ = id && *id ? id : "the first camera";
  }
  ArvDevice* device = arv_camera_get_device(get());
  if (ARV_IS_GV_DEVICE(device) && !arv_gv_device_is_controller(ARV_GV_DEVICE(device)))
    throw Error(ErrorKind::connection,
                "the camera " + name_ +
                    " is in use by another program: close that (the camera waits some seconds "
                    "for one that was killed)");
  // The signal has its own copy: it may be emitted during destruction.
  using Lost = std::function<void()>;
  lost_handler_ = g_signal_connect_data(
      device, "control-lost", G_CALLBACK(+[](ArvDevice*, Lost* call) { (*call)(); }),
      new Lost(std::move(lost)), [](gpointer call, GClosure*) { delete static_cast<Lost*>(call); },
      static_cast<GConnectFlags>(0));
  // As root, Aravis reads packets below the network's layers, which does not work on loopback.
  if (ARV_IS_GV_DEVICE(device)) {
    GInetAddress* address = g_inet_socket_address_get_address(
        G_INET_SOCKET_ADDRESS(arv_gv_device_get_device_address(ARV_GV_DEVICE(device))));
    if (g_inet_address_get_is_loopback(address))
      arv_camera_gv_set_stream_options(get(), ARV_GV_STREAM_OPTION_PACKET_SOCKET_DISABLED);
  }
}

AravisCamera::~AravisCamera() {
  stop();
  if (lost_handler_) g_signal_handler_disconnect(arv_camera_get_device(get()), lost_handler_);
}

bool AravisCamera::has(const char* feature) const {
  return arv_camera_is_feature_available(get(), feature, nullptr);
}

GstCaps* AravisCamera::caps(bool triggered) const {
  const std::lock_guard lock(mutex_of(get()));
  AravisError error;
  int low_width = 0, high_width = 0, low_height = 0, high_height = 0;
  arv_camera_get_width_bounds(get(), &low_width, &high_width, error.out());
  error.check("cannot read the width of the camera " + name_);
  arv_camera_get_height_bounds(get(), &low_height, &high_height, error.out());
  error.check("cannot read the height of the camera " + name_);
  if (high_width < 1 || high_height < 1)
    throw Error(ErrorKind::unsupported, "the camera " + name_ + " reports frames of " +
                                            std::to_string(high_width) + "x" +
                                            std::to_string(high_height));
  const int step_width = arv_camera_get_width_increment(get(), nullptr);
  const int step_height = arv_camera_get_height_increment(get(), nullptr);
  double slowest = 0, fastest = 0;
  if (arv_camera_is_frame_rate_available(get(), nullptr))
    arv_camera_get_frame_rate_bounds(get(), &slowest, &fastest, nullptr);

  guint count = 0;
  Owned<gint64> formats(arv_camera_dup_available_pixel_formats(get(), &count, error.out()));
  error.check("cannot read the pixel formats of the camera " + name_);
  GstCaps* caps = gst_caps_new_empty();
  for (guint i = 0; i < count; ++i) {
    GstStructure* structure = structure_of(static_cast<ArvPixelFormat>(formats.get()[i]));
    if (!structure) continue;
    set_range(structure, "width", low_width, high_width, step_width);
    set_range(structure, "height", low_height, high_height, step_height);
    const auto [low, low_denominator] = fraction(triggered ? 0 : slowest);
    const auto [high, high_denominator] = fraction(fastest);
    if (fastest > slowest && high > 0)
      gst_structure_set(structure, "framerate", GST_TYPE_FRACTION_RANGE, low, low_denominator, high,
                        high_denominator, nullptr);
    else
      gst_structure_set(structure, "framerate", GST_TYPE_FRACTION_RANGE, 0, 1, G_MAXINT, 1,
                        nullptr);
    gst_caps_append_structure(caps, structure);
  }
  caps = gst_caps_simplify(caps);
  if (!gst_caps_is_empty(caps)) return caps;
  gst_caps_unref(caps);
  std::string list;
  Owned<const char*> names(
      arv_camera_dup_available_pixel_formats_as_strings(get(), &count, nullptr));
  for (guint i = 0; names && i < count; ++i) list += (i ? ", " : "") + std::string(names.get()[i]);
  throw Error(
      ErrorKind::unsupported,
      "the camera " + name_ + " has no pixel format that GStreamer supports; it has: " + list);
}

GstCaps* AravisCamera::fixate(GstCaps* caps, bool triggered) const {
  const std::lock_guard lock(mutex_of(get()));
  caps = gst_caps_make_writable(caps);
  // The camera's own format, if it is among them.
  if (GstStructure* own = structure_of(arv_camera_get_pixel_format(get(), nullptr))) {
    for (guint i = 0; i < gst_caps_get_size(caps); ++i) {
      GstStructure* structure = gst_caps_get_structure(caps, i);
      if (!gst_structure_can_intersect(structure, own)) continue;
      const char* format = gst_structure_get_string(own, "format");
      structure = gst_structure_copy(structure);
      gst_structure_set(structure, "format", G_TYPE_STRING, format, nullptr);
      gst_caps_unref(caps);
      caps = gst_caps_new_full(structure, nullptr);
      break;
    }
    gst_structure_free(own);
  }
  caps = gst_caps_truncate(caps);
  GstStructure* structure = gst_caps_get_structure(caps, 0);
  int width = 0, height = 0;
  arv_camera_get_region(get(), nullptr, nullptr, &width, &height, nullptr);
  gst_structure_fixate_field_nearest_int(structure, "width", width);
  gst_structure_fixate_field_nearest_int(structure, "height", height);
  double rate = 0;
  if (!triggered && arv_camera_is_frame_rate_available(get(), nullptr))
    rate = arv_camera_get_frame_rate(get(), nullptr);
  const auto [numerator, denominator] = fraction(rate);
  gst_structure_fixate_field_nearest_fraction(structure, "framerate", numerator, denominator);
  return gst_caps_fixate(caps);
}

FrameLayout AravisCamera::configure(const GstCaps* caps, const CameraSettings& settings) {
  const std::lock_guard lock(mutex_of(get()));
  const GstStructure* wanted = gst_caps_get_structure(caps, 0);
  FrameLayout layout;
  int width = 0, height = 0;
  gst_structure_get_int(wanted, "width", &width);
  gst_structure_get_int(wanted, "height", &height);

  // Several formats of a camera can have the same caps (10, 12 and 16 bits): the current one, or
  // else the deepest.
  AravisError error;
  guint count = 0;
  Owned<gint64> formats(arv_camera_dup_available_pixel_formats(get(), &count, error.out()));
  error.check("cannot read the pixel formats of the camera " + name_);
  const ArvPixelFormat now = arv_camera_get_pixel_format(get(), nullptr);
  const char* wanted_format = gst_structure_get_string(wanted, "format");
  for (guint i = 0; i < count; ++i) {
    const auto format = static_cast<ArvPixelFormat>(formats.get()[i]);
    GstStructure* own = structure_of(format);
    if (!own) continue;
    const bool fits = gst_structure_has_name(own, gst_structure_get_name(wanted)) &&
                      g_strcmp0(gst_structure_get_string(own, "format"), wanted_format) == 0;
    gst_structure_free(own);
    if (fits && layout.pixel_format != now &&
        (!layout.pixel_format || format == now || depth_of(format) > depth_of(layout.pixel_format)))
      layout.pixel_format = format;
  }
  if (!layout.pixel_format)
    throw Error(ErrorKind::unsupported, "the camera " + name_ + " has no such pixel format as " +
                                            (wanted_format ? wanted_format : "none"));

  const std::string cannot = "the camera " + name_ + " does not take ";
  arv_camera_set_pixel_format(get(), layout.pixel_format, error.out());
  error.check(cannot + "the pixel format " + wanted_format);
  int x = 0, y = 0, was_width = 0, was_height = 0;
  arv_camera_get_region(get(), &x, &y, &was_width, &was_height, error.out());
  error.check("cannot read the region of the camera " + name_);
  if (was_width != width || was_height != height) {
    arv_camera_set_region(get(), x, y, width, height, error.out());
    error.check(cannot + "frames of " + std::to_string(width) + "x" + std::to_string(height));
  }
  int numerator = 0, denominator = 1;
  gst_structure_get_fraction(wanted, "framerate", &numerator, &denominator);
  layout.frame_rate = denominator > 0 ? static_cast<double>(numerator) / denominator : 0;
  double slowest = 0, fastest = layout.frame_rate;
  if (fastest <= 0 && arv_camera_is_frame_rate_available(get(), nullptr))
    arv_camera_get_frame_rate_bounds(get(), &slowest, &fastest, nullptr);
  layout.frame_time = fastest > 0 ? 1 / fastest : 0;
  if (!settings.trigger_source.empty()) {
    if (settings.trigger_source == "Software" &&
        !arv_camera_is_software_trigger_supported(get(), nullptr))
      throw Error(ErrorKind::unsupported,
                  "the camera " + name_ + " has no software trigger; wire one of its lines");
    arv_camera_set_trigger(get(), settings.trigger_source.c_str(), error.out());
    error.check(cannot + "the trigger " + settings.trigger_source);
  } else if (layout.frame_rate > 0 && arv_camera_is_frame_rate_available(get(), nullptr)) {
    arv_camera_set_frame_rate(get(), layout.frame_rate, error.out());
    error.check(cannot + "a frame rate of " + std::to_string(layout.frame_rate));
  }
  if (settings.packet_size && arv_camera_is_gv_device(get())) {
    arv_camera_gv_set_packet_size(get(), static_cast<gint>(settings.packet_size), error.out());
    error.check(cannot + "packets of " + std::to_string(settings.packet_size) + " bytes");
  }
  if (!settings.features.empty()) {
    arv_device_set_features_from_string(arv_camera_get_device(get()), settings.features.c_str(),
                                        error.out());
    error.check(cannot + "features=\"" + settings.features + "\"");
  }
  // `features` may have set another region than the caps.
  arv_camera_get_region(get(), nullptr, nullptr, &was_width, &was_height, error.out());
  error.check("cannot read the region of the camera " + name_);
  if (was_width != width || was_height != height ||
      arv_camera_get_pixel_format(get(), nullptr) != layout.pixel_format)
    throw Error(ErrorKind::unsupported,
                "the camera " + name_ + " made frames of " + std::to_string(width) + "x" +
                    std::to_string(height) + " in " + wanted_format + " to others of " +
                    std::to_string(was_width) + "x" + std::to_string(was_height) +
                    "; say size and format by caps, not in features");
  layout.payload = arv_camera_get_payload(get(), error.out());
  error.check("cannot read how large the frames of the camera " + name_ + " are");
  layout.width = static_cast<uint32_t>(width);
  layout.height = static_cast<uint32_t>(height);
  layout.row_bytes = size_t{layout.width} * ARV_PIXEL_FORMAT_BIT_PER_PIXEL(layout.pixel_format) / 8;
  layout.stride = (layout.row_bytes + 3) / 4 * 4;
  layout.shift = 16 - depth_of(layout.pixel_format);
  if (layout.payload < layout.row_bytes * layout.height || layout.payload > (size_t{1} << 31))
    throw Error(ErrorKind::unsupported, "the camera " + name_ + " reports that a frame of " +
                                            std::to_string(width) + "x" + std::to_string(height) +
                                            " has " + std::to_string(layout.payload) + " bytes");
  return layout;
}

void AravisCamera::set_exposure(double microseconds) {
  const std::lock_guard lock(mutex_of(get()));
  if (!arv_camera_is_exposure_time_available(get(), nullptr))
    throw Error(ErrorKind::unsupported, "the camera " + name_ + " has no exposure time to set");
  double low = 0, high = 0;
  arv_camera_get_exposure_time_bounds(get(), &low, &high, nullptr);
  if (high > low && (microseconds < low || microseconds > high))
    throw Error(ErrorKind::unsupported, "exposure: the camera " + name_ + " takes " +
                                            std::to_string(low) + " to " + std::to_string(high) +
                                            " µs, not " + std::to_string(microseconds));
  AravisError error;
  if (arv_camera_is_exposure_auto_available(get(), nullptr))
    arv_camera_set_exposure_time_auto(get(), ARV_AUTO_OFF, nullptr);
  arv_camera_set_exposure_time(get(), microseconds, error.out());
  error.check("the camera " + name_ + " does not take the exposure");
}

void AravisCamera::set_gain(double gain) {
  const std::lock_guard lock(mutex_of(get()));
  if (!arv_camera_is_gain_available(get(), nullptr))
    throw Error(ErrorKind::unsupported, "the camera " + name_ + " has no gain to set");
  double low = 0, high = 0;
  arv_camera_get_gain_bounds(get(), &low, &high, nullptr);
  if (high > low && (gain < low || gain > high))
    throw Error(ErrorKind::unsupported, "gain: the camera " + name_ + " takes " +
                                            std::to_string(low) + " to " + std::to_string(high) +
                                            ", not " + std::to_string(gain));
  AravisError error;
  if (arv_camera_is_gain_auto_available(get(), nullptr))
    arv_camera_set_gain_auto(get(), ARV_AUTO_OFF, nullptr);
  arv_camera_set_gain(get(), gain, error.out());
  error.check("the camera " + name_ + " does not take the gain");
}

void AravisCamera::start() {
  const std::lock_guard lock(mutex_of(get()));
  AravisError error;
  arv_camera_start_acquisition(get(), error.out());
  error.check("the camera " + name_ + " does not start");
  sending_ = true;
}

void AravisCamera::stop() noexcept {
  if (!std::exchange(sending_, false)) return;
  const std::lock_guard lock(mutex_of(get()));
  arv_camera_stop_acquisition(get(), nullptr);  // may fail if the camera is gone
}

bool AravisCamera::answers() const {
  ArvDevice* device = arv_camera_get_device(get());
  if (ARV_IS_GV_DEVICE(device)) return arv_gv_device_is_controller(ARV_GV_DEVICE(device));
  const std::lock_guard lock(mutex_of(get()));
  AravisError error;
  arv_camera_get_region(get(), nullptr, nullptr, nullptr, nullptr, error.out());
  return error.none();
}

uint32_t AravisCamera::frame_id_bits() const {
  ArvDevice* device = arv_camera_get_device(get());
  if (ARV_IS_UV_DEVICE(device)) return 64;
  if (!ARV_IS_GV_DEVICE(device)) return 16;  // the one in the process
  // GigE Vision 2.x has both, and says which by a standard feature.
  const std::lock_guard lock(mutex_of(get()));
  if (!has("GevGVSPExtendedIDMode")) return 16;
  const char* mode = arv_camera_get_string(get(), "GevGVSPExtendedIDMode", nullptr);
  return g_strcmp0(mode, "On") == 0 ? 64 : 16;
}

bool AravisCamera::has_shared_clock() const {
  const std::lock_guard lock(mutex_of(get()));
  for (const auto& [switched_on, status] :
       {std::pair{"PtpEnable", "PtpStatus"}, std::pair{"GevIEEE1588", "GevIEEE1588Status"}}) {
    if (!has(switched_on) || !has(status) || !arv_camera_get_boolean(get(), switched_on, nullptr))
      continue;
    const char* state = arv_camera_get_string(get(), status, nullptr);
    if (g_strcmp0(state, "Slave") == 0 || g_strcmp0(state, "Master") == 0) return true;
  }
  return false;
}

}  // namespace inverse
