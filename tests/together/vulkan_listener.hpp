// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gtest/gtest.h>

#include <cstdlib>
#include <mutex>
#include <string>
#include <vector>

extern "C" {  // 1.22 forgets to say so in gstvkqueue.h
#include <gst/vulkan/vulkan.h>
}

namespace inverse::testing {

/// What the validation layer says of the devices that GStreamer's Vulkan elements share with ours.
/// The application (this test) makes their instance, so that it can listen.
class Listener {
 public:
  static Listener& get() {
    static Listener listener;
    return listener;
  }
  static bool is_wanted() {
    const char* wanted = std::getenv("INVERSE_VALIDATION");
    return wanted && *wanted == '1';
  }

  /// Hands the instance to a pipeline, as an application does.
  void attach(GstElement* pipeline) {
    GstContext* context = gst_context_new(GST_VULKAN_INSTANCE_CONTEXT_TYPE_STR, TRUE);
    gst_context_set_vulkan_instance(context, instance_);
    gst_element_set_context(pipeline, context);
    gst_context_unref(context);
  }
  /// Fails the test for every complaint since the last call.
  void report() {
    std::vector<std::string> complaints;
    {
      std::lock_guard lock(mutex_);
      complaints.swap(complaints_);
    }
    for (const std::string& complaint : complaints) ADD_FAILURE() << complaint;
  }

 private:
  Listener() : instance_(gst_vulkan_instance_new()) {
    EXPECT_TRUE(gst_vulkan_instance_fill_info(instance_, nullptr));
    EXPECT_TRUE(gst_vulkan_instance_enable_layer(instance_, "VK_LAYER_KHRONOS_validation"))
        << "INVERSE_VALIDATION=1 asks for the validation layer, which is not installed";
    EXPECT_TRUE(gst_vulkan_instance_enable_extension(instance_, VK_EXT_DEBUG_UTILS_EXTENSION_NAME));
    EXPECT_TRUE(gst_vulkan_instance_open(instance_, nullptr));
    VkDebugUtilsMessengerCreateInfoEXT info{
        VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT};
    info.messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
    info.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT;
    info.pUserData = this;
    info.pfnUserCallback =
        [](VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
           const VkDebugUtilsMessengerCallbackDataEXT* message, void* self) -> VkBool32 {
      static_cast<Listener*>(self)->hear(message);
      return VK_FALSE;
    };
    const auto create = reinterpret_cast<PFN_vkCreateDebugUtilsMessengerEXT>(
        vkGetInstanceProcAddr(instance_->instance, "vkCreateDebugUtilsMessengerEXT"));
    VkDebugUtilsMessengerEXT messenger = VK_NULL_HANDLE;
    EXPECT_EQ(create(instance_->instance, &info, nullptr, &messenger), VK_SUCCESS);
  }

  void hear(const VkDebugUtilsMessengerCallbackDataEXT* message) {
    const std::string id = message->pMessageIdName ? message->pMessageIdName : "";
    // GStreamer's own render passes (1.22).
    if (id == "VUID-VkAttachmentDescription-format-06699") return;
    std::lock_guard lock(mutex_);
    complaints_.push_back(message->pMessage);
  }

  GstVulkanInstance* instance_;  // as long as the process
  std::mutex mutex_;
  std::vector<std::string> complaints_;
};

}  // namespace inverse::testing
