// SPDX-License-Identifier: LGPL-2.1-or-later
/* gst-inverse: the depth image that belongs to a picture.
 *
 * This header is all that is needed: no library to link.
 *
 * Copyright (C) 2026 the gst-inverse authors; LGPL-2.1-or-later.
 */
#pragma once
#include <gst/gst.h>

G_BEGIN_DECLS

#define GST_INVERSE_DEPTH_META_API_NAME "GstInverseDepthMetaAPI"

/**
 * GstInverseDepthMeta:
 * @depth: the image, unsigned 16 bits little endian, rows from the top; 0 = unknown. The meta has a
 * reference. Never changed: replace the meta instead
 * @width: pixels; the image shows what the picture shows, in a size of its own
 * @height: pixels
 * @stride: bytes from row to row
 * @unit: meters of a step
 * @fx: focal length in pixels of the depth image; pixel centers are at whole numbers
 * @fy: the same along y
 * @cx: center in pixels of the depth image
 * @cy: the same along y
 * @posed: whether @pose is known
 * @pose: the camera's place and direction: the first three rows of the matrix, row by row, that
 * takes meters in the camera's axes (x right, y down, z forward) to the world's
 */
typedef struct {
  GstMeta meta;
  GstBuffer* depth;
  guint width;
  guint height;
  guint stride;
  gdouble unit;
  gdouble fx;
  gdouble fy;
  gdouble cx;
  gdouble cy;
  gboolean posed;
  gdouble pose[12];
} GstInverseDepthMeta;

/** The depth of a buffer's picture, or %NULL. */
static inline GstInverseDepthMeta* gst_buffer_get_inverse_depth_meta(GstBuffer* buffer) {
  const GType api = g_type_from_name(GST_INVERSE_DEPTH_META_API_NAME);
  if (!api) return NULL;  // NOLINT(modernize-use-nullptr): C reads this, too
  return (GstInverseDepthMeta*)gst_buffer_get_meta(buffer, api);
}

G_END_DECLS
