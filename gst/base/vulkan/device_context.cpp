// SPDX-License-Identifier: LGPL-2.1-or-later
#include "device_context.hpp"

#include "common/error.hpp"
#include "gst/base/build_stamp.hpp"
#include "gst/base/log/log.hpp"
#include "gst/base/meta/registered_once.hpp"

namespace inverse {
namespace {

using DevicePtr = std::shared_ptr<gpu::Device>;

GType device_type() {
  constexpr const char* kName = "GstInverseDevice-" BUILD_STAMP;
  static const GType type = type_registered_once(kName, [] {
    return g_boxed_type_register_static(
        kName,
        [](gpointer device) -> gpointer { return new DevicePtr(*static_cast<DevicePtr*>(device)); },
        [](gpointer device) { delete static_cast<DevicePtr*>(device); });
  });
  return type;
}

/// What stands at the top of an element's family: its pipeline. Only ever compared.
gpointer family_of(GstElement* element) {
  GstObject* top = GST_OBJECT(gst_object_ref(element));
  while (GstObject* parent = gst_object_get_parent(top)) {
    gst_object_unref(top);
    top = parent;
  }
  gst_object_unref(top);
  return top;
}

GstContext* context_with(const DevicePtr& device, GstElement* element) {
  GstContext* context = gst_context_new(kDeviceContext, TRUE);
  gst_structure_set(gst_context_writable_structure(context), "device", device_type(), &device,
                    "name", G_TYPE_STRING, device->name().c_str(), "family", G_TYPE_POINTER,
                    family_of(element), nullptr);
  return context;
}

/// The pipeline in which a context was made.
gpointer family_in(GstContext* context) {
  gpointer family = nullptr;
  gst_structure_get(gst_context_get_structure(context), "family", G_TYPE_POINTER, &family, nullptr);
  return family;
}

DevicePtr device_in(GstContext* context) {
  if (!context || !gst_context_has_context_type(context, kDeviceContext)) return nullptr;
  const GValue* value = gst_structure_get_value(gst_context_get_structure(context), "device");
  if (!value || !G_VALUE_HOLDS(value, device_type())) return nullptr;
  const DevicePtr& device = *static_cast<DevicePtr*>(g_value_get_boxed(value));
  return device->lost() ? nullptr : device;  // who starts again after a loss gets another
}

/// What the application has set on the element and GStreamer keeps for it, from NULL to NULL: the
/// context that names a device, if that is from outside the pipeline. New reference, or null.
GstContext* context_from_outside(GstElement* element, gpointer family) {
  GstContext* context = gst_element_get_context(element, kDeviceContext);
  if (context && family_in(context) != family && device_in(context)) return context;
  if (context) gst_context_unref(context);  // one that we announced ourselves
  return nullptr;
}

/// Asks the neighbors on all pads of one direction.
DevicePtr ask(GstElement* element, GstPadDirection direction) {
  GstQuery* query = gst_query_new_context(kDeviceContext);
  struct Search {
    GstQuery* query;
    GstPadDirection direction;
    DevicePtr found;
  } search{query, direction, nullptr};
  gst_element_foreach_pad(
      element,
      [](GstElement*, GstPad* pad, gpointer data) -> gboolean {
        auto& search = *static_cast<Search*>(data);
        if (GST_PAD_DIRECTION(pad) != search.direction || !gst_pad_peer_query(pad, search.query))
          return TRUE;
        GstContext* context = nullptr;
        gst_query_parse_context(search.query, &context);
        search.found = device_in(context);
        return !search.found;
      },
      &search);
  gst_query_unref(query);
  return search.found;
}

}  // namespace

void DeviceContext::acquire(const std::string& select) {
  DevicePtr device;
  Demand demand = select.empty() ? Demand::none : Demand::property;
  const gpointer family = family_of(element_);
  const auto take_offered = [&] {
    std::lock_guard lock(mutex_);
    device = offered_ && !offered_->lost() ? offered_ : nullptr;
    if (device && offered_family_ != family) demand = Demand::application;
  };
  if (select.empty()) {
    if (GstContext* context = context_from_outside(element_, family)) {
      set_context(context);
      gst_context_unref(context);
    }
    take_offered();
    if (!device) device = neighbor_.find(element_, VulkanNeighbor::Ask::what_there_is);
    if (!device) device = ask(element_, GST_PAD_SRC);
    if (!device) device = ask(element_, GST_PAD_SINK);
    if (!device) {
      gst_element_post_message(element_,
                               gst_message_new_need_context(GST_OBJECT(element_), kDeviceContext));
      take_offered();
    }
  }
  const bool ours = !device;
  if (ours) device = gpu::Device::open(select, family);
  GST_CAT_INFO_OBJECT(log_of(element_).category, element_, "device \"%s\": %s",
                      device->name().c_str(),
                      !ours                        ? "shared with the application or a neighbor"
                      : demand == Demand::property ? "opened as the property device names it"
                                                   : "opened, as no element shares one");
  {
    std::lock_guard lock(mutex_);
    device_ = device;
    demand_ = demand;
  }
  if (ours) {
    GstContext* context = context_with(device, element_);
    gst_element_set_context(element_, context);
    gst_element_post_message(element_, gst_message_new_have_context(GST_OBJECT(element_), context));
  }
}

void DeviceContext::renew(const std::string& select) {
  const DevicePtr now = current();
  if (!now || !now->lost()) return;
  neighbor_.release();
  bool had = false;  // elements that need layers have none
  {
    std::lock_guard lock(mutex_);
    had = device_ != nullptr;
  }
  if (had) acquire(select);
}

void DeviceContext::release() {
  neighbor_.release();
  std::lock_guard lock(mutex_);
  device_.reset();
  offered_.reset();
  demand_ = Demand::none;
}

bool DeviceContext::permitted(const gpu::Device& device) const {
  switch (demand_) {
    case Demand::none:
      return true;
    case Demand::property:
      return same_hardware(device, *device_);
    case Demand::application:
      return device_.get() == &device;
  }
  return false;
}

void DeviceContext::permit(const DevicePtr& device) const {
  std::lock_guard lock(mutex_);
  if (permitted(*device)) return;
  throw Error(
      ErrorKind::no_device,
      "this pipeline needs two Vulkan devices at once: neighboring elements have their "
      "images on \"" +
          device->name() + "\", and " +
          (demand_ == Demand::property
               ? "the property device demands \"" + device_->name() +
                     "\"; leave device empty or choose the neighbors' there"
               : "the application set another one as the context " + std::string(kDeviceContext) +
                     "; set none, or put vulkandownload and vulkanupload between"));
}

void DeviceContext::find_neighbor() { neighbor_.find(element_, VulkanNeighbor::Ask::make_one); }

DevicePtr DeviceContext::current() const {
  const DevicePtr theirs = neighbor_.held();
  std::lock_guard lock(mutex_);
  return theirs && permitted(*theirs) ? theirs : device_;
}

DevicePtr DeviceContext::for_images() {
  DevicePtr theirs = neighbor_.held();
  if (!theirs) {
    DevicePtr like;
    {
      std::lock_guard lock(mutex_);
      like = device_;
    }
    if (!like)
      throw Error(ErrorKind::no_device,
                  "no element provides a device for memory:VulkanImage; use system memory, or end "
                  "with vulkandownload or vulkansink");
    theirs = neighbor_.make(element_, *like);
  }
  permit(theirs);
  return theirs;
}

void DeviceContext::set_context(GstContext* context) {
  if (!context) return;
  neighbor_.set_context(element_, context);
  if (DevicePtr device = device_in(context)) {
    // A bin may hold its lock while it calls this: nothing above the element is read here.
    std::lock_guard lock(mutex_);
    offered_ = std::move(device);
    offered_family_ = family_in(context);
  }
}

bool DeviceContext::answer(GstQuery* query) {
  if (const DevicePtr theirs = neighbor_.held(); theirs && !theirs->lost() && theirs == current())
    if (neighbor_.answer(element_, query)) return true;
  const gchar* type = nullptr;
  gst_query_parse_context_type(query, &type);
  if (g_strcmp0(type, kDeviceContext) != 0) return false;
  const DevicePtr device = current();
  if (!device) return false;
  GstContext* context = context_with(device, element_);
  gst_query_set_context(query, context);
  gst_context_unref(context);
  return true;
}

bool DeviceContext::provide(GstQuery* query) {
  if (!VulkanNeighbor::asks_for_device(query)) return false;
  DevicePtr like;
  {
    std::lock_guard lock(mutex_);
    // What the application demands is not ours to replace.
    if (demand_ != Demand::application) like = device_;
  }
  if (!like) return false;
  try {
    neighbor_.make(element_, *like);
  } catch (const std::exception& error) {
    // They will open one of their own; whether that does is decided with the caps.
    GST_CAT_WARNING_OBJECT(log_of(element_).category, element_, "%s", error.what());
    return false;
  }
  return answer(query);
}

}  // namespace inverse
