// SPDX-License-Identifier: LGPL-2.1-or-later
#include "light_stage_meta.hpp"

#include <cstddef>
#include <cstring>

#include "gst/base/meta/registered_once.hpp"

namespace inverse {
namespace {

constexpr size_t kFields = offsetof(GstLightStageMeta, program);  // what follows GstMeta

gboolean init(GstMeta* meta, gpointer, GstBuffer*) {
  memset(reinterpret_cast<char*>(meta) + kFields, 0, sizeof(GstLightStageMeta) - kFields);
  auto* self = reinterpret_cast<GstLightStageMeta*>(meta);
  self->step = self->light = -1;
  return TRUE;
}

void release(GstMeta* meta, GstBuffer*) {
  GBytes* colors = reinterpret_cast<GstLightStageMeta*>(meta)->colors;
  if (colors) g_bytes_unref(colors);
}

gboolean transform(GstBuffer* target, GstMeta* meta, GstBuffer*, GQuark, gpointer) {
  // What lit the subject does not depend on the size or the format of its picture.
  GstLightStageMeta* copy = add_light_stage_meta(target);
  memcpy(reinterpret_cast<char*>(copy) + kFields, reinterpret_cast<char*>(meta) + kFields,
         sizeof(GstLightStageMeta) - kFields);
  if (copy->colors) g_bytes_ref(copy->colors);
  return TRUE;
}

const GstMetaInfo* meta_info() {
  constexpr const char* kName = "GstLightStageMeta";
  static const gchar* tags[] = {nullptr};
  static const GstMetaInfo* info = meta_registered_once(kName, [] {
    return gst_meta_register(gst_meta_api_type_register(GST_LIGHT_STAGE_META_API_NAME, tags), kName,
                             sizeof(GstLightStageMeta), init, release, transform);
  });
  return info;
}

GstLightStageKind kind_of(StepKind kind) {
  switch (kind) {
    case StepKind::olat:
      return GST_LIGHT_STAGE_OLAT;
    case StepKind::gradient_a:
      return GST_LIGHT_STAGE_GRADIENT_A;
    case StepKind::gradient_b:
      return GST_LIGHT_STAGE_GRADIENT_B;
    case StepKind::tracking:
      return GST_LIGHT_STAGE_TRACKING;
    case StepKind::black:
      return GST_LIGHT_STAGE_BLACK;
    case StepKind::custom:
      break;
  }
  return GST_LIGHT_STAGE_CUSTOM;
}

}  // namespace

void set_position(GstLightStageMeta* meta, const LightProgram& program,
                  const LightProgram::Position& at) {
  meta->pass = at.pass;
  meta->kind = kind_of(program.kind(at));
  if (at.part != LightProgram::Position::Part::step) return;
  meta->step = static_cast<gint>(at.index);
  const LightStep& step = program.steps[at.index];
  if (step.kind != StepKind::olat) return;
  meta->light = static_cast<gint>(step.light);
  const Direction& direction = program.lights[step.light].direction;
  for (size_t c = 0; c < 3; ++c) meta->direction[c] = static_cast<gfloat>(direction[c]);
}

void register_light_stage_meta() { meta_info(); }

GstLightStageMeta* add_light_stage_meta(GstBuffer* buffer) {
  return reinterpret_cast<GstLightStageMeta*>(gst_buffer_add_meta(buffer, meta_info(), nullptr));
}

}  // namespace inverse
