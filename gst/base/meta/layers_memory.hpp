// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/gst.h>

namespace inverse {

/// Memory of `size` bytes that cannot be mapped. A buffer of layers has one of the size of its
/// planes, so that queues count them (`max-size-bytes`, 10 MB by default). New reference.
GstMemory* new_layers_memory(gsize size);

}  // namespace inverse
