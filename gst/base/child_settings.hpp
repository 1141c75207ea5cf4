// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/gst.h>

#include <vector>

#include "property_table.hpp"

namespace inverse {

/// The child objects of an element that have some of its properties (GstChildProxy): `strokes` has
/// "strokes::radius". An application may keep one for longer than the element; its properties then
/// have no effect.
class ChildSettings {
 public:
  /// `store` belongs to `owner` and lives as long as this.
  ChildSettings(GstElement* owner, PropertyStore& store);
  ChildSettings(const ChildSettings&) = delete;
  ChildSettings& operator=(const ChildSettings&) = delete;
  ~ChildSettings();

  const std::vector<GstObject*>& all() const { return children_; }
  guint count() const { return static_cast<guint>(children_.size()); }
  /// New reference; null if there is none of that index.
  GObject* at(guint index) const;
  /// Gives controlled properties their values at a stream time.
  void sync(GstClockTime time) const;

  /// Of GstChildProxy; `kOf` gives the ChildSettings of an element.
  template <ChildSettings& (*kOf)(gpointer)>
  static void init_interface(gpointer interface, gpointer) {
    auto* proxy = static_cast<GstChildProxyInterface*>(interface);
    proxy->get_child_by_index = [](GstChildProxy* element, guint index) {
      return kOf(element).at(index);
    };
    proxy->get_children_count = [](GstChildProxy* element) { return kOf(element).count(); };
  }

 private:
  std::vector<GstObject*> children_;
};

}  // namespace inverse
