// SPDX-License-Identifier: LGPL-2.1-or-later
#include "side_by_side.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "common/error.hpp"
#include "gst/base/pads/caps.hpp"
#include "gst/inverse/inverse_layers_meta.h"

namespace inverse {
namespace {

/// A width, a range of widths or a list of such, with `change(low, high)` applied to each.
template <typename Change>
void change_width(const GValue* from, GValue* to, Change change) {
  const bool range = GST_VALUE_HOLDS_INT_RANGE(from);
  if (range || G_VALUE_HOLDS_INT(from)) {
    const int low = range ? gst_value_get_int_range_min(from) : g_value_get_int(from);
    const int high = range ? gst_value_get_int_range_max(from) : low;
    const auto [smallest, largest] = change(low, high);
    g_value_init(to, smallest < largest ? GST_TYPE_INT_RANGE : G_TYPE_INT);
    if (smallest < largest)
      gst_value_set_int_range(to, smallest, largest);
    else
      g_value_set_int(to, smallest);
  } else if (GST_VALUE_HOLDS_LIST(from)) {
    g_value_init(to, GST_TYPE_LIST);
    for (guint i = 0; i < gst_value_list_get_size(from); ++i) {
      GValue one = G_VALUE_INIT;
      change_width(gst_value_list_get_value(from, i), &one, change);
      gst_value_list_append_and_take_value(to, &one);
    }
  } else {
    g_value_init(to, G_VALUE_TYPE(from));
    g_value_copy(from, to);
  }
}

/// The caps with the widths of all but layers changed. New reference.
template <typename Change>
GstCaps* with_widths(const GstCaps* caps, Change change) {
  GstCaps* result = gst_caps_copy(caps);
  for (guint i = 0; i < gst_caps_get_size(result); ++i) {
    GstStructure* structure = gst_caps_get_structure(result, i);
    const GValue* width = gst_structure_get_value(structure, "width");
    if (!width || gst_caps_features_contains(gst_caps_get_features(result, i),
                                             GST_CAPS_FEATURE_META_INVERSE_LAYERS))
      continue;
    GValue changed = G_VALUE_INIT;
    change_width(width, &changed, change);
    gst_structure_take_value(structure, "width", &changed);
  }
  return result;
}

}  // namespace

GstCaps* transform_side_by_side(GstPadDirection direction, GstCaps* caps, GstCaps* templates,
                                GstCaps* filter) {
  constexpr int n = kSideBySide;
  if (direction == GST_PAD_SINK) {
    GstCaps* narrow = with_widths(caps, [](int low, int high) {
      return std::pair{std::max(low / n, 1), std::max(high / n, 1)};
    });
    GstCaps* result = transform_caps(narrow, templates, filter);
    gst_caps_unref(narrow);
    return result;
  }
  constexpr int kMaxSize = 32767;
  const auto range = [](int low, int high) {
    return std::pair{std::min(low, kMaxSize / n) * n,
                     high > (kMaxSize - n + 1) / n ? kMaxSize : high * n + n - 1};
  };
  // Where one width goes out, who may choose is to choose what can be divided: that is first.
  GstCaps* wide = with_widths(caps, [range](int low, int high) {
    return low == high ? std::pair{range(low, high).first, range(low, high).first}
                       : range(low, high);
  });
  GstCaps* rest = with_widths(caps, [range](int low, int high) {
    auto [smallest, largest] = range(low, high);
    return std::pair{low == high ? std::min(smallest + 1, largest) : smallest, largest};
  });
  GstCaps *layers = gst_caps_new_empty(), *plain = gst_caps_new_empty();
  for (guint i = 0; i < gst_caps_get_size(templates); ++i) {
    const bool carries = gst_caps_features_contains(gst_caps_get_features(templates, i),
                                                    GST_CAPS_FEATURE_META_INVERSE_LAYERS);
    gst_caps_append(carries ? layers : plain, gst_caps_copy_nth(templates, i));
  }
  gst_caps_unref(templates);
  GstCaps* result = transform_caps(caps, layers, nullptr);
  result = gst_caps_merge(result, transform_caps(wide, gst_caps_ref(plain), nullptr));
  result = gst_caps_merge(result, transform_caps(rest, plain, nullptr));
  gst_caps_unref(wide);
  gst_caps_unref(rest);
  return filter_caps(result, filter);
}

void check_side_by_side(const char* element, const GstVideoInfo& in, const GstVideoInfo& out) {
  const int width = GST_VIDEO_INFO_WIDTH(&in);
  if (width % kSideBySide == 0 && width / kSideBySide == GST_VIDEO_INFO_WIDTH(&out)) return;
  throw Error(ErrorKind::unsupported,
              std::string(element) +
                  " takes plain frames of two pictures of one size side by side, "
                  "which frames " +
                  std::to_string(width) +
                  " pixels wide cannot hold; scale or crop before it, or send layers");
}

}  // namespace inverse
