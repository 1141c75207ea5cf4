// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/video/video.h>

#include <cstdint>

#include "kernels/gpu/commands.hpp"

namespace inverse {

/// The fields that every element's `stats` has, about a frame whose commands are done: frames (how
/// many so far), device (name), wall-ms, device-ms and one `<stage>-ms` for each stage that was
/// timed, device-bytes now and device-bytes-peak, and `Commands::counts`. Free with
/// gst_structure_free().
GstStructure* frame_stats(const gpu::Commands& commands, uint64_t frames, double wall_ms);

/// How long a frame stays in an element that draws pictures, at most: one frame duration; 1/25 s
/// if the caps give none, as those of streams from networks and screens do.
GstClockTime frame_latency(const GstVideoInfo& info);

/// Adds an element's own latency to the answer of a latency query.
void add_latency(GstQuery* query, GstClockTime own);

}  // namespace inverse
