// SPDX-License-Identifier: LGPL-2.1-or-later
// The threads of lightstagesync's source pads, which assemble frames and push them.
#include "gst/base/log/errors.hpp"
#include "sync_element.hpp"

namespace inverse {
namespace {

/// Event to a camera's assembler, in the order of frames: the program has ended.
constexpr const char* kProgramEnded = "lightstage-program-ended";
constexpr const char* kOver = "over";  // true: by itself; false: another stream came before its end

}  // namespace

/// Makes the assembler end what is incomplete.
void SyncElement::end_program(SyncCamera& camera, bool over) {
  if (camera.program_ended) return;
  camera.program_ended = true;
  camera.append(
      gst_event_new_custom(GST_EVENT_CUSTOM_DOWNSTREAM,
                           gst_structure_new(kProgramEnded, kOver, G_TYPE_BOOLEAN, over, nullptr)));
}

bool SyncElement::take_out(SyncCamera& camera, SyncCamera::Item& item) {
  Lock lock(mutex_);
  while (camera.out.empty() && !camera.flushing) {
    changed_.wait_for(lock, kCheckEvery);
    report_stalled_cameras();
    post(lock);
  }
  if (camera.flushing) return false;
  item = camera.out.front();
  camera.out.pop_front();
  camera.outgoing_buffers -= GST_IS_BUFFER(item.object) ? 1 : 0;
  changed_.notify_all();
  return true;
}

GstFlowReturn SyncElement::send(SyncCamera& camera, SyncCamera::Item& item) {
  GstFlowReturn flow = GST_FLOW_OK;
  if (GST_IS_BUFFER(item.object)) {
    GstBuffer* buffer = GST_BUFFER_CAST(item.object);
    if (!guarded(element_, [&] {
          flow = camera.assembler->take(buffer, item.label ? &*item.label : nullptr);
        }))
      flow = GST_FLOW_ERROR;
    return flow;
  }
  GstEvent* event = GST_EVENT_CAST(item.object);
  if (GST_EVENT_TYPE(event) == GST_EVENT_CAPS) {
    GstCaps* caps = nullptr;
    gst_event_parse_caps(event, &caps);
    bool good = false;
    if (!guarded(element_, [&] { good = camera.assembler->set_caps(caps); }))
      flow = GST_FLOW_ERROR;
    else if (!good)
      flow = GST_FLOW_NOT_NEGOTIATED;
    gst_event_unref(event);
    return flow;
  }
  if (gst_event_has_name(event, kProgramEnded)) {
    gboolean over = FALSE;
    gst_structure_get_boolean(gst_event_get_structure(event), kOver, &over);
    if (!guarded(element_, [&] { flow = camera.assembler->finish(over); })) flow = GST_FLOW_ERROR;
    gst_event_unref(event);
    return flow;
  }
  if (GST_EVENT_TYPE(event) == GST_EVENT_EOS &&
      !guarded(element_, [&] { flow = camera.assembler->finish(false); }))
    flow = GST_FLOW_ERROR;
  const bool ends = GST_EVENT_TYPE(event) == GST_EVENT_EOS;
  gst_pad_push_event(camera.src, event);
  return ends && flow == GST_FLOW_OK ? GST_FLOW_EOS : flow;
}

/// The source pad's thread.
void SyncElement::push_out(SyncCamera& camera) {
  SyncCamera::Item item;
  if (!take_out(camera, item)) {
    gst_pad_pause_task(camera.src);
    return;
  }
  if (GST_IS_QUERY(item.object)) {
    answer(camera, GST_QUERY_CAST(item.object));
    return;
  }
  const bool ending =
      GST_IS_EVENT(item.object) && GST_EVENT_TYPE(GST_EVENT_CAST(item.object)) == GST_EVENT_EOS;
  const bool is_buffer = GST_IS_BUFFER(item.object);
  if (is_buffer) {
    const Lock lock(mutex_);
    if (camera.flow == GST_FLOW_ERROR) {  // which was posted, and upstream is about to hear of it
      gst_mini_object_unref(item.object);
      return;
    }
  }
  const GstFlowReturn flow = send(camera, item);
  Lock lock(mutex_);
  if (is_buffer && flow == GST_FLOW_OK) ++camera.sent;
  if (ending) {
    if (camera.ended) gst_pad_pause_task(camera.src);  // else another stream has begun
    return;
  }
  if (flow != camera.flow && !camera.released) camera.flow = flow;
  changed_.notify_all();
}

void SyncElement::push_task(gpointer data) {
  auto* pad = static_cast<GstPad*>(data);
  auto* element = static_cast<SyncElement*>(gst_pad_get_element_private(pad));
  if (const CameraPtr one = element->find(pad))
    element->push_out(*one);
  else
    gst_pad_pause_task(pad);  // it was given back
}

bool SyncElement::activate_src(const CameraPtr& camera, bool active) {
  if (active) {
    {
      Lock lock(mutex_);
      if (camera->released) return false;
      camera->flushing = false;
    }
    // May post a message, so the mutex is not locked.
    const bool good = gst_pad_start_task(camera->src, push_task, camera->src, nullptr);
    {
      Lock lock(mutex_);
      if (!camera->released) return good;
    }
    gst_pad_stop_task(camera->src);
    return false;
  }
  {
    Lock lock(mutex_);
    camera->flushing = true;
    changed_.notify_all();
  }
  return gst_pad_stop_task(camera->src);
}

}  // namespace inverse
