// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/gst.h>

#include <type_traits>

#include "gst/base/log/log.hpp"
#include "property_table.hpp"

namespace inverse {

/// The GObject class of an element that is no Filter. `Instance` begins with the instance struct of
/// the parent class; its `body` points to what implements the element.
template <typename Instance>
struct ElementClass {
  using Body = std::remove_pointer_t<decltype(Instance::body)>;

  const char *factory, *type_name, *long_name, *klass, *description;
  GType (*parent)();
  void (*class_init)(GstElementClass* element);
  /// Makes the body.
  void (*instance_init)(Instance* self);

  static inline gpointer parent_class = nullptr;
  static Body& body_of(gpointer object) { return *static_cast<Instance*>(object)->body; }

  /// `this` must live as long as the process.
  gboolean register_element(GstPlugin* plugin) const {
    debug_category(factory, description);
    GTypeQuery base;
    g_type_query(parent(), &base);
    GTypeInfo info{};
    info.class_size = static_cast<guint16>(base.class_size);
    info.class_init = [](gpointer klass, gpointer data) {
      self = static_cast<const ElementClass*>(data);
      parent_class = g_type_class_peek_parent(klass);
      G_OBJECT_CLASS(klass)->finalize = [](GObject* object) {
        delete &body_of(object);
        G_OBJECT_CLASS(parent_class)->finalize(object);
      };
      gst_element_class_set_static_metadata(GST_ELEMENT_CLASS(klass), self->long_name, self->klass,
                                            self->description, "the gst-inverse authors");
      self->class_init(GST_ELEMENT_CLASS(klass));
    };
    info.class_data = this;
    info.instance_size = sizeof(Instance);
    info.instance_init = [](GTypeInstance* instance, gpointer) {
      self->instance_init(reinterpret_cast<Instance*>(instance));
    };
    const GType type =
        g_type_register_static(base.type, type_name, &info, static_cast<GTypeFlags>(0));
    return gst_element_register(plugin, factory, GST_RANK_NONE, type);
  }

  /// For `class_init` of an element whose body has `stats()` and `parameters()` of `table`:
  /// installs these properties.
  template <typename P>
  static void install_properties(GstElementClass* element, const char* stats_blurb,
                                 const PropertyTable<P>& table) {
    static constexpr guint kStats = 1, kTable = 10;
    auto* object = G_OBJECT_CLASS(element);
    object->get_property = [](GObject* owner, guint id, GValue* value, GParamSpec*) {
      if (id >= kTable)
        body_of(owner).parameters().get(id - kTable, value);
      else
        g_value_take_boxed(value, body_of(owner).stats());
    };
    object->set_property = [](GObject* owner, guint id, const GValue* value, GParamSpec*) {
      set_parameter(log_of(GST_ELEMENT(owner)), body_of(owner).parameters(), id - kTable, value);
    };
    g_object_class_install_property(
        object, kStats,
        g_param_spec_boxed("stats", "stats", stats_blurb, GST_TYPE_STRUCTURE,
                           static_cast<GParamFlags>(G_PARAM_READABLE | G_PARAM_STATIC_STRINGS)));
    install_parameters(element, Parameters<P>(table), kTable);
  }

 private:
  static inline const ElementClass* self = nullptr;
};

/// Adds a pad template; takes over `caps`.
inline void add_pad_template(GstElementClass* element, const char* name, GstPadDirection direction,
                             GstPadPresence presence, GstCaps* caps) {
  gst_element_class_add_pad_template(element,
                                     gst_pad_template_new(name, direction, presence, caps));
  gst_caps_unref(caps);
}

}  // namespace inverse
