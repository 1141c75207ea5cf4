// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/gst.h>

#include <cstdint>

namespace inverse {

/// The first element upstream of a sink pad that is `wanted`, through queues, converters and bins:
/// a new reference; null if there is none.
GstElement* upstream_element(GstPad* sink, bool (*wanted)(GstElement* element));

/// Bits of frame ids by the property `frame-id-bits` of an element upstream, as lightstagearavissrc
/// has it once its camera is open: 16, 32 or 64; 0 if there is none.
uint32_t upstream_id_bits(GstPad* sink);

}  // namespace inverse
