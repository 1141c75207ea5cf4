// SPDX-License-Identifier: LGPL-2.1-or-later
#include "stage_labels.hpp"

#include <algorithm>

#include "gst/lightstage/meta/light_stage_meta.hpp"

namespace inverse {

StageLabels::StageLabels(LightProgram program) : program_(std::move(program)), id_(program_.id()) {}

StageLabels::~StageLabels() {
  for (auto& [step, bytes] : colors_) g_bytes_unref(bytes);
}

GstClockTime StageLabels::period() const {
  return gst_util_uint64_scale_round(GST_SECOND, program_.rate_denominator,
                                     program_.rate_numerator);
}

GBytes* StageLabels::colors(const LightProgram::Position& position) const {
  const bool step = position.part == LightProgram::Position::Part::step;
  const uint64_t key = step ? position.index : LightProgram::kMaxSteps + position.index;
  std::lock_guard lock(mutex_);
  GBytes*& bytes = colors_[key];
  if (!bytes) {
    const auto colors = program_.colors(position);
    bytes = g_bytes_new(colors.data(), colors.size() * sizeof(colors[0]));
  }
  return g_bytes_ref(bytes);
}

void StageLabels::attach(GstBuffer* buffer, const FrameLabel& label) const {
  if (GstLightStageMeta* old = gst_buffer_get_light_stage_meta(buffer))
    gst_buffer_remove_meta(buffer, &old->meta);  // of an element before
  GstLightStageMeta* meta = add_light_stage_meta(buffer);
  const LightProgram::Position& at = label.position;
  meta->program = id_;
  meta->trigger = label.trigger;
  set_position(meta, program_, at);
  meta->lights = static_cast<guint>(program_.lights.size());
  meta->colors = colors(at);
}

}  // namespace inverse
