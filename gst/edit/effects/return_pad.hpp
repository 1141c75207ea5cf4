// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/video/video.h>

#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "sent_picture.hpp"

namespace inverse {

/// What a picture that came back looks like, and looked like before.
struct ReturnedFormat {
  GstVideoInfo info{};
  SentPicture sent;
};

/// A sink pad for pictures of one layer that come back from an effect. It holds them until the
/// frame on the element's `sink` comes that they belong to.
class ReturnPad {
 public:
  /// What all pads of an element share.
  struct Shared {
    std::mutex mutex;  // everything but what is constant
    std::condition_variable changed;
    bool flushing = false;  ///< `sink` flushes, or the element is stopped
    bool ended = false;     ///< the stream on `sink` is over: pictures are dropped
    uint64_t missing = 0;   ///< frames whose picture did not come, or not in time, summed over pads
    uint64_t late = 0;      ///< pictures that came after their frame had gone on
  };
  /// A running time, which may be negative; none if it is not known.
  using Time = std::optional<GstClockTimeDiff>;
  struct Picture {
    Time start, end;                               ///< `end` is of gaps alone
    std::shared_ptr<GstBuffer> buffer;             ///< null: a gap, there is none at this time
    std::shared_ptr<const ReturnedFormat> format;  ///< the same object while nothing changes
  };
  /// What has come for a frame.
  enum class Found : uint8_t { picture, none, nothing_yet };

  /// A new pad, inactive, which keeps its ReturnPad alive.
  static std::shared_ptr<ReturnPad> create(GstPadTemplate* pad_template, SplitLayer layer,
                                           const std::shared_ptr<Shared>& shared);
  ReturnPad(GstPad* pad, SplitLayer layer, std::shared_ptr<Shared> shared);

  GstPad* pad() const { return pad_; }
  SplitLayer layer() const { return layer_; }

  /// The picture of the frame at `time`, give or take `tolerance`; older ones are dropped. A
  /// picture without a time belongs to the next frame. Shared::mutex held.
  Found take(Time time, GstClockTimeDiff tolerance, Picture& picture);
  /// Drops what is held. Shared::mutex held.
  void clear();

  /// Under Shared::mutex. The branch did not deliver in time: the next frames do not wait as long.
  /// `unresponsive`: nor since.
  bool stalled = false, unresponsive = false;
  bool warned = false;  ///< of that, or of nothing but absent pictures
  unsigned absent = 0;  ///< frames without a picture, up to the first picture
  bool came = false;    ///< a picture

 private:
  static ReturnPad& self_of(GstPad* pad);
  bool activate(bool active);
  GstFlowReturn chain(GstBuffer* buffer);
  gboolean event(GstEvent* event);
  bool set_caps(GstCaps* caps);
  void describe(const SentPicture& sent);
  void hold_gap(GstEvent* event);
  void set_flushing(bool flushing);
  Time running_time(GstClockTime time) const;

  GstPad* const pad_;  // it may be gone once it is inactive
  const SplitLayer layer_;
  const std::shared_ptr<Shared> shared_;
  // Under Shared::mutex.
  std::deque<Picture> held_;
  std::shared_ptr<const ReturnedFormat> format_;
  std::optional<SentPicture> sent_;
  GstVideoInfo info_{};         // of the caps
  bool color_is_open_ = false;  // they do not say what colors the samples mean
  GstSegment segment_;
  bool flushing_ = true, ended_ = false;
};

}  // namespace inverse
