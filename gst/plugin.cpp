// SPDX-License-Identifier: LGPL-2.1-or-later
// The list of elements, nothing else. HAVE_…: the options that this build has.
#include "gst/base/filter.hpp"
#include "gst/base/meta/layers_meta.hpp"
#include "gst/material/meta/material_meta.hpp"
#include "gst/rgbd/meta/depth_meta.hpp"

namespace inverse {
extern const ElementInfo kGlobalIntrinsic;
extern const ElementInfo kGlobalIntrinsicThesis;
extern const ElementInfo kIntrinsicCompose;
extern const ElementInfo kIntrinsicDecomp;
extern const ElementInfo kIntrinsicDecompThesis;
extern const ElementInfo kIntrinsicDespill;
extern const ElementInfo kIntrinsicMerge;
extern const ElementInfo kIntrinsicKey;
extern const ElementInfo kIntrinsicRecolor;
extern const ElementInfo kIntrinsicRelight;
extern const ElementInfo kIntrinsicSelect;
extern const ElementInfo kIntrinsicStylize;
extern const ElementInfo kIntrinsicTone;
extern const ElementInfo kLimeMaterial;
gboolean register_intrinsicedit(GstPlugin* plugin);
gboolean register_intrinsicsplit(GstPlugin* plugin);
gboolean register_rgbdmerge(GstPlugin* plugin);
gboolean register_rgbdsrc(GstPlugin* plugin);
gboolean register_rgbdtestsrc(GstPlugin* plugin);
}  // namespace inverse

static gboolean plugin_init(GstPlugin* plugin) {
  inverse::register_layers_meta();
  for (const inverse::ElementInfo* element : {
           &inverse::kIntrinsicDecomp,
           &inverse::kGlobalIntrinsic,
           &inverse::kIntrinsicSelect,
           &inverse::kIntrinsicRecolor,
           &inverse::kIntrinsicDespill,
           &inverse::kIntrinsicKey,
           &inverse::kIntrinsicTone,
           &inverse::kIntrinsicStylize,
           &inverse::kIntrinsicRelight,
           &inverse::kIntrinsicMerge,
           &inverse::kIntrinsicCompose,
#ifdef HAVE_THESIS
           &inverse::kIntrinsicDecompThesis,
           &inverse::kGlobalIntrinsicThesis,
#endif
#ifdef HAVE_MATERIAL
           &inverse::kLimeMaterial,
#endif
       })
    if (!inverse::register_filter(plugin, *element)) return FALSE;
#ifdef HAVE_MATERIAL
  inverse::register_material_meta();
#endif
#ifdef HAVE_DEPTH
  inverse::register_depth_meta();
  if (!inverse::register_rgbdmerge(plugin) || !inverse::register_rgbdsrc(plugin) ||
      !inverse::register_rgbdtestsrc(plugin))
    return FALSE;
#endif
  return inverse::register_intrinsicsplit(plugin) && inverse::register_intrinsicedit(plugin);
}

GST_PLUGIN_DEFINE(
    GST_VERSION_MAJOR, GST_VERSION_MINOR, inverse,
    "Decomposes live video into reflectance and shading, and lets edits touch the layers",
    plugin_init, VERSION, "LGPL", "gst-inverse", "Unknown package origin")
