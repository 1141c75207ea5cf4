// SPDX-License-Identifier: LGPL-2.1-or-later
/* An editor of one's own: the element layersaturation changes the saturation of reflectance.

   Build:
     meson setup build-editor examples/editor
     ninja -C build-editor

   Between a decomposer and intrinsiccompose, with other editors before and after it:
     intrinsicdecomp ! layersaturation saturation=0 ! intrinsiccompose

   docs/guides/write-an-editor.md explains it. */
#include <gst/base/gstbasetransform.h>
#include <gst/inverse/inverse_layers_meta.h>

GST_DEBUG_CATEGORY_STATIC(layersaturation_debug);
#define GST_CAT_DEFAULT layersaturation_debug

#define LAYERS                                                                         \
  "video/x-raw(" GST_CAPS_FEATURE_META_INVERSE_LAYERS                                  \
  "), format=(string)RGBA, layers=(string){ intrinsic, global }, width=(int)[1,max], " \
  "height=(int)[1,max], framerate=(fraction)[0/1,max]"
#define PICTURES "video/x-raw"

typedef struct {
  GstBaseTransform parent;
  // Under the object's lock: an application sets them while a frame is edited.
  gdouble saturation;
  gboolean use_mask;
  // Of the streaming thread: pictures came, and the error is posted.
  gboolean refused;
} LayerSaturation;

typedef struct {
  GstBaseTransformClass parent_class;
} LayerSaturationClass;

GType layer_saturation_get_type(void);
G_DEFINE_TYPE(LayerSaturation, layer_saturation, GST_TYPE_BASE_TRANSFORM)

enum { PROP_SATURATION = 1, PROP_USE_MASK };

// Pictures are accepted only to say what is missing; set_caps refuses them.
static GstStaticPadTemplate sink_template = GST_STATIC_PAD_TEMPLATE(
    "sink", GST_PAD_SINK, GST_PAD_ALWAYS, GST_STATIC_CAPS(LAYERS "; " PICTURES));
static GstStaticPadTemplate src_template =
    GST_STATIC_PAD_TEMPLATE("src", GST_PAD_SRC, GST_PAD_ALWAYS, GST_STATIC_CAPS(LAYERS));

static void set_property(GObject* object, guint id, const GValue* value, GParamSpec* spec) {
  LayerSaturation* self = (LayerSaturation*)object;
  GST_OBJECT_LOCK(self);
  if (id == PROP_SATURATION)
    self->saturation = g_value_get_double(value);
  else if (id == PROP_USE_MASK)
    self->use_mask = g_value_get_boolean(value);
  else
    G_OBJECT_WARN_INVALID_PROPERTY_ID(object, id, spec);
  GST_OBJECT_UNLOCK(self);
}

static void get_property(GObject* object, guint id, GValue* value, GParamSpec* spec) {
  LayerSaturation* self = (LayerSaturation*)object;
  GST_OBJECT_LOCK(self);
  if (id == PROP_SATURATION)
    g_value_set_double(value, self->saturation);
  else if (id == PROP_USE_MASK)
    g_value_set_boolean(value, self->use_mask);
  else
    G_OBJECT_WARN_INVALID_PROPERTY_ID(object, id, spec);
  GST_OBJECT_UNLOCK(self);
}

static gboolean is_layers(GstCaps* caps, guint index) {
  return gst_caps_features_contains(gst_caps_get_features(caps, index),
                                    GST_CAPS_FEATURE_META_INVERSE_LAYERS);
}

// Layers leave as they came, whatever their size and kind.
static GstCaps* transform_caps(GstBaseTransform* base, GstPadDirection direction, GstCaps* caps,
                               GstCaps* filter) {
  (void)base;
  GstCaps* other = gst_caps_new_empty();
  gboolean pictures = direction == GST_PAD_SRC;
  for (guint i = 0; i < gst_caps_get_size(caps); ++i)
    if (is_layers(caps, i))
      gst_caps_append(other, gst_caps_copy_nth(caps, i));
    else
      pictures = TRUE;
  // Behind the layers: who can send both sends layers.
  if (pictures)
    gst_caps_append(other, gst_caps_from_string(direction == GST_PAD_SRC ? PICTURES : LAYERS));
  if (filter) {
    GstCaps* both = gst_caps_intersect_full(filter, other, GST_CAPS_INTERSECT_FIRST);
    gst_caps_unref(other);
    other = both;
  }
  return other;
}

static gboolean start(GstBaseTransform* base) {
  ((LayerSaturation*)base)->refused = FALSE;
  return TRUE;
}

static gboolean set_caps(GstBaseTransform* base, GstCaps* in, GstCaps* out) {
  LayerSaturation* self = (LayerSaturation*)base;
  (void)out;
  if (is_layers(in, 0)) return TRUE;
  if (self->refused) return FALSE;  // once: some elements send on after an error
  self->refused = TRUE;
  GST_ELEMENT_ERROR(base, STREAM, FORMAT,
                    ("layersaturation works on layers; insert intrinsicdecomp or globalintrinsic "
                     "before it, with nothing between the two that takes pictures"),
                    ("got %" GST_PTR_FORMAT, in));
  return FALSE;
}

// A property with a controller gets its value at the frame's time.
static void before_transform(GstBaseTransform* base, GstBuffer* buffer) {
  const GstClockTime time =
      gst_segment_to_stream_time(&base->segment, GST_FORMAT_TIME, GST_BUFFER_PTS(buffer));
  if (GST_CLOCK_TIME_IS_VALID(time)) gst_object_sync_values(GST_OBJECT(base), time);
}

// Scales the distance of each color from gray of its luminance (of BT.709's primaries) by
// 1 + `change`, times the mask if there is one. Pixels are R, G, B and shading. Where the change is
// zero the pixel stays exactly as it is, so that intrinsiccompose returns the input there.
static void saturate(gfloat* pixels, const gfloat* mask, gsize count, gfloat change) {
  for (gsize i = 0; i < count; ++i) {
    gfloat* pixel = pixels + 4 * i;
    const gfloat gray = 0.2126f * pixel[0] + 0.7152f * pixel[1] + 0.0722f * pixel[2];
    const gfloat here = mask ? change * mask[4 * i] : change;
    for (int c = 0; c < 3; ++c) pixel[c] = MAX(pixel[c] + here * (pixel[c] - gray), 0);
  }
}

// The base class makes the buffer writable, if another branch holds it, by a copy that shares the
// layers.
static GstFlowReturn transform_ip(GstBaseTransform* base, GstBuffer* buffer) {
  LayerSaturation* self = (LayerSaturation*)base;
  GST_OBJECT_LOCK(self);
  const gfloat change = (gfloat)self->saturation - 1;
  const gboolean use_mask = self->use_mask;
  GST_OBJECT_UNLOCK(self);
  if (change == 0) return GST_FLOW_OK;

  GstInverseLayersMeta* meta = gst_buffer_get_inverse_layers_meta(buffer);
  if (!meta) {
    GST_ELEMENT_ERROR(base, STREAM, FORMAT,
                      ("a frame has no layers; remove what copies buffers without their metas "
                       "before layersaturation"),
                      (NULL));
    return GST_FLOW_ERROR;
  }
  GBytes* layer = meta->download(meta, GST_INVERSE_ROLE_INTRINSIC);
  if (!layer) goto device_failed;
  GBytes* mask = use_mask ? meta->download(meta, GST_INVERSE_ROLE_MASK) : NULL;

  gsize size;
  gfloat* pixels = g_bytes_unref_to_data(layer, &size);  // no copy: nobody else holds them
  saturate(pixels, mask ? g_bytes_get_data(mask, NULL) : NULL, (gsize)meta->width * meta->height,
           change);
  if (mask) g_bytes_unref(mask);
  layer = g_bytes_new_take(pixels, size);
  const gboolean taken = meta->upload(meta, GST_INVERSE_ROLE_INTRINSIC, layer);
  g_bytes_unref(layer);
  if (taken) return GST_FLOW_OK;

device_failed:
  GST_ELEMENT_ERROR(base, RESOURCE, FAILED,
                    ("layersaturation cannot exchange layers with the Vulkan device; "
                     "GST_DEBUG=*intrinsic*:3,inverse*:3 shows why"),
                    (NULL));
  return GST_FLOW_ERROR;
}

static void layer_saturation_class_init(LayerSaturationClass* klass) {
  GObjectClass* object = G_OBJECT_CLASS(klass);
  GstElementClass* element = GST_ELEMENT_CLASS(klass);
  GstBaseTransformClass* base = GST_BASE_TRANSFORM_CLASS(klass);
  const GParamFlags live = G_PARAM_READWRITE | G_PARAM_STATIC_STRINGS | GST_PARAM_CONTROLLABLE |
                           GST_PARAM_MUTABLE_PLAYING;
  object->set_property = set_property;
  object->get_property = get_property;
  g_object_class_install_property(
      object, PROP_SATURATION,
      g_param_spec_double("saturation", "Saturation",
                          "Factor on the saturation of surfaces: 0 = gray, 1 = unchanged", 0, 10, 1,
                          live));
  g_object_class_install_property(
      object, PROP_USE_MASK,
      g_param_spec_boolean("use-mask", "Use mask",
                           "Multiply the change by the mask layer if the frame has one", TRUE,
                           live));
  gst_element_class_add_static_pad_template(element, &sink_template);
  gst_element_class_add_static_pad_template(element, &src_template);
  // Not Filter/Effect/Video: video editors offer such elements alone, without a decomposer.
  gst_element_class_set_static_metadata(element, "Layer saturation", "Filter/Video",
                                        "Changes the saturation of reflectance",
                                        "The gst-inverse authors");
  base->transform_caps = transform_caps;
  base->start = start;
  base->set_caps = set_caps;
  base->before_transform = before_transform;
  base->transform_ip = transform_ip;
}

static void layer_saturation_init(LayerSaturation* self) {
  self->saturation = 1;
  self->use_mask = TRUE;
}

static gboolean plugin_init(GstPlugin* plugin) {
  GST_DEBUG_CATEGORY_INIT(layersaturation_debug, "layersaturation", 0, "Saturation of reflectance");
  return gst_element_register(plugin, "layersaturation", GST_RANK_NONE,
                              layer_saturation_get_type());
}

GST_PLUGIN_DEFINE(GST_VERSION_MAJOR, GST_VERSION_MINOR, layersaturation,
                  "An editor of the layers of gst-inverse", plugin_init, VERSION, "LGPL", PACKAGE,
                  "https://gstreamer.freedesktop.org/")
