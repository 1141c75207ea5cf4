#include "device_context.hpp"

namespace inverse {
namespace {

using DevicePtr = std::shared_ptr<gpu::Device>;

GType device_type() {
  static const GType type = g_boxed_type_register_static(
      "GstInverseDevice",
      [](gpointer device) -> gpointer { return new DevicePtr(*static_cast<DevicePtr*>(device)); },
      [](gpointer device) { delete static_cast<DevicePtr*>(device); });
  return type;
}

GstContext* context_with(const DevicePtr& device) {
  GstContext* context = gst_context_new(kDeviceContext, TRUE);
  gst_structure_set(gst_context_writable_structure(context), "device", device_type(), &device,
                    "name", G_TYPE_STRING, device->name().c_str(), nullptr);
  return context;
}

DevicePtr device_in(GstContext* context) {
  if (!context || !gst_context_has_context_type(context, kDeviceContext)) return nullptr;
  const GValue* value = gst_structure_get_value(gst_context_get_structure(context), "device");
  return value && G_VALUE_HOLDS(value, device_type())
             ? *static_cast<DevicePtr*>(g_value_get_boxed(value))
             : nullptr;
}

/// Asks the neighbours on all pads of one direction.
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

std::shared_ptr<gpu::Device> DeviceContext::acquire(GstElement* element,
                                                    const std::string& select) {
  DevicePtr device;
  if (select.empty()) {
    {
      std::lock_guard lock(mutex_);
      device = offered_;
    }
    if (!device) device = ask(element, GST_PAD_SRC);
    if (!device) device = ask(element, GST_PAD_SINK);
  }
  if (!device && select.empty()) {
    gst_element_post_message(element,
                             gst_message_new_need_context(GST_OBJECT(element), kDeviceContext));
    std::lock_guard lock(mutex_);
    device = offered_;
  }
  const bool ours = !device;
  if (ours) device = gpu::Device::open(select);
  {
    std::lock_guard lock(mutex_);
    device_ = device;
  }
  if (ours) {
    GstContext* context = context_with(device);
    gst_element_set_context(element, context);
    gst_element_post_message(element, gst_message_new_have_context(GST_OBJECT(element), context));
  }
  return device;
}

void DeviceContext::release() {
  std::lock_guard lock(mutex_);
  device_.reset();
  offered_.reset();
}

void DeviceContext::set_context(GstContext* context) {
  if (DevicePtr device = device_in(context)) {
    std::lock_guard lock(mutex_);
    offered_ = std::move(device);
  }
}

bool DeviceContext::answer(GstQuery* query) {
  const gchar* type = nullptr;
  gst_query_parse_context_type(query, &type);
  if (g_strcmp0(type, kDeviceContext) != 0) return false;
  DevicePtr device;
  {
    std::lock_guard lock(mutex_);
    device = device_;
  }
  if (!device) return false;
  GstContext* context = context_with(device);
  gst_query_set_context(query, context);
  gst_context_unref(context);
  return true;
}

}  // namespace inverse
