// SPDX-License-Identifier: LGPL-2.1-or-later
// The Vulkan bridge of a build without GStreamer's Vulkan library: there are no such neighbors,
// and no template lets images in or out.
#include "gst/base/frames/frame_io.hpp"
#include "vulkan_bridge.hpp"

namespace inverse {
namespace {

[[noreturn]] void refuse() {
  throw Error(ErrorKind::unsupported,
              "built without memory:VulkanImage; configure with -Dvulkan-memory=enabled");
}

}  // namespace

bool has_vulkan_images() { return false; }

struct VulkanNeighbor::Contexts {};
VulkanNeighbor::VulkanNeighbor() = default;
VulkanNeighbor::~VulkanNeighbor() = default;
std::shared_ptr<gpu::Device> VulkanNeighbor::find(GstElement*, Ask) { return nullptr; }
std::shared_ptr<gpu::Device> VulkanNeighbor::make(GstElement*, const gpu::Device&) { refuse(); }
std::shared_ptr<gpu::Device> VulkanNeighbor::held() const { return nullptr; }
void VulkanNeighbor::set_context(GstElement*, GstContext*) {}
bool VulkanNeighbor::answer(GstElement*, GstQuery*) const { return false; }
bool VulkanNeighbor::asks_for_device(GstQuery*) { return false; }
void VulkanNeighbor::wait_for_neighbor() const {}
void VulkanNeighbor::release() {}

bool same_hardware(const gpu::Device& a, const gpu::Device& b) { return &a == &b; }

std::unique_ptr<FrameInput> make_image_input(const GstVideoInfo&) { refuse(); }
std::unique_ptr<FrameOutput> make_image_output(const GstVideoInfo&, GstVideoColorPrimaries) {
  refuse();
}
GstBufferPool* make_image_pool(const std::shared_ptr<gpu::Device>&, GstCaps*, guint*) { refuse(); }

}  // namespace inverse
