// SPDX-License-Identifier: LGPL-2.1-or-later
#include "kernel.hpp"

#include <string>

namespace inverse::gpu {

Kernel::Kernel(const Device& device, const KernelSource& source,
               const std::vector<uint32_t>& constants, uint32_t workgroup)
    : device_(device), name_(source.name), workgroup_(workgroup) {
  const Spirv embedded = device_.variant().portable ? source.portable : source.fast;
  slots_ = embedded.slots;
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
    const VkSpecializationInfo specialization{static_cast<uint32_t>(entries.size()), entries.data(),
                                              values.size() * 4, values.data()};
    VkComputePipelineCreateInfo info{VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO};
    info.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
    info.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
    info.stage.module = module;
    info.stage.pName = "main";
    info.stage.pSpecializationInfo = &specialization;
    info.layout = layout_;
    check(vkCreateComputePipelines(device_.handle(), VK_NULL_HANDLE, 1, &info, nullptr, &pipeline_),
          name_);
    vkDestroyShaderModule(device_.handle(), module, nullptr);
  } catch (...) {
    if (module) vkDestroyShaderModule(device_.handle(), module, nullptr);
    release();
    throw;
  }
}

Kernel::~Kernel() { release(); }

void Kernel::release() {
  if (pipeline_) vkDestroyPipeline(device_.handle(), pipeline_, nullptr);
  if (layout_) vkDestroyPipelineLayout(device_.handle(), layout_, nullptr);
  if (set_layout_) vkDestroyDescriptorSetLayout(device_.handle(), set_layout_, nullptr);
}

}  // namespace inverse::gpu
