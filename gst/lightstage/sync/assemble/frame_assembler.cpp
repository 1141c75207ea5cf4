// SPDX-License-Identifier: LGPL-2.1-or-later
#include "frame_assembler.hpp"

#include <algorithm>

#include "gst/base/pads/caps.hpp"

namespace inverse {
namespace {

void halve_rate(GstStructure* structure) {
  gint num = 0, den = 1;
  if (gst_structure_get_fraction(structure, "framerate", &num, &den) && num > 0) {
    if (den <= G_MAXINT / 2)
      gst_structure_set(structure, "framerate", GST_TYPE_FRACTION, num, den * 2, nullptr);
  } else if (num != 0 || gst_structure_has_field(structure, "framerate")) {
    if (!gst_structure_has_field_typed(structure, "framerate", GST_TYPE_FRACTION))
      gst_structure_remove_field(structure, "framerate");
  }
}

void double_width(GstStructure* structure) {
  gint width = 0;
  if (gst_structure_get_int(structure, "width", &width))
    gst_structure_set(structure, "width", G_TYPE_INT, std::min(width, G_MAXINT / 2) * 2, nullptr);
  else
    gst_structure_remove_field(structure, "width");
}

}  // namespace

GstCaps* assembled_caps(GstCaps* in, SyncParams::Assemble assemble) {
  if (assemble != SyncParams::Assemble::pairs || gst_caps_is_any(in)) return gst_caps_ref(in);
  GstCaps* plain = gst_caps_copy(in);
  for (guint i = 0; i < gst_caps_get_size(plain); ++i) {
    GstStructure* structure = gst_caps_get_structure(plain, i);
    double_width(structure);
    halve_rate(structure);
  }
  GstCaps* slower = gst_caps_copy(in);
  for (guint i = 0; i < gst_caps_get_size(slower); ++i)
    halve_rate(gst_caps_get_structure(slower, i));
  gst_caps_append(plain,
                  transform_caps(slower, template_caps(Flow::layers, kGradientLayers), nullptr));
  gst_caps_unref(slower);
  return plain;
}

bool FrameAssembler::set_caps(GstCaps* caps) {
  return gst_pad_push_event(src_, gst_event_new_caps(caps));
}

GstFlowReturn FrameAssembler::take(GstBuffer* buffer, const FrameLabel* label) {
  if (label) {
    buffer = gst_buffer_make_writable(buffer);  // its description alone is copied
    labels_->attach(buffer, *label);
  }
  return gst_pad_push(src_, buffer);
}

}  // namespace inverse
