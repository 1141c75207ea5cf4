// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/video/video.h>

#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>

namespace inverse {

/// A sink pad for a second stream of frames, of which each is used from its running time on, until
/// the next one's. The main stream never waits for it; frames that come early wait in their own
/// thread. After its end the last frame stays.
class TexturePad {
 public:
  struct FreeBuffer {
    void operator()(GstBuffer* buffer) const { gst_buffer_unref(buffer); }
  };
  struct Frame {
    std::unique_ptr<GstBuffer, FreeBuffer> buffer;
    GstVideoInfo info;
    GstClockTime time;  ///< running time; none: at once
  };

  /// Makes the pad, for the element to add. The pad keeps this object: it is called as long as it
  /// exists.
  static std::shared_ptr<TexturePad> create(GstElement* element, GstPadTemplate* pad_template);
  TexturePad(GstElement* element, GstPad* pad);
  GstPad* pad() const { return pad_; }

  /// The frame for this running time, if it is another one than was taken last.
  std::optional<Frame> take(GstClockTime now);

 private:
  GstFlowReturn chain(GstBuffer* buffer);
  gboolean event(GstEvent* event);
  gboolean query(GstQuery* query);
  void set_flushing(bool flushing);
  bool set_caps(GstCaps* caps);

  static constexpr size_t kMaxWaiting = 3;  // frames
  GstElement* element_;
  GstPad* const pad_;  // owns this
  std::mutex mutex_;
  std::condition_variable taken_;
  std::deque<Frame> waiting_;
  bool flushing_ = true;
  GstVideoInfo info_;   // of the streaming thread
  GstSegment segment_;  // so
};

}  // namespace inverse
