// SPDX-License-Identifier: LGPL-2.1-or-later
/* gst-inverse: the material of the object in a frame, by limematerial.
 *
 * This header is all that is needed: no library to link.
 *
 * Copyright (C) 2026 the gst-inverse authors; LGPL-2.1-or-later.
 */
#pragma once
#include <gst/gst.h>

G_BEGIN_DECLS

#define GST_MATERIAL_META_API_NAME "GstMaterialMetaAPI"
#define GST_MATERIAL_BINS 8

/**
 * GstMaterialMeta:
 *
 * limematerial attaches it to every frame. It passes through conversion (videoconvert) and scaling
 * (videoscale with add-borders=false: the box is scaled, too). Elements that crop, pad or turn
 * frames (videocrop, videobox, videoflip) drop it, as box and light would be wrong.
 *
 * @found: whether there is an object; without one, only the light is valid
 * @diffuse: diffuse albedo, linear RGB, 0...1
 * @specular: specular albedo, white, 0...1
 * @shininess: exponent of Blinn-Phong's lobe, 2...1024. Reflected light is diffuse * D +
 * specular * g * S, with g = (shininess + 8) / 16 above 8, else 1. It is the mean in log2 over all
 * bins and may lie outside the most probable one
 * @bins: probabilities of eight bins of the shininess, of equal width in log2, from 2 to 1024
 * @averaged: number of frames in the mean; 0 in the frame in which the object is found: only its
 * box is known then, and its material is 0
 * @left: the object's box, in pixels of the frame
 * @top: the same
 * @right: the same
 * @bottom: the same
 * @environment_width: texels of @environment along a row; 0 while the light is not known
 * @environment_height: its rows
 * @environment: the light around the object, or %NULL while it is not known: float32 RGB, rows from
 * the top, no padding. Latitude-longitude: the top row looks up (+y), the center column to the
 * camera (+z), x to the right: the mirror image of a panorama file, which is seen from the object.
 * Linear radiance: under 1 from everywhere a white diffuse surface has the value 1 (full scale).
 * Immutable and shared by copies of the meta: take a reference to keep it
 */
typedef struct {
  GstMeta meta;
  gboolean found;
  gfloat diffuse[3];
  gfloat specular;
  gfloat shininess;
  gfloat bins[GST_MATERIAL_BINS];
  guint64 averaged;
  gfloat left, top, right, bottom;
  guint environment_width, environment_height;
  GBytes* environment;
} GstMaterialMeta;

/** The material of a buffer, or %NULL. */
static inline GstMaterialMeta* gst_buffer_get_material_meta(GstBuffer* buffer) {
  const GType api = g_type_from_name(GST_MATERIAL_META_API_NAME);
  if (!api) return NULL;  // NOLINT(modernize-use-nullptr): C reads this, too
  return (GstMaterialMeta*)gst_buffer_get_meta(buffer, api);
}

G_END_DECLS
