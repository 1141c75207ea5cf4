// SPDX-License-Identifier: LGPL-2.1-or-later
#include "kernel.hpp"

#include <algorithm>
#include <string>
#include <tuple>

namespace inverse::gpu {

Kernel::Kernel(const Device& device, const KernelSource& source,
               const std::vector<uint32_t>& constants, uint32_t workgroup)
    : device_(device), name_(source.name), workgroup_(workgroup) {
  const Variant& variant = device_.variant();
  const Spirv embedded = !variant.texel_views ? source.portable
                         : variant.subgroups  ? source.fast
                                              : source.no_subgroups;
  slots_ = embedded.slots;
  const auto storage =
      std::count_if(slots_.begin(), slots_.end(), [](const Slot& slot) { return !slot.texel; });
  if (storage > device_.limits().storage_buffers)
    throw Error(ErrorKind::limit,
                std::string("kernel ") + name_ + " needs " + std::to_string(storage) +
                    " storage buffers, more than maxPerStageDescriptorStorageBuffers of \"" +
                    device_.name() + "\", " + std::to_string(device_.limits().storage_buffers) +
                    "; use another device");
  VkShaderModule module = VK_NULL_HANDLE;
  try {
    std::vector<VkDescriptorSetLayoutBinding> bindings;
    for (uint32_t i = 0; i < slots_.size(); ++i)
      bindings.push_back({i, descriptor_type(slots_[i]), 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr});
    VkDescriptorSetLayoutCreateInfo set{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
    set.bindingCount = static_cast<uint32_t>(bindings.size());
    set.pBindings = bindings.data();
    check(vkCreateDescriptorSetLayout(device_.handle(), &set, nullptr, &set_layout_), name_);
    const VkPushConstantRange push{VK_SHADER_STAGE_COMPUTE_BIT, 0, kPushBytes};
    VkPipelineLayoutCreateInfo layout{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
    layout.setLayoutCount = 1;
    layout.pSetLayouts = &set_layout_;
    layout.pushConstantRangeCount = 1;
    layout.pPushConstantRanges = &push;
    check(vkCreatePipelineLayout(device_.handle(), &layout, nullptr, &layout_), name_);
    VkShaderModuleCreateInfo code{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
    code.codeSize = embedded.words.size_bytes();
    code.pCode = embedded.words.data();
    check(vkCreateShaderModule(device_.handle(), &code, nullptr, &module), name_);

    std::vector<uint32_t> values{workgroup_};
    values.insert(values.end(), constants.begin(), constants.end());
    std::vector<VkSpecializationMapEntry> entries;
    for (uint32_t i = 0; i < values.size(); ++i) entries.push_back({i, i * 4, 4});
    constexpr uint32_t kMaxSubgroups = 99;  // of common.glsl
    entries.push_back({kMaxSubgroups, entries.back().offset + 4, 4});
    values.push_back(max_subgroups());
    const VkSpecializationInfo specialization{static_cast<uint32_t>(entries.size()), entries.data(),
                                              values.size() * 4, values.data()};
    VkComputePipelineCreateInfo info{VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO};
    info.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
    info.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
    info.stage.module = module;
    info.stage.pName = "main";
    info.stage.pSpecializationInfo = &specialization;
    info.layout = layout_;
    check(vkCreateComputePipelines(device_.handle(), device.pipeline_cache(), 1, &info, nullptr,
                                   &pipeline_),
          name_);
    vkDestroyShaderModule(device_.handle(), module, nullptr);
  } catch (...) {
    if (module) vkDestroyShaderModule(device_.handle(), module, nullptr);
    release();
    throw;
  }
}

Kernel::~Kernel() { release(); }

uint32_t Kernel::max_subgroups() const {
  if (!device_.variant().subgroups || !device_.variant().texel_views) return 1;
  const uint32_t min = device_.limits().min_subgroup;
  return (workgroup_ + min - 1) / min;
}

Items Kernel::groups(Items items) const {
  const auto& limits = device_.limits().workgroups;
  Items groups{(items.x - 1) / workgroup_ + 1, items.y, items.z};
  if (items.line)
    std::tie(groups.x, groups.y) = rows_of_groups(groups.x, device_.limits().line_groups);
  if (groups.x > limits[0] || groups.y > limits[1] || groups.z > limits[2])
    throw Error(ErrorKind::limit,
                std::string("kernel ") + name_ + " needs " + std::to_string(groups.x) + "x" +
                    std::to_string(groups.y) + "x" + std::to_string(groups.z) +
                    " workgroups, more than maxComputeWorkGroupCount; use a smaller frame");
  return groups;
}

void Kernel::release() {
  if (pipeline_) vkDestroyPipeline(device_.handle(), pipeline_, nullptr);
  if (layout_) vkDestroyPipelineLayout(device_.handle(), layout_, nullptr);
  if (set_layout_) vkDestroyDescriptorSetLayout(device_.handle(), set_layout_, nullptr);
}

}  // namespace inverse::gpu
