// SPDX-License-Identifier: LGPL-2.1-or-later
#include "child_settings.hpp"

#include <mutex>
#include <string>

#include "meta/registered_once.hpp"

namespace inverse {
namespace {

constexpr guint kFirst = 1;  // id of the first property

struct Child {
  GstObject parent;
  std::mutex* mutex;
  GstElement* owner;     // null: it is gone
  PropertyStore* store;  // of it
};

Child& child_of(gpointer object) { return *static_cast<Child*>(object); }
gpointer parent_class = nullptr;

void get_property(GObject* object, guint id, GValue* value, GParamSpec* spec) {
  const std::lock_guard lock(*child_of(object).mutex);
  if (child_of(object).owner)
    child_of(object).store->get(id - kFirst, value);
  else
    g_param_value_set_default(spec, value);
}

void set_property(GObject* object, guint id, const GValue* value, GParamSpec*) {
  const std::lock_guard lock(*child_of(object).mutex);
  if (GstElement* owner = child_of(object).owner)
    set_parameter(log_of(owner), *child_of(object).store, id - kFirst, value);
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
        delete child_of(child).mutex;
        G_OBJECT_CLASS(parent_class)->finalize(child);
      };
      static_cast<Data*>(all)->store.install(object, kFirst, static_cast<Data*>(all)->name);
    };
    info.class_data = &data;
    info.instance_size = sizeof(Child);
    info.instance_init = [](GTypeInstance* instance, gpointer) {
      child_of(instance).mutex = new std::mutex;
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
    child_of(child).owner = owner;
    child_of(child).store = &store;
    gst_object_set_parent(child, GST_OBJECT(owner));  // takes the reference
    children_.push_back(child);
  }
}

ChildSettings::~ChildSettings() {
  for (GstObject* child : children_) {
    {
      const std::lock_guard lock(*child_of(child).mutex);
      child_of(child).owner = nullptr;
    }
    gst_object_unparent(child);
  }
}

GObject* ChildSettings::at(guint index) const {
  return index < count() ? G_OBJECT(gst_object_ref(children_[index])) : nullptr;
}

void ChildSettings::sync(GstClockTime time) const {
  for (GstObject* child : children_) gst_object_sync_values(child, time);
}

}  // namespace inverse
