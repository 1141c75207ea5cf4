// SPDX-License-Identifier: LGPL-2.1-or-later
/* gst-inverse: the layers of a decomposed frame, for people who write their own elements.
 *
 * Buffers whose caps are `video/x-raw(meta:InverseLayers), format=RGBA, layers=(string)intrinsic`
 * carry this meta and no pixels; the layers live on the Vulkan device. `layers` is `intrinsic`
 * (input, model, intrinsic), `global` (these, and layers of light), `material` (input, diffuse,
 * specular) or `gradients` (gradient A and B, no input). This header is all that is needed: no
 * library to link. Layers come to host memory and go back as GBytes of float32 RGBA, width * height
 * * 16 bytes, rows from the top, no padding.
 *
 * Copyright (C) 2026 the gst-inverse authors; LGPL-2.1-or-later.
 */
#pragma once
#include <gst/gst.h>

G_BEGIN_DECLS

#define GST_INVERSE_LAYERS_META_API_NAME "GstInverseLayersMetaAPI"
#define GST_CAPS_FEATURE_META_INVERSE_LAYERS "meta:InverseLayers"

/** Version of this header. 3: GST_INVERSE_ROLE_SURFACE, GST_INVERSE_ROLE_POSE. 2: light may have a
 * color, GST_INVERSE_ROLE_SLOPE. Programs built with an older one still edit reflectance and
 * shading; one of version 1 that multiplies them itself gets the frame in gray light unless the
 * decomposer has `light-color-slope=0`. */
#define GST_INVERSE_LAYERS_META_VERSION 3

/**
 * GstInverseRole:
 * @GST_INVERSE_ROLE_INPUT: the frame, linear RGB, 1 = full scale; w = alpha
 * @GST_INVERSE_ROLE_MODEL: reflectance RGB and shading (w) as the decomposer made them
 * @GST_INVERSE_ROLE_INTRINSIC: reflectance RGB and shading (w), edited along the chain
 * @GST_INVERSE_ROLE_MASK: x = matte 0...1
 * @GST_INVERSE_ROLE_MODEL_LIGHT: light as the decomposer made it
 * @GST_INVERSE_ROLE_LIGHT: of `global` frames: the color of light, RGB, so that reflectance times
 * shading times it (times the color of GST_INVERSE_ROLE_SLOPE where there is one) is the frame;
 * without edits its mean or geometric mean is 1. w = share of the shading that is direct
 * @GST_INVERSE_ROLE_INDIRECT_0: shares of the shading that bounced off surfaces of base colors
 * 0...3; the next three planes go on to 15, and are absent where there are no such colors
 * @GST_INVERSE_ROLE_BASES: the 16 base colors, RGB; w = 1, or 0 where there is no such color. 16
 * pixels in place of width * height
 * @GST_INVERSE_ROLE_MODEL_BASES: base colors as the decomposer made them
 * @GST_INVERSE_ROLE_LAMP: the color of direct light, RGB of geometric mean 1, one pixel; absent
 * where it is white
 * @GST_INVERSE_ROLE_DIFFUSE: of `material` frames: linear RGB of the frame without the highlights
 * of the object in it, 1 = full scale; w = the object's mask, 0...1
 * @GST_INVERSE_ROLE_SPECULAR: of `material` frames: these highlights, linear RGB, gray except where
 * the input is clipped; diffuse + specular is the input. w = the mirror image: the reflection by a
 * mirror of the object's shape and specular albedo, linear, may exceed 1, 0 outside the mask
 * @GST_INVERSE_ROLE_GRADIENT_A: of `gradients` frames: the subject under gradient A of a light
 * stage, linear RGB, 1 = full scale; w = alpha
 * @GST_INVERSE_ROLE_GRADIENT_B: the same under gradient B; A + B is the subject under all lights
 * @GST_INVERSE_ROLE_SLOPE: the color of light by its shading S, one pixel: k, w, confidence of k
 * 0...1, reserved. The frame is reflectance times S e^(k (ln S - w) d), d = (1/2, 0, -1/2) for R,
 * G, B, times the color of GST_INVERSE_ROLE_LIGHT where there is one. Absent where that color is
 * white. Since version 2
 * @GST_INVERSE_ROLE_SURFACE: of frames with a remembered scene: unit normal toward the camera in
 * its axes (x right, y down, z forward), 0 where unknown; w = depth, meters along the optical axis,
 * 0 where unknown. Of the surface that is remembered, or of the depth image where something else is
 * in front of it. Each pixel is the nearest one of the view of the scene, which may be smaller than
 * the frame. Read only. Since version 3
 * @GST_INVERSE_ROLE_POSE: the camera of GST_INVERSE_ROLE_SURFACE, three pixels. First: the unit
 * quaternion (x, y, z, w) that turns directions of the camera into the world's. Second: the
 * camera's place in the world, meters; w = 1, or 0 while the camera is lost, when surface is 0 and
 * the pose is an old one. Third: focal lengths and center of the frame, pixels with centers at
 * whole numbers: fx, fy, cx, cy. A pixel (x, y) of depth z shows the point z ((x - cx) / fx,
 * (y - cy) / fy, 1) of the camera's axes. The world is that of the poses that frames carry; if the
 * first one carries none, its camera is the origin. Read only. Since version 3
 */
typedef enum {
  GST_INVERSE_ROLE_INPUT,
  GST_INVERSE_ROLE_MODEL,
  GST_INVERSE_ROLE_INTRINSIC,
  GST_INVERSE_ROLE_MASK,
  GST_INVERSE_ROLE_MODEL_LIGHT,
  GST_INVERSE_ROLE_LIGHT,
  GST_INVERSE_ROLE_INDIRECT_0,
  GST_INVERSE_ROLE_INDIRECT_1,
  GST_INVERSE_ROLE_INDIRECT_2,
  GST_INVERSE_ROLE_INDIRECT_3,
  GST_INVERSE_ROLE_BASES,
  GST_INVERSE_ROLE_MODEL_BASES,
  GST_INVERSE_ROLE_LAMP,
  GST_INVERSE_ROLE_DIFFUSE,
  GST_INVERSE_ROLE_SPECULAR,
  GST_INVERSE_ROLE_GRADIENT_A,
  GST_INVERSE_ROLE_GRADIENT_B,
  GST_INVERSE_ROLE_SLOPE,
  GST_INVERSE_ROLE_SURFACE,
  GST_INVERSE_ROLE_POSE,
} GstInverseRole;

typedef struct GstInverseLayersMeta GstInverseLayersMeta;

/**
 * GstInverseLayersMeta:
 * @width: pixels
 * @height: pixels
 * @download: a layer in host memory; %NULL where the frame has no such layer or the device failed.
 * Free with g_bytes_unref().
 * @upload: replaces a layer of a writable buffer; %FALSE where @data has the wrong size, the layer
 * is read only or the device failed
 * @version: GST_INVERSE_LAYERS_META_VERSION of the elements that made it; see
 * gst_inverse_layers_meta_version()
 */
struct GstInverseLayersMeta {
  GstMeta meta;
  guint width;
  guint height;
  GBytes* (*download)(GstInverseLayersMeta* meta, GstInverseRole role);
  gboolean (*upload)(GstInverseLayersMeta* meta, GstInverseRole role, GBytes* data);
  /*< private >*/
  gpointer layers;
  GstBuffer* buffer;
  /*< public >*/
  guint version;
};

/** The version of the elements that made the meta. */
static inline guint gst_inverse_layers_meta_version(const GstInverseLayersMeta* meta) {
  return meta->meta.info->size >= sizeof(GstInverseLayersMeta) ? meta->version : 1;
}

/** The layers of a buffer, or %NULL. */
static inline GstInverseLayersMeta* gst_buffer_get_inverse_layers_meta(GstBuffer* buffer) {
  const GType api = g_type_from_name(GST_INVERSE_LAYERS_META_API_NAME);
  if (!api) return NULL;  // NOLINT(modernize-use-nullptr): C reads this, too
  return (GstInverseLayersMeta*)gst_buffer_get_meta(buffer, api);
}

G_END_DECLS
