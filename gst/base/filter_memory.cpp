// SPDX-License-Identifier: LGPL-2.1-or-later
// Allocation queries of a FilterElement: frames in memory that the host and the device share.
#include "filter_element.hpp"

namespace inverse {

GstAllocator* FilterElement::allocator_for(GstCaps* caps,
                                           const std::shared_ptr<gpu::Device>& device) {
  GstVideoInfo info;
  if (!device || !caps || carries_layers(caps) || carries_images(caps) ||
      !gst_video_info_from_caps(&info, caps))
    return nullptr;
  try {
    return frame_allocator(info, device);
  } catch (const Error&) {
    return nullptr;  // the caps are refused, with an error
  }
}

void FilterElement::propose_memory(GstQuery* query) {
  GstCaps* caps = nullptr;
  gboolean needs_pool = FALSE;
  gst_query_parse_allocation(query, &caps, &needs_pool);
  GstAllocator* allocator = allocator_for(caps, system_device());
  if (!allocator) return;
  GstAllocationParams params;
  gst_allocation_params_init(&params);
  gst_query_add_allocation_param(query, allocator, &params);
  GstVideoInfo info;
  gst_video_info_from_caps(&info, caps);
  const auto size = static_cast<guint>(GST_VIDEO_INFO_SIZE(&info));
  // Frames are held until the device has read them, which pixels that go out wait for.
  const guint held = out_layers_ ? gpu::kFramesInFlight : 1;
  GstBufferPool* pool = nullptr;
  if (needs_pool) {
    pool = gst_video_buffer_pool_new();
    GstStructure* config = gst_buffer_pool_get_config(pool);
    gst_buffer_pool_config_set_params(config, caps, size, held, 0);
    gst_buffer_pool_config_set_allocator(config, allocator, &params);
    gst_buffer_pool_set_config(pool, config);
  }
  gst_query_add_allocation_pool(query, pool, size, held, 0);
  if (pool) gst_object_unref(pool);
  gst_object_unref(allocator);
}

void FilterElement::decide_memory(GstQuery* query) {
  memory_device_ = device_ ? device_ : system_device();
  // Pools of their own kind are there for a reason: shared memory, planes of a display.
  if (gst_query_get_n_allocation_pools(query) > 0) {
    GstBufferPool* pool = nullptr;
    gst_query_parse_nth_allocation_pool(query, 0, &pool, nullptr, nullptr, nullptr);
    const bool plain = !pool || G_OBJECT_TYPE(pool) == GST_TYPE_VIDEO_BUFFER_POOL ||
                       G_OBJECT_TYPE(pool) == GST_TYPE_BUFFER_POOL;
    if (pool) gst_object_unref(pool);
    if (!plain) return;
  }
  GstAllocationParams params;
  gst_allocation_params_init(&params);
  const bool asked = gst_query_get_n_allocation_params(query) > 0;
  if (asked) {
    GstAllocator* theirs = nullptr;
    gst_query_parse_nth_allocation_param(query, 0, &theirs, &params);
    const bool system = !theirs || g_strcmp0(theirs->mem_type, GST_ALLOCATOR_SYSMEM) == 0;
    if (theirs) gst_object_unref(theirs);
    if (!system) return;
  }
  GstCaps* caps = nullptr;
  gst_query_parse_allocation(query, &caps, nullptr);
  GstAllocator* allocator = allocator_for(caps, memory_device_);
  if (!allocator) return;
  if (asked)
    gst_query_set_nth_allocation_param(query, 0, allocator, &params);
  else
    gst_query_add_allocation_param(query, allocator, &params);
  gst_object_unref(allocator);
}

}  // namespace inverse
