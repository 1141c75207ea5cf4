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

/// Takes a GError: pass `out()` where one is asked for, then `check`.
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
  /// Throws Error(connection) if the camera did not answer, else Error(unsupported): `what` it
  /// was that failed, and why.
  void check(const std::string& what) const;

 private:
  GError* error_ = nullptr;
};

/// What may speak to a camera at a time: Aravis' own access to features is not thread-safe. One for
/// each camera, whoever holds it.
std::mutex& mutex_of(ArvCamera* camera);

/// What a camera is asked for before it sends. Empty or negative: as it is.
struct CameraSettings {
  std::string features, trigger_source;
  double exposure = -1;      ///< µs
  double gain = -1;          ///< the camera's unit
  uint32_t packet_size = 0;  ///< of GigE Vision, bytes; 0: as it is
};

/// How a camera's frames are laid out and how GStreamer wants them.
struct FrameLayout {
  ArvPixelFormat pixel_format = 0;
  uint32_t width = 0, height = 0;
  size_t row_bytes = 0;  ///< of the camera
  size_t stride = 0;     ///< of GStreamer: a multiple of 4
  /// Cameras send 10, 12 or 14 bits in the low bits of 16; white is white after this shift.
  uint32_t shift = 0;
  double frame_rate = 0;  ///< 0: frames come when they are triggered
  double frame_time = 0;  ///< seconds from a frame's begin to its end, at most; 0: not known
  size_t payload = 0;     ///< of a frame with all that comes with it, bytes
};

/// A camera of the industrial kind (GigE Vision, USB3 Vision), open and under our control.
class AravisCamera {
 public:
  /// Opens the camera of this name, the first one for an empty name. Throws Error: `no_device`
  /// that names those that are there, `connection` where another program has it.
  /// `lost` is called from another thread when the camera is gone.
  AravisCamera(const std::string& name, std::function<void()> lost);
  ~AravisCamera();
  AravisCamera(const AravisCamera&) = delete;
  AravisCamera& operator=(const AravisCamera&) = delete;

  ArvCamera* get() const { return camera_.get(); }
  const std::string& name() const { return name_; }

  /// All that it can send and GStreamer has a name for. Throws Error(unsupported) that names the
  /// camera's formats where there is nothing.
  GstCaps* caps(bool triggered) const;
  /// Fills in what caps leave open from what the camera is set to now.
  GstCaps* fixate(GstCaps* caps, bool triggered) const;
  /// Makes it send these (fixed) caps; throws Error.
  FrameLayout configure(const GstCaps* caps, const CameraSettings& settings);
  /// While it sends, too. Throws Error(unsupported) that names the range.
  void set_exposure(double microseconds);
  void set_gain(double gain);

  void start();
  void stop() noexcept;
  /// Whether it still answers; asks nothing if Aravis does by itself.
  bool answers() const;

  /// How many bits its frame ids have before they start again.
  uint32_t frame_id_bits() const;
  /// Whether its clock is one that others on the network share (IEEE 1588).
  bool has_shared_clock() const;

 private:
  bool has(const char* feature) const;

  std::string name_;
  ObjectRef<ArvCamera> camera_;
  gulong lost_handler_ = 0;
  bool sending_ = false;
};

}  // namespace inverse
