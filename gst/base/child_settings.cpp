// SPDX-License-Identifier: LGPL-2.1-or-later
#include "child_settings.hpp"

#include <memory>
#include <string>

#include "meta/registered_once.hpp"

namespace inverse {
namespace {

constexpr guint kFirst = 1;  // id of the first property

struct Child {
  GstObject parent;
  GWeakRef owner;
  PropertyStore* store;  // of the owner, while that exists
};

Child& child_of(gpointer object) { return *static_cast<Child*>(object); }
gpointer parent_class = nullptr;

/// The element that a child belongs to, kept alive; null if it is gone.
std::unique_ptr<GstElement, void (*)(gpointer)> owner_of(GObject* child) {
  return {static_cast<GstElement*>(g_weak_ref_get(&child_of(child).owner)), gst_object_unref};
}

void get_property(GObject* object, guint id, GValue* value, GParamSpec* spec) {
  if (const auto owner = owner_of(object))
    child_of(object).store->get(id - kFirst, value);
  else
    g_param_value_set_default(spec, value);
}

void set_property(GObject* object, guint id, const GValue* value, GParamSpec*) {
  if (const auto owner = owner_of(object))
    set_parameter(log_of(owner.get()), *child_of(object).store, id - kFirst, value);
}

/// The type of the child `name` of elements like `owner`; `store` has their properties.
GType child_type(GstElement* owner, const PropertyStore& store, const std::string& name) {
  const std::string type_name = std::string(G_OBJECT_TYPE_NAME(owner)) +
                                static_cast<char>(g_ascii_toupper(name[0])) + name.substr(1);
  return type_registered_once(type_name.c_str(), [&] {
    GTypeQuery base;
    g_type_query(GST_TYPE_OBJECT, &base);
    struct Data {
      const PropertyStore& store;
      const std::string& name;
    } data{store, name};
    GTypeInfo info{};
    info.class_size = static_cast<guint16>(base.class_size);
    info.class_init = [](gpointer klass, gpointer all) {
      parent_class = g_type_class_peek_parent(klass);
      auto* object = G_OBJECT_CLASS(klass);
      object->get_property = get_property;
      object->set_property = set_property;
      object->finalize = [](GObject* child) {
        g_weak_ref_clear(&child_of(child).owner);
        G_OBJECT_CLASS(parent_class)->finalize(child);
      };
      static_cast<Data*>(all)->store.install(object, kFirst, static_cast<Data*>(all)->name);
    };
    info.class_data = &data;
    info.instance_size = sizeof(Child);
    info.instance_init = [](GTypeInstance* instance, gpointer) {
      g_weak_ref_init(&child_of(instance).owner, nullptr);
    };
    const GType type = g_type_register_static(GST_TYPE_OBJECT, type_name.c_str(), &info,
                                              static_cast<GTypeFlags>(0));
    g_type_class_ref(type);  // while `data` exists; the class of a static type stays
    return type;
  });
}

}  // namespace

ChildSettings::ChildSettings(GstElement* owner, PropertyStore& store) {
  for (const std::string& name : store.children()) {
    auto* child = static_cast<GstObject*>(
        g_object_new(child_type(owner, store, name), "name", name.c_str(), nullptr));
    g_weak_ref_set(&child_of(child).owner, owner);
    child_of(child).store = &store;
    gst_object_set_parent(child, GST_OBJECT(owner));  // takes the reference
    children_.push_back(child);
  }
}

ChildSettings::~ChildSettings() {
  for (GstObject* child : children_) gst_object_unparent(child);
}

GObject* ChildSettings::at(guint index) const {
  return index < count() ? G_OBJECT(gst_object_ref(children_[index])) : nullptr;
}

void ChildSettings::sync(GstClockTime time) const {
  for (GstObject* child : children_) gst_object_sync_values(child, time);
}

}  // namespace inverse
