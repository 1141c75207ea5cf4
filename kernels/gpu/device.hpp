// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <vulkan/vulkan.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "common/error.hpp"
#include "memory.hpp"
#include "pipeline_cache.hpp"

namespace inverse::gpu {

class Kernel;
struct KernelSource;

/// What differs between devices in how a kernel is built and launched (kernel-by-device tuning in
/// one place). Each field can be overridden by an environment variable, so that tests run every
/// variant on any device.
struct Variant {
  /// Kernels read through texel views, unless those of the device are too short; else from storage
  /// buffers, of which a kernel then binds up to 14. `INVERSE_TEXEL_VIEWS=0` does without.
  bool texel_views = true;
  /// Kernels reduce with subgroup arithmetic if the device has it, else in shared memory; without
  /// texel views always there. `INVERSE_SUBGROUPS=0` does without.
  bool subgroups = true;
  /// Work that the device itself may skip (Commands::when), if it has
  /// VK_EXT_conditional_rendering and was opened with it. `INVERSE_CONDITIONAL=0` does without.
  bool conditional = false;
  /// Invocations per workgroup along x (specialization constant 0), a multiple of 8.
  /// `INVERSE_WORKGROUP=N`.
  uint32_t workgroup = 64;
  /// A table of sums for every invocation, added up afterwards, instead of one that all share
  /// through atomics: what a CPU prefers. `INVERSE_OWN_TABLES=0|1`.
  bool own_tables = false;
  /// Invocations of a kernel that is one workgroup and works in steps with a barrier between: few
  /// if a barrier costs by the invocation (lavapipe), many if a GPU needs its lanes filled.
  /// A multiple of 8. `INVERSE_LONE_WORKGROUP=N`.
  uint32_t lone_workgroup = 32;
  /// Invocations of a kernel that gives a workgroup to each of some hundred small areas.
  uint32_t area_workgroup() const { return std::max(lone_workgroup / 4, 8U); }
  /// Kernels are built before frames come (build_kernels). `INVERSE_WARM_UP=0` builds each with the
  /// first frame that needs it, which starts sooner.
  bool warm_up = true;
  /// Buffers of some sizes are a little longer than asked for (buffer.cpp): on software devices,
  /// but not under `INVERSE_VALIDATION=1`, which is to see what lies beyond their end.
  bool padded_buffers = false;
  /// Each kernel and transfer is timed as a stage of its own. `INVERSE_TIME_KERNELS=1`.
  bool time_kernels = false;
};

struct Limits {
  uint64_t storage_buffer_bytes = 0;  ///< largest buffer a kernel can see
  /// Longest texel view; no limit if kernels read storage buffers (Variant::texel_views).
  uint64_t texel_elements = 0;
  /// Largest part of a buffer that is bound by rows. For tests `INVERSE_WINDOW_BYTES` makes it
  /// smaller than storage_buffer_bytes.
  uint64_t window_bytes = 0;
  uint32_t workgroups[3] = {};
  /// Most workgroups along x of a dispatch that goes on along y (Kernel::groups). For tests
  /// `INVERSE_LINE_GROUPS` makes it smaller than workgroups[0].
  uint32_t line_groups = 0;
  uint32_t workgroup_invocations = 0;
  uint32_t min_subgroup = 4;     ///< invocations that a subgroup has at least
  uint32_t storage_buffers = 0;  ///< most that a kernel can bind
  double timestamp_ns = 0;       ///< nanoseconds a tick; 0 if the queue has no timestamps
  uint64_t timestamp_mask = 0;   ///< of the bits of a timestamp that count
};

/// A Vulkan device with one compute queue: our own, or one that somebody else made and lends us.
/// Thread-safe. Devices of our own are shared by their user: opening the same one twice gives the
/// same object, so that two elements share kernels and planes without a copy.
class Device : public std::enable_shared_from_this<Device> {
 public:
  /// Opens a device. `select` is an index, a part of a device's name, or empty: the
  /// environment variable `INVERSE_DEVICE`, else the first discrete, integrated, virtual, software
  /// device in that order. Users that differ, such as pipelines, get queues of their own, as long
  /// as the device has some left: up to kMaxQueues, or `INVERSE_QUEUES=N`. The objects for several
  /// queues of a device share neither kernels nor the order of their work. Throws
  /// Error(no_device).
  static std::shared_ptr<Device> open(const std::string& select = {}, const void* user = nullptr);
  static constexpr uint32_t kMaxQueues = 4;

  struct Borrowed {
    VkInstance instance;
    VkPhysicalDevice physical;
    VkDevice device;
    uint32_t queue_family;
    VkQueue queue;
    std::function<void()> lock;    ///< taken around every use of the queue
    std::function<void()> unlock;  ///< releases it
    std::shared_ptr<void> owner;   ///< kept as long as this object lives
    bool conditional = false;      ///< opened with VK_EXT_conditional_rendering and its feature
    /// Set once the device is lost; null: no other object uses it.
    std::shared_ptr<std::atomic<bool>> lost = {};
  };
  /// Adopts a device that is already open; it must outlive this object (`owner`).
  static std::shared_ptr<Device> adopt(Borrowed borrowed);

  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;
  ~Device();

  const std::string& name() const { return name_; }
  /// Whether it is software, which takes a hundred times as long as others.
  bool is_cpu() const { return is_cpu_; }
  /// Whether the device was lost: it stays so, and `open` makes a new one.
  bool lost() const { return handles_.lost->load(); }
  /// Notes that a call found the device lost.
  void note_lost() { *handles_.lost = true; }
  const Limits& limits() const { return limits_; }
  const Variant& variant() const { return variant_; }
  /// How long to wait for a frame before the device counts as lost, in nanoseconds: the environment
  /// variable `INVERSE_TIMEOUT` in seconds, else 10 s, which is what drivers allow themselves, and
  /// 30 s for a software device.
  uint64_t timeout_ns() const { return timeout_ns_.load(); }
  void set_timeout(uint32_t seconds) { timeout_ns_ = seconds * uint64_t{1'000'000'000}; }
  /// Whether the last wait timed out. Cleanup then does not wait again.
  bool unresponsive() const { return unresponsive_.load(); }
  void note_unresponsive(bool unresponsive) { unresponsive_ = unresponsive; }

  /// The kernel built from `source` with these specialization constants (ids 1, 2, …; id 0 is the
  /// workgroup size). Built once and kept as long as the device: to compile it
  /// again after a change of caps would cost more than it weighs. `workgroup` 0 means the
  /// variant's.
  std::shared_ptr<Kernel> kernel(const KernelSource& source,
                                 const std::vector<uint32_t>& constants = {},
                                 uint32_t workgroup = 0);

  /// Kernels that were recorded at least once. A software device compiles a kernel with its first
  /// dispatch: while this number stays, nothing is built.
  uint64_t kernels_used() const { return kernels_used_.load(); }

  /// Kernels that were made and never recorded.
  std::vector<std::shared_ptr<Kernel>> unused_kernels();

  /// Bytes of device memory held by buffers of this device now, and the most there ever were.
  uint64_t memory_bytes() const { return memory_bytes_.load(); }
  uint64_t memory_peak_bytes() const { return memory_peak_bytes_.load(); }

  // For the rest of kernels/gpu and the Vulkan bridge.
  VkInstance instance() const { return handles_.instance; }
  VkPhysicalDevice physical() const { return handles_.physical; }
  VkDevice handle() const { return handles_.device; }
  uint32_t queue_family() const { return handles_.queue_family; }
  VkQueue queue() const { return handles_.queue; }
  const VkPhysicalDeviceMemoryProperties& memory_properties() const { return memory_properties_; }
  MemoryBlocks& memory() { return memory_; }
  VkPipelineCache pipeline_cache() const { return pipeline_cache_->handle(); }
  void count_memory(int64_t bytes);
  void count_kernel_used() { ++kernels_used_; }
  /// Around commands that run if the word at `offset` is not 0; needs `variant().conditional`.
  void begin_conditional(VkCommandBuffer commands, VkBuffer condition, uint64_t offset) const;
  void end_conditional(VkCommandBuffer commands) const;
  /// Submits under the queue's lock; throws Error(device_lost) or Error(out_of_memory).
  void submit(VkCommandBuffer commands, VkFence fence);

 private:
  explicit Device(Borrowed handles, bool owned);
  void read_properties();

  Borrowed handles_;
  bool owned_;
  std::string name_;
  bool is_cpu_ = false;
  Limits limits_;
  Variant variant_;
  PFN_vkCmdBeginConditionalRenderingEXT begin_conditional_ = nullptr;
  PFN_vkCmdEndConditionalRenderingEXT end_conditional_ = nullptr;
  VkPhysicalDeviceMemoryProperties memory_properties_{};
  MemoryBlocks memory_;
  std::mutex kernels_mutex_;
  std::optional<PipelineCache> pipeline_cache_;
  struct Entry {
    std::once_flag once;
    std::unique_ptr<Kernel> kernel;
  };
  std::map<std::string, Entry> kernels_;
  std::atomic<bool> unresponsive_{false};
  std::atomic<uint64_t> timeout_ns_{0};
  uint32_t lose_at_ = 0;  // which submit fails, for tests; 0: none
  std::atomic<uint64_t> kernels_used_{0};
  std::atomic<uint64_t> memory_bytes_{0};
  std::atomic<uint64_t> memory_peak_bytes_{0};
};

/// Throws the Error that a failed Vulkan call deserves; `what` names the call's purpose.
void check(VkResult result, const char* what);

}  // namespace inverse::gpu
