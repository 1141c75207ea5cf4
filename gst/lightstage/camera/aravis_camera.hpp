// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <arv.h>
#include <gst/gst.h>

#include <atomic>
#include <functional>
#include <mutex>
#include <optional>
#include <string>

namespace inverse {

/// Holds one reference of a GObject.
template <typename T>
class ObjectRef {
 public:
  ObjectRef() = default;
  explicit ObjectRef(T* taken) : object_(taken) {}
  ObjectRef(ObjectRef&& other) noexcept { std::swap(object_, other.object_); }
  ObjectRef& operator=(ObjectRef&& other) noexcept {
    std::swap(object_, other.object_);
    return *this;
  }
  ~ObjectRef() { reset(); }
  void reset() {
    if (object_) g_object_unref(object_);
    object_ = nullptr;
  }
  T* get() const { return object_; }
  explicit operator bool() const { return object_ != nullptr; }

 private:
  T* object_ = nullptr;
};

/// Owns a GError: pass `out()` to a call, then `check`.
class AravisError {
 public:
  AravisError() = default;
  AravisError(const AravisError&) = delete;
  AravisError& operator=(const AravisError&) = delete;
  ~AravisError() { g_clear_error(&error_); }
  GError** out() {
    g_clear_error(&error_);
    return &error_;
  }
  bool none() const { return error_ == nullptr; }
  bool is(ArvDeviceError code) const {
    return error_ && g_error_matches(error_, ARV_DEVICE_ERROR, code);
  }
  /// "Timeout while waiting for acknowledge"
  std::string text() const { return error_ ? error_->message : ""; }
  /// Throws Error(connection) if the camera did not answer, else Error(unsupported); `what` failed.
  void check(const std::string& what) const;

 private:
  GError* error_ = nullptr;
};

/// The mutex of a camera: Aravis' access to features is not thread-safe. One for each camera, for
/// all its users.
std::mutex& mutex_of(ArvCamera* camera);

/// Settings of a camera before it sends. Empty or negative: unchanged.
struct CameraSettings {
  std::string features, trigger_source;
  double exposure = -1;      ///< µs
  double gain = -1;          ///< the camera's unit
  uint32_t packet_size = 0;  ///< of GigE Vision, bytes; 0: as it is
};

/// Layout of a camera's frames, and of GStreamer's.
struct FrameLayout {
  ArvPixelFormat pixel_format = 0;
  uint32_t width = 0, height = 0;
  size_t row_bytes = 0;  ///< of the camera
  size_t stride = 0;     ///< of GStreamer: a multiple of 4
  /// Cameras send 10, 12 or 14 bits in the low bits of 16; white is white after this shift.
  uint32_t shift = 0;
  double frame_rate = 0;  ///< 0: frames are triggered
  double frame_time = 0;  ///< max seconds from a frame's begin to its end; 0: not known
  size_t payload = 0;     ///< bytes of a frame with its metadata
};

/// A camera of the industrial kind (GigE Vision, USB3 Vision), open and under our control.
class AravisCamera {
 public:
  /// Opens the camera of this name, the first one for an empty name. Throws Error: `no_device`,
  /// which names those that are there; `connection` if another program uses it. `lost` is called
  /// from another thread when the camera is gone.
  AravisCamera(const std::string& name, std::function<void()> lost);
  ~AravisCamera();
  AravisCamera(const AravisCamera&) = delete;
  AravisCamera& operator=(const AravisCamera&) = delete;

  ArvCamera* get() const { return camera_.get(); }
  const std::string& name() const { return name_; }

  /// All formats of the camera that GStreamer has. Throws Error(unsupported), which names the
  /// camera's formats, if there are none.
  GstCaps* caps(bool triggered) const;
  /// Fixates open fields of caps to the camera's current settings.
  GstCaps* fixate(GstCaps* caps, bool triggered) const;
  /// Makes it send these (fixed) caps; throws Error.
  FrameLayout configure(const GstCaps* caps, const CameraSettings& settings);
  /// While it sends, too. Throws Error(unsupported) that names the range.
  void set_exposure(double microseconds);
  void set_gain(double gain);

  void start();
  void stop() noexcept;
  /// Whether it still answers; true without asking if Aravis checks by itself.
  bool answers() const;

  /// How many bits its frame ids have before they start again.
  uint32_t frame_id_bits() const;
  /// Whether its clock is shared on the network (IEEE 1588).
  bool has_shared_clock() const;

 private:
  bool has(const char* feature) const;

  std::string name_;
  ObjectRef<ArvCamera> camera_;
  gulong lost_handler_ = 0;
  bool sending_ = false;
};

}  // namespace inverse
