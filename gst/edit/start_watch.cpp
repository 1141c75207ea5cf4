// SPDX-License-Identifier: LGPL-2.1-or-later
#include "start_watch.hpp"

#include <gst/base/gstbasesink.h>

#include <atomic>

#include "gst/base/log/log.hpp"
#include "gst/base/pads/pads.hpp"

namespace inverse {
namespace {

constexpr GstClockTime kInterval = 2 * GST_SECOND;

/// Whether the pipeline is still on its way to a state, as it is until all its sinks have a frame.
bool starting(GstElement* element) {
  ElementPtr top(GST_ELEMENT(gst_object_ref(element)));
  while (GstObject* parent = gst_object_get_parent(GST_OBJECT(top.get())))
    top.reset(GST_ELEMENT(parent));
  GST_OBJECT_LOCK(top.get());
  const bool pending = GST_STATE_RETURN(top.get()) == GST_STATE_CHANGE_ASYNC;
  GST_OBJECT_UNLOCK(top.get());
  return pending;
}

/// Whether a thread is in the pad's chain function.
bool in_chain(GstPad* sink) {
  if (!g_rec_mutex_trylock(GST_PAD_GET_STREAM_LOCK(sink))) return true;
  g_rec_mutex_unlock(GST_PAD_GET_STREAM_LOCK(sink));
  return false;
}

/// How far the frame has come that was pushed through `src`: the sink pad of the element that has
/// it; null if nobody took it.
PadPtr reached(GstPad* src) {
  PadPtr at = linked_pad(src);
  if (!at || !in_chain(at.get())) return nullptr;
  for (bool further = true; further;) {
    further = false;
    for (const PadPtr& out : pads_behind(at.get())) {
      PadPtr next = linked_pad(out.get());
      if (!next || !in_chain(next.get())) continue;
      at = std::move(next);
      further = true;
      break;
    }
  }
  return at;
}

/// Whether an element that has a frame waits for others, rather than works on it: a sink for those
/// of other sinks, a muxer or mixer for those of its other pads.
bool waits_for_others(GstElement* element) {
  if (!GST_IS_BASE_SINK(element)) {
    GST_OBJECT_LOCK(element);
    const bool joins = element->numsinkpads > 1;
    GST_OBJECT_UNLOCK(element);
    return joins;
  }
  GstBaseSink* sink = GST_BASE_SINK(element);
  if (!GST_BASE_SINK_PREROLL_TRYLOCK(sink)) return false;  // it shows the frame
  const bool waits = sink->have_preroll;
  GST_BASE_SINK_PREROLL_UNLOCK(sink);
  return waits;
}

}  // namespace

struct StartWatch::State {
  ElementPtr split;
  PadPtr pad;
  std::string waiting;
  std::atomic<bool> over{false};

  /// From the clock's thread.
  void check() {
    if (over || !starting(split.get())) return;
    const PadPtr at = reached(pad.get());
    const ElementPtr holder = at ? element_of_pad(at.get()) : nullptr;
    if (!holder || !waits_for_others(holder.get()) || over.exchange(true)) return;
    post_warning(
        log_of(split.get()), GST_STREAM_ERROR, GST_STREAM_ERROR_FAILED,
        "pad %s of %s is blocked: %s waits for frames of other branches, and pad %s cannot "
        "send its first one meanwhile; put a queue behind every pad, as behind those of a "
        "tee",
        name_of(pad.get()).c_str(), label_of(split.get()).c_str(), label_of(holder.get()).c_str(),
        waiting.c_str());
  }
};

StartWatch::StartWatch(GstElement* split, GstPad* pad, const std::string& waiting)
    : state_(std::make_shared<State>()) {
  state_->split.reset(GST_ELEMENT(gst_object_ref(split)));
  state_->pad.reset(GST_PAD(gst_object_ref(pad)));
  state_->waiting = waiting;
  GstClock* clock = gst_system_clock_obtain();
  id_ = gst_clock_new_periodic_id(clock, gst_clock_get_time(clock) + kInterval, kInterval);
  gst_clock_id_wait_async(
      id_,
      [](GstClock*, GstClockTime, GstClockID, gpointer state) -> gboolean {
        (*static_cast<std::shared_ptr<State>*>(state))->check();
        return TRUE;
      },
      new std::shared_ptr<State>(state_),
      [](gpointer state) { delete static_cast<std::shared_ptr<State>*>(state); });
  gst_object_unref(clock);
}

StartWatch::~StartWatch() {
  state_->over = true;
  gst_clock_id_unschedule(id_);
  gst_clock_id_unref(id_);
}

}  // namespace inverse
