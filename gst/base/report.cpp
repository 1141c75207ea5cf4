// SPDX-License-Identifier: LGPL-2.1-or-later
#include "report.hpp"

#include <map>
#include <string>

namespace inverse {

GstStructure* frame_stats(const gpu::Commands& commands, uint64_t frames, double wall_ms) {
  const gpu::Device& device = *commands.device();
  GstStructure* stats = gst_structure_new(
      "inverse-stats", "frames", G_TYPE_UINT64, frames, "device", G_TYPE_STRING,
      device.name().c_str(), "wall-ms", G_TYPE_DOUBLE, wall_ms, "device-bytes", G_TYPE_UINT64,
      device.memory_bytes(), "device-bytes-peak", G_TYPE_UINT64, device.memory_peak_bytes(),
      "kernels", G_TYPE_UINT64, device.kernels_used(), nullptr);
  const gpu::WorkCounts& work = commands.counts();
  gst_structure_set(stats, "dispatches", G_TYPE_UINT, work.dispatches, "transfers", G_TYPE_UINT,
                    work.transfers, "barriers", G_TYPE_UINT, work.barriers, "bytes-transferred",
                    G_TYPE_UINT64, work.transferred_bytes, "bytes-uploaded", G_TYPE_UINT64,
                    work.uploaded_bytes, "bytes-downloaded", G_TYPE_UINT64, work.downloaded_bytes,
                    nullptr);
  std::map<std::string, double> stages;  // some come more than once, as cycles do
  for (const auto& stage : commands.stages()) stages[stage.name] += stage.milliseconds;
  for (const auto& [name, milliseconds] : stages)
    gst_structure_set(stats, (name + "-ms").c_str(), G_TYPE_DOUBLE, milliseconds, nullptr);
  gst_structure_set(stats, "device-ms", G_TYPE_DOUBLE, commands.device_ms(), nullptr);
  return stats;
}

GstClockTime frame_latency(const GstVideoInfo& info) {
  if (GST_VIDEO_INFO_FPS_N(&info) <= 0) return GST_SECOND / 25;
  return gst_util_uint64_scale_int(GST_SECOND, GST_VIDEO_INFO_FPS_D(&info),
                                   GST_VIDEO_INFO_FPS_N(&info));
}

void add_latency(GstQuery* query, GstClockTime own) {
  gboolean live = FALSE;
  GstClockTime min = 0, max = 0;
  gst_query_parse_latency(query, &live, &min, &max);
  gst_query_set_latency(query, live, min + own, GST_CLOCK_TIME_IS_VALID(max) ? max + own : max);
}

}  // namespace inverse
