// SPDX-License-Identifier: LGPL-2.1-or-later
/* gst-inverse: which lights of a light stage lit a frame.
 *
 * This header is all that is needed: no library to link.
 *
 * Copyright (C) 2026 the gst-inverse authors; LGPL-2.1-or-later.
 */
#pragma once
#include <gst/gst.h>

G_BEGIN_DECLS

#define GST_LIGHT_STAGE_META_API_NAME "GstLightStageMetaAPI"

/**
 * GstLightStageKind:
 * @GST_LIGHT_STAGE_OLAT: one light alone, white
 * @GST_LIGHT_STAGE_GRADIENT_A: every light ((1 + x)/2, (1 + y)/2, (1 + z)/2) of its direction
 * @GST_LIGHT_STAGE_GRADIENT_B: every light ((1 - x)/2, (1 - y)/2, (1 - z)/2)
 * @GST_LIGHT_STAGE_TRACKING: all lights full on
 * @GST_LIGHT_STAGE_BLACK: all lights off
 * @GST_LIGHT_STAGE_CUSTOM: as the program has it
 * @GST_LIGHT_STAGE_GRADIENTS: a pair in one buffer: gradient A and gradient B
 */
typedef enum {
  GST_LIGHT_STAGE_OLAT,
  GST_LIGHT_STAGE_GRADIENT_A,
  GST_LIGHT_STAGE_GRADIENT_B,
  GST_LIGHT_STAGE_TRACKING,
  GST_LIGHT_STAGE_BLACK,
  GST_LIGHT_STAGE_CUSTOM,
  GST_LIGHT_STAGE_GRADIENTS,
} GstLightStageKind;

/**
 * GstLightStageMeta:
 * @program: fingerprint of the light program
 * @trigger: number of triggers from the start of the program, marker included, to this frame (of a
 * pair: to its first frame)
 * @pass: number of completed passes through the program's steps
 * @step: index of the step in the program, or -1 for frames of a marker
 * @kind: what the lights did
 * @light: of an OLAT frame: the index of its light, else -1
 * @direction: of an OLAT frame: unit vector from the subject to the light; x right, y up, z to the
 * camera. Else 0
 * @lights: number of lights
 * @colors: emitted color of every light in order, float32 RGB, 0...1. Immutable and shared by
 * copies of the meta: take a reference to keep it
 */
typedef struct {
  GstMeta meta;
  guint64 program;
  guint64 trigger;
  guint64 pass;
  gint step;
  GstLightStageKind kind;
  gint light;
  gfloat direction[3];
  guint lights;
  GBytes* colors;
} GstLightStageMeta;

/** What lit a buffer, or %NULL. */
static inline GstLightStageMeta* gst_buffer_get_light_stage_meta(GstBuffer* buffer) {
  const GType api = g_type_from_name(GST_LIGHT_STAGE_META_API_NAME);
  if (!api) return NULL;  // NOLINT(modernize-use-nullptr): C reads this, too
  return (GstLightStageMeta*)gst_buffer_get_meta(buffer, api);
}

G_END_DECLS
