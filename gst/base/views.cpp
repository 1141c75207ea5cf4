// SPDX-License-Identifier: LGPL-2.1-or-later
#include "views.hpp"

#include <algorithm>

#include "gst/base/pads/pads.hpp"

namespace inverse {

std::string misplaced_view(GstElement* element, const Filter& filter, GstBuffer* in) {
  const auto mark = view_mark(in);
  if (!mark || filter.takes_view(mark->layer)) return {};
  return label_of(element) + " gets the picture \"" + mark->layer + "\" of " + mark->element +
         " in place of a frame, so its result is wrong; remove one of the two, or " + mark->frame +
         " of " + mark->element;
}

void mark_shown(GstElement* element, const Filter& filter, GstBuffer* out) {
  const auto frames = filter.shows_frame();
  if (frames.empty()) return;
  GValue show = G_VALUE_INIT;
  g_object_get_property(G_OBJECT(element), "show", &show);
  auto* values = static_cast<GEnumClass*>(g_type_class_peek(G_VALUE_TYPE(&show)));
  const std::string layer = g_enum_get_value(values, g_value_get_enum(&show))->value_nick;
  g_value_unset(&show);
  if (std::ranges::find(frames, layer) == frames.end())
    mark_view(out, {label_of(element), layer, std::string("set show=") + frames.front()});
}

}  // namespace inverse
