// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/gst.h>

namespace inverse {

/// Sink pads of an element beside its `sink`, on request (ElementInfo::side_sinks). Buffers and
/// events of theirs stay with the filter; nothing is forwarded. All calls from any thread.
class SidePads {
 public:
  virtual ~SidePads() = default;
  /// A pad of this template for the element to add; null if there is one.
  virtual GstPad* request(GstElement* element, GstPadTemplate* pad_template) = 0;
  /// The pad is about to be removed: nothing waits in it or for it any more.
  virtual void release(GstPad* pad) = 0;
  /// A flush of `sink` begins, or ends; so when the element stops and starts. Meanwhile
  /// Filter::process waits for no pad (Flushing).
  virtual void set_flushing(bool /*flushing*/) {}
  /// Makes the answer of a latency query upstream of `sink` one for all pads.
  virtual void add_latency(GstQuery* /*query*/) {}
};

}  // namespace inverse
