// SPDX-License-Identifier: LGPL-2.1-or-later
#include "missing_layers.hpp"

#include <algorithm>
#include <memory>
#include <vector>

#include "caps.hpp"
#include "gst/inverse/inverse_layers_meta.h"
#include "pads.hpp"

namespace inverse {
namespace {

struct UnrefCaps {
  void operator()(GstCaps* caps) const { gst_caps_unref(caps); }
};
using CapsPtr = std::unique_ptr<GstCaps, UnrefCaps>;

constexpr int kFarthest = 64;  // elements between

/// Caps of all layers of these kinds.
CapsPtr layers_of_kinds(const char* kinds) { return CapsPtr(template_caps(Flow::layers, kinds)); }

/// Those of a pad's template that are of layers; null if it takes anything or none.
CapsPtr template_layers(GstPad* pad) {
  const CapsPtr all(gst_pad_get_pad_template_caps(pad));
  if (gst_caps_is_any(all.get())) return nullptr;
  CapsPtr layers(gst_caps_new_empty());
  for (guint i = 0; i < gst_caps_get_size(all.get()); ++i)
    if (gst_caps_features_contains(gst_caps_get_features(all.get(), i),
                                   GST_CAPS_FEATURE_META_INVERSE_LAYERS))
      gst_caps_append(layers.get(), gst_caps_copy_nth(all.get(), i));
  return gst_caps_is_empty(layers.get()) ? nullptr : std::move(layers);
}

bool sends_only_layers(GstPad* src) {
  const CapsPtr all(gst_pad_get_pad_template_caps(src)), layers = template_layers(src);
  return layers && gst_caps_get_size(layers.get()) == gst_caps_get_size(all.get()) &&
         !gst_caps_features_is_any(gst_caps_get_features(all.get(), 0));
}

bool takes_anything(GstPad* pad) {
  const CapsPtr all(gst_pad_get_pad_template_caps(pad));
  return gst_caps_is_any(all.get());
}

/// Whether layers could flow into this pad and on from there.
bool takes_layers(GstPad* sink, GstCaps* layers) {
  const CapsPtr taken(gst_pad_query_caps(sink, layers));
  return !gst_caps_is_empty(taken.get());
}

/// Who refuses layers in a branch: the last element that does, and the first one there that is no
/// queue or the like.
struct Refusal {
  ElementPtr element, first;
};

/// So for layers that come in at `sink`. `known` leads to who takes them.
Refusal refusing(GstPad* sink, GstPad* known, GstCaps* layers, int distance = 0) {
  if (distance < kFarthest)
    for (const PadPtr& src : pads_behind(sink)) {
      if (src.get() == known) continue;
      const PadPtr next = linked_pad(src.get());
      if (!next || takes_layers(next.get(), layers)) continue;
      Refusal found = refusing(next.get(), nullptr, layers, distance + 1);
      if (!takes_anything(sink)) found.first = element_of_pad(sink);
      return found;
    }
  return {element_of_pad(sink), element_of_pad(sink)};
}

/// What is found upstream of an element.
struct Found {
  ElementPtr maker;     ///< makes layers from pictures
  CapsPtr made;         ///< these layers
  ElementPtr composer;  ///< makes pictures of layers, nearer than any maker
  Refusal refusal;      ///< of layers, if they are refused
  ElementPtr splits;    ///< the element whose branch that is in, or null
};

Found search(GstPad* sink, GstCaps* layers) {
  Found found;
  PadPtr at(GST_PAD(gst_object_ref(sink)));
  for (int distance = 0; distance < kFarthest; ++distance) {
    const PadPtr src = linked_pad(at.get());
    if (!src) break;
    ElementPtr element = element_of_pad(src.get());
    std::vector<PadPtr> before = pads_behind(src.get());
    if (before.empty()) break;  // a source
    at = std::move(before.front());
    CapsPtr makes = template_layers(src.get());
    const CapsPtr takes = template_layers(at.get());
    if (makes && !takes) {
      found.made = std::move(makes);
      found.maker = std::move(element);
      break;
    }
    if (takes && !makes && !takes_anything(src.get()) &&
        gst_caps_can_intersect(takes.get(), layers)) {
      found.composer = std::move(element);
      break;
    }
    if (!found.refusal.element && !takes_layers(at.get(), layers)) {
      found.refusal = refusing(at.get(), src.get(), layers);
      if (found.refusal.element != element) found.splits = std::move(element);
    }
  }
  return found;
}

/// Of a pad that takes both.
bool prefers_pixels(GstPad* pad) {
  const CapsPtr all(gst_pad_get_pad_template_caps(pad));
  return !carries_layers(all.get());
}

bool wants_layers(GstPad* src, int distance) {
  const PadPtr next = linked_pad(src);
  if (!next || distance == kFarthest) return false;
  if (!takes_anything(next.get()) && !(template_layers(next.get()) && prefers_pixels(next.get())))
    return template_layers(next.get()) != nullptr;
  const std::vector<PadPtr> further = pads_behind(next.get());
  return std::any_of(further.begin(), further.end(),
                     [&](const PadPtr& pad) { return wants_layers(pad.get(), distance + 1); });
}

}  // namespace

std::string contents_of(const std::string& kind) {
  if (kind == kIntrinsicLayers) return "reflectance and shading";
  if (kind == kGlobalLayers) return "reflectance, direct light and indirect light";
  if (kind == kMaterialLayers)
    return "an object's mask, highlights, mirror image and diffuse light";
  if (kind == kGradientLayers) return "a subject under two gradients of a light stage";
  return {};
}

std::string contents_of(const Layers& layers) {
  return contents_of(std::string(layers.gradients()  ? kGradientLayers
                                 : layers.material() ? kMaterialLayers
                                 : layers.global()   ? kGlobalLayers
                                                     : kIntrinsicLayers));
}

std::string missing_layers(GstPad* sink, const char* accepts, const char* maker) {
  const CapsPtr layers = layers_of_kinds(accepts);
  const ElementPtr element = element_of_pad(sink);
  const GstElementFactory* factory = element ? gst_element_get_factory(element.get()) : nullptr;
  const std::string name = factory ? GST_OBJECT_NAME(factory) : label_of(element.get());
  const std::string start = name + " works on layers";
  const Found found = search(sink, layers.get());
  if (found.composer)
    return start + ", and " + label_of(found.composer.get()) +
           " before it sends pictures; remove " + label_of(found.composer.get()) + ", or put " +
           name + " before it";
  if (!found.maker)
    return start + "; insert " + maker +
           " before it, with nothing between the two that takes pictures or other layers (behind "
           "a tee every branch must take layers)";
  const std::string made_by = label_of(found.maker.get());
  if (!gst_caps_can_intersect(found.made.get(), layers.get())) {
    const std::string contents = contents_of(kind_of(found.made.get()));
    return start + " of another kind than those of " + made_by + " before it" +
           (contents.empty() ? "" : ", which are " + contents) + "; put " + maker +
           " in the place of " + made_by + ", or between the two";
  }
  if (found.splits)
    return start + ", and " + made_by + " sends pictures, because " +
           label_of(found.refusal.element.get()) + " in another branch of " +
           label_of(found.splits.get()) + " takes nothing else; put intrinsiccompose before " +
           label_of(found.refusal.first.get());
  if (found.refusal.element)
    return start + ", and " + label_of(found.refusal.element.get()) + " between " + made_by +
           " and it takes pictures only; remove it, or move it behind intrinsiccompose";
  return start + ", and " + made_by +
         " before it sends pictures; put nothing between the two that takes pictures or other "
         "layers";
}

bool wants_layers(GstPad* src) { return wants_layers(src, 0); }

std::string untaken_layers(GstPad* src) {
  const CapsPtr layers = layers_of_kinds(kAllLayers);
  ElementPtr editor;
  std::string refuses;
  PadPtr at(GST_PAD(gst_object_ref(src)));
  for (int distance = 0; at && distance < kFarthest; ++distance) {
    const PadPtr next = linked_pad(at.get());
    if (!next) break;
    if (sends_only_layers(at.get())) editor = element_of_pad(at.get());
    if (editor && takes_layers(next.get(), layers.get())) break;
    if (editor) {
      const ElementPtr element = element_of_pad(next.get());
      refuses = element ? label_of(element.get()) : "what follows it";
    }
    const bool takes = template_layers(next.get()) != nullptr;
    at.reset();
    for (PadPtr& further : pads_behind(next.get())) {
      if (takes && !template_layers(further.get())) return {};  // it makes pictures of them
      const PadPtr peer = linked_pad(further.get());
      if (!at && peer && (!editor || !takes_layers(peer.get(), layers.get())))
        at = std::move(further);
    }
  }
  if (refuses.empty()) return {};
  return label_of(editor.get()) + " sends layers, and " + refuses +
         " takes pictures only; insert intrinsiccompose behind " + label_of(editor.get());
}

}  // namespace inverse
