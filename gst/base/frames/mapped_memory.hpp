// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/gst.h>

#include <memory>

#include "kernels/gpu/buffer.hpp"

namespace inverse {

/// An allocator of memory of `device` that the host maps: what elements write there, kernels read
/// without a copy, and the reverse. Its memory keeps the device alive. If the device has none left
/// it gives system memory. New reference.
GstAllocator* mapped_allocator(const std::shared_ptr<gpu::Device>& device);

/// The words on the device in which the only memory of `buffer` lies, from the first one on; null
/// if it is other memory.
gpu::BufferPtr mapped_words(GstBuffer* buffer);

}  // namespace inverse
