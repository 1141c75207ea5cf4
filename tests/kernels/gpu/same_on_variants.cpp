// SPDX-License-Identifier: LGPL-2.1-or-later
// The tests that INVERSE_SAME_ON_VARIANTS lists (meson.build) run on one variant only. This file
// fails those that call a kernel whose result may depend on the variant. The linker passes two
// calls through here: one that makes a kernel and one that dispatches it.
#include <algorithm>
#include <cstdlib>
#include <map>
#include <mutex>
#include <set>
#include <string>

#include "tests/kernels/gpu_fixture.hpp"

namespace inverse::testing {
namespace {

// SPIR-V specification 1.x, section 3.
enum Operation : uint32_t {
  kSpecConstantOp = 52,
  kFunction = 54,
  kVariable = 59,
  kLoad = 61,
  kAccessChain = 65,
  kDecorate = 71,
  kCompositeExtract = 81,
  kImageFetch = 95,
  kImage = 100,
  kBitcast = 124,
  kControlBarrier = 224,
  kFirstOfSubgroups = 333,
  kLastOfSubgroups = 366
};
constexpr uint32_t kWorkgroupStorage = 4;
constexpr uint32_t kBuiltIn = 11, kWorkgroupSize = 25, kGlobalInvocationId = 28;
constexpr auto kReadsOfBuffers = {kLoad,       kAccessChain, kCompositeExtract,
                                  kImageFetch, kImage,       kBitcast};

struct Program {
  bool uses_workgroup = false;       ///< its size, an index in it, its memory, or a barrier
  std::vector<uint32_t> operations;  ///< of its functions, without kReadsOfBuffers
};

Program parse(std::span<const uint32_t> words) {
  Program program;
  std::set<uint32_t> of_workgroup;  // ids that every kernel declares, and few use
  bool in_function = false;
  for (size_t at = 5; at < words.size(); at += words[at] >> 16) {
    const uint32_t operation = words[at] & 0xffff;
    const auto operands = words.subspan(at + 1, (words[at] >> 16) - 1);
    in_function |= operation == kFunction;
    if (operation == kDecorate && operands[1] == kBuiltIn) {
      if (operands[2] == kWorkgroupSize)
        of_workgroup.insert(operands[0]);
      else
        program.uses_workgroup |= operands[2] != kGlobalInvocationId;
    } else if (operation == kVariable && operands[2] == kWorkgroupStorage) {
      of_workgroup.insert(operands[1]);
    } else if (in_function || operation == kSpecConstantOp) {
      program.uses_workgroup |=
          operation == kControlBarrier ||
          (operation >= kFirstOfSubgroups && operation <= kLastOfSubgroups) ||
          std::ranges::any_of(operands, [&](uint32_t id) { return of_workgroup.contains(id); });
      if (std::ranges::find(kReadsOfBuffers, operation) == kReadsOfBuffers.end())
        program.operations.push_back(operation);
    }
  }
  return program;
}

std::mutex mutex;
std::map<VkPipeline, std::string> dependent;  // names of kernels
std::set<std::string> dispatched;             // of these, in this test

bool depends(const gpu::Device& device, const gpu::KernelSource& source, uint32_t workgroup) {
  const Program fast = parse(source.fast.words), portable = parse(source.portable.words);
  return workgroup != device.variant().workgroup || fast.uses_workgroup ||
         portable.uses_workgroup || fast.operations != portable.operations;
}

class Listener : public ::testing::EmptyTestEventListener {
  void OnTestStart(const ::testing::TestInfo&) override {
    std::lock_guard lock(mutex);
    dispatched.clear();
  }
  void OnTestEnd(const ::testing::TestInfo& test) override {
    const char* listed = std::getenv("INVERSE_SAME_ON_VARIANTS");
    const std::string suite = test.test_suite_name();
    const std::string names = ':' + std::string(listed ? listed : "") + ':';
    if (names.find(':' + suite + ".*:") == std::string::npos &&
        names.find(':' + suite + '.' + test.name() + ':') == std::string::npos)
      return;
    std::lock_guard lock(mutex);
    for (const std::string& kernel : dispatched)
      ADD_FAILURE() << "The kernel " << kernel << " may depend on the variant: remove " << suite
                    << '.' << test.name() << " from same_on_variants in tests/kernels/meson.build.";
  }
};

[[maybe_unused]] const bool listening = [] {
  ::testing::UnitTest::GetInstance()->listeners().Append(new Listener);
  return true;
}();

}  // namespace

#define KERNEL "_ZN7inverse3gpu6KernelC1ERKNS0_6DeviceERKNS0_12KernelSourceERKSt6vectorIjSaIjEEj"
void make_kernel(gpu::Kernel* kernel, const gpu::Device& device, const gpu::KernelSource& source,
                 const std::vector<uint32_t>& constants, uint32_t workgroup) asm("__real_" KERNEL);
void make_recorded_kernel(gpu::Kernel* kernel, const gpu::Device& device,
                          const gpu::KernelSource& source, const std::vector<uint32_t>& constants,
                          uint32_t workgroup) asm("__wrap_" KERNEL);
void make_recorded_kernel(gpu::Kernel* kernel, const gpu::Device& device,
                          const gpu::KernelSource& source, const std::vector<uint32_t>& constants,
                          uint32_t workgroup) {
  make_kernel(kernel, device, source, constants, workgroup);
  std::lock_guard lock(mutex);
  dependent.erase(kernel->pipeline());  // a handle may come again
  if (depends(device, source, workgroup)) dependent[kernel->pipeline()] = source.name;
}

#define CONDITION "_ZNK7inverse3gpu6Device17begin_conditionalEP17VkCommandBuffer_TP10VkBuffer_Tm"
void begin_condition(const gpu::Device* device, VkCommandBuffer commands, VkBuffer condition,
                     uint64_t offset) asm("__real_" CONDITION);
void begin_recorded_condition(const gpu::Device* device, VkCommandBuffer commands,
                              VkBuffer condition, uint64_t offset) asm("__wrap_" CONDITION);
void begin_recorded_condition(const gpu::Device* device, VkCommandBuffer commands,
                              VkBuffer condition, uint64_t offset) {
  {
    std::lock_guard lock(mutex);
    dispatched.insert("that Commands::when may skip");
  }
  begin_condition(device, commands, condition, offset);
}

}  // namespace inverse::testing

extern "C" {
void __real_vkCmdBindPipeline(VkCommandBuffer commands, VkPipelineBindPoint point,
                              VkPipeline pipeline);
void __wrap_vkCmdBindPipeline(VkCommandBuffer commands, VkPipelineBindPoint point,
                              VkPipeline pipeline);
void __wrap_vkCmdBindPipeline(VkCommandBuffer commands, VkPipelineBindPoint point,
                              VkPipeline pipeline) {
  {
    std::lock_guard lock(inverse::testing::mutex);
    if (const auto found = inverse::testing::dependent.find(pipeline);
        found != inverse::testing::dependent.end())
      inverse::testing::dispatched.insert(found->second);
  }
  __real_vkCmdBindPipeline(commands, point, pipeline);
}
}
