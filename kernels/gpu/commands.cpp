// SPDX-License-Identifier: LGPL-2.1-or-later
#include "commands.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstring>
#include <iterator>
#include <mutex>
#include <utility>

#include "kernels/gpu_fill.spv.hpp"

namespace inverse::gpu {
namespace {

constexpr VkAccessFlags kAccess = VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT |
                                  VK_ACCESS_TRANSFER_READ_BIT | VK_ACCESS_TRANSFER_WRITE_BIT |
                                  VK_ACCESS_INDIRECT_COMMAND_READ_BIT;
constexpr VkAccessFlags kWrites = VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_WRITE_BIT;
constexpr VkPipelineStageFlags kStages = VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT |
                                         VK_PIPELINE_STAGE_TRANSFER_BIT |
                                         VK_PIPELINE_STAGE_DRAW_INDIRECT_BIT;

/// A stage that work on the host interrupts.
constexpr const char* kUnfinished = "";

/// What a device that never answered may still be using. It is never freed: a driver that has hung
/// writes into freed memory when it wakes, and waiting for one that does not would hang the
/// process.
void abandon(std::vector<std::shared_ptr<void>> objects) {
  static std::mutex mutex;
  static auto* const abandoned = new std::vector<std::shared_ptr<void>>;  // outlives the process
  std::lock_guard lock(mutex);
  abandoned->insert(abandoned->end(), std::make_move_iterator(objects.begin()),
                    std::make_move_iterator(objects.end()));
}

/// Elements that hold the data, the last one perhaps in part.
size_t elements_of(Element element, std::span<const std::byte> data) {
  return (data.size() + element_bytes(element) - 1) / element_bytes(element);
}

/// Whether a fence says that its work has ended, or can never: after other errors, such as a lack
/// of memory for the wait itself, it may still run.
bool is_over(VkResult fence) { return fence == VK_SUCCESS || fence == VK_ERROR_DEVICE_LOST; }

}  // namespace

Commands::Commands(std::shared_ptr<Device> device)
    : device_(std::move(device)), sets_(std::make_shared<DescriptorSets>(device_)) {
  try {
    VkCommandPoolCreateInfo pool{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
    pool.flags = VK_COMMAND_POOL_CREATE_TRANSIENT_BIT;
    pool.queueFamilyIndex = device_->queue_family();
    check(vkCreateCommandPool(device_->handle(), &pool, nullptr, &pool_),
          "creating a command pool");
    VkCommandBufferAllocateInfo buffer{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
    buffer.commandPool = pool_;
    buffer.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
    buffer.commandBufferCount = 1;
    check(vkAllocateCommandBuffers(device_->handle(), &buffer, &buffer_),
          "allocating a command buffer");
    const VkFenceCreateInfo fence{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
    check(vkCreateFence(device_->handle(), &fence, nullptr, &fence_), "creating a fence");
    if (device_->limits().timestamp_ns > 0) {
      VkQueryPoolCreateInfo queries{VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO};
      queries.queryType = VK_QUERY_TYPE_TIMESTAMP;
      queries.queryCount = kMaxStages + 1;
      check(vkCreateQueryPool(device_->handle(), &queries, nullptr, &queries_),
            "creating a query pool");
    }
  } catch (...) {
    release();
    throw;
  }
}

Commands::~Commands() {
  const uint64_t timeout = timed_out_ || device_->unresponsive() ? 0 : device_->timeout_ns();
  if (in_flight_ && !is_over(vkWaitForFences(device_->handle(), 1, &fence_, VK_TRUE, timeout))) {
    device_->note_unresponsive(true);
    kept_.push_back(device_);  // the pool, the fence and the queries live as long as it does
    kept_.push_back(std::move(sets_));
    abandon(std::move(kept_));
    return;
  }
  release();
}

void Commands::release() {
  if (queries_) vkDestroyQueryPool(device_->handle(), queries_, nullptr);
  if (fence_) vkDestroyFence(device_->handle(), fence_, nullptr);
  if (pool_) vkDestroyCommandPool(device_->handle(), pool_, nullptr);
}

void Commands::begin() {
  if (in_flight_) wait();
  kept_.clear();
  uses_.clear();
  pending_.clear();  // an exception may have left some
  command_ = 0;
  stage_names_.clear();
  earlier_ = {};
  counts_ = {};
  in_when_ = false;
  sets_->begin();
  check(vkResetCommandPool(device_->handle(), pool_, 0), "resetting a command pool");
  VkCommandBufferBeginInfo info{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
  info.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  check(vkBeginCommandBuffer(buffer_, &info), "recording a frame");
  barrier(Reader::any);  // after whatever earlier submits wrote
  stages_timed_ = time_stages_;
  if (queries_) {
    vkCmdResetQueryPool(buffer_, queries_, 0, kMaxStages + 1);
    vkCmdWriteTimestamp(buffer_, VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT, queries_, 0);
  }
}

void Commands::barrier(Reader reader) {
  VkMemoryBarrier barrier{VK_STRUCTURE_TYPE_MEMORY_BARRIER};
  VkPipelineStageFlags before = reader == Reader::any ? kStages : unseen_stages_;
  if (before & VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT)
    barrier.srcAccessMask |= VK_ACCESS_SHADER_WRITE_BIT;
  if (before & VK_PIPELINE_STAGE_TRANSFER_BIT)
    barrier.srcAccessMask |= VK_ACCESS_TRANSFER_WRITE_BIT;
  VkPipelineStageFlags after = VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT;
  barrier.dstAccessMask = VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT;
  if (reader == Reader::any) {
    after = kStages;
    barrier.dstAccessMask = kAccess;
    if (device_->variant().conditional) {
      barrier.dstAccessMask |= VK_ACCESS_CONDITIONAL_RENDERING_READ_BIT_EXT;
      after |= VK_PIPELINE_STAGE_CONDITIONAL_RENDERING_BIT_EXT;
      before |= VK_PIPELINE_STAGE_CONDITIONAL_RENDERING_BIT_EXT;  // a condition that is overwritten
    }
    seen_by_any_ = command_;
  }
  vkCmdPipelineBarrier(buffer_, before, after, 0, 1, &barrier, 0, nullptr, 0, nullptr);
  ++counts_.barriers;
  seen_by_kernels_ = command_;
  unseen_stages_ = 0;
}

void Commands::count_transfer(uint64_t bytes) {
  ++counts_.transfers;
  counts_.transferred_bytes += bytes;
}

void Commands::touch(VkBuffer buffer, bool reads, bool writes) {
  if (reads || writes) pending_.push_back({buffer, reads, writes});
}

void Commands::barrier_if_needed(Reader reader, VkPipelineStageFlags stages) {
  const uint32_t seen = reader == Reader::kernel ? seen_by_kernels_ : seen_by_any_;
  const bool needed = std::any_of(pending_.begin(), pending_.end(), [&](const Access& now) {
    const Uses& before = uses_[now.buffer];
    return before.written > seen || (now.writes && before.read > seen);
  });
  if (needed) barrier(reader);
  ++command_;
  for (const Access& now : pending_) {
    Uses& uses = uses_[now.buffer];
    if (now.reads) uses.read = command_;
    if (now.writes) uses.written = command_;
  }
  unseen_stages_ |= stages;
  pending_.clear();
}

uint32_t Commands::rows_at_once(std::span<const Binding> buffers, uint32_t rows) const {
  constexpr uint32_t kStep = Rows::kStep;
  uint64_t at_once = rows;
  for (const Binding& binding : buffers)
    if (binding.by_rows && binding.buffer->bytes() > device_->limits().window_bytes)
      at_once = std::min(at_once, device_->limits().window_bytes /
                                      (binding.buffer->bytes() / rows) / kStep * kStep);
  return at_once >= rows ? rows : std::max(static_cast<uint32_t>(at_once), kStep);
}

void Commands::prepare(const KernelPtr& kernel, std::span<const Binding> buffers,
                       std::span<const std::byte> push, Reader reader, const Part& part) {
  const auto slots = kernel->slots();
  if (buffers.size() != slots.size() || buffers.size() > DescriptorSets::kMaxBindings)
    throw Error(ErrorKind::internal, std::string("kernel ") + kernel->name() + " has " +
                                         std::to_string(slots.size()) + " bindings and was given " +
                                         std::to_string(buffers.size()));
  if (kernel->first_use()) device_->count_kernel_used();
  std::array<DescriptorSets::Bound, DescriptorSets::kMaxBindings> bound;
  for (uint32_t i = 0; i < slots.size(); ++i) {
    const BufferPtr& buffer = buffers[i].buffer;
    if (!buffer)
      throw Error(ErrorKind::internal, std::string("kernel ") + kernel->name() +
                                           ": no buffer at binding " + std::to_string(i));
    for (uint32_t k = 0; k < i; ++k)
      if (buffers[k].buffer == buffer && (slots[k].writes || slots[i].writes) &&
          !buffers[k].aliased && !buffers[i].aliased)
        throw Error(ErrorKind::internal, std::string("kernel ") + kernel->name() +
                                             ": one buffer at bindings " + std::to_string(k) +
                                             " and " + std::to_string(i) +
                                             "; mark it gpu::aliased if intended");
    bound[i] = {buffer.get(), 0, buffer->bytes()};
    if (buffers[i].by_rows && part.count < part.rows) {
      const uint64_t row = buffer->bytes() / part.rows;
      bound[i].offset = part.first * row;
      bound[i].bytes = part.count * row;
    } else if (!slots[i].texel && buffer->bytes() > device_->limits().storage_buffer_bytes) {
      throw Error(ErrorKind::limit, std::string("kernel ") + kernel->name() + " cannot bind " +
                                        std::to_string(buffer->bytes()) +
                                        " bytes, more than maxStorageBufferRange of \"" +
                                        device_->name() + "\", " +
                                        std::to_string(device_->limits().storage_buffer_bytes) +
                                        " bytes; use a smaller frame or another device");
    }
    touch(buffer->handle(), slots[i].reads, slots[i].writes);
    kept_.push_back(buffer);
  }
  VkDescriptorSet set = sets_->get(*kernel, {bound.data(), slots.size()});
  kept_.push_back(kernel);
  barrier_if_needed(reader, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT |
                                (reader == Reader::any ? VK_PIPELINE_STAGE_DRAW_INDIRECT_BIT : 0));
  vkCmdBindPipeline(buffer_, VK_PIPELINE_BIND_POINT_COMPUTE, kernel->pipeline());
  vkCmdBindDescriptorSets(buffer_, VK_PIPELINE_BIND_POINT_COMPUTE, kernel->layout(), 0, 1, &set, 0,
                          nullptr);
  if (!push.empty())
    vkCmdPushConstants(buffer_, kernel->layout(), VK_SHADER_STAGE_COMPUTE_BIT, 0,
                       static_cast<uint32_t>(push.size()), push.data());
  ++counts_.dispatches;
}

void Commands::run(const KernelPtr& kernel, std::span<const Binding> buffers,
                   std::span<const std::byte> push, Items items, const Part& part) {
  if (!items.x || !items.y || !items.z) return;
  const Items groups = kernel->groups(items);
  prepare(kernel, buffers, push, Reader::kernel, part);
  vkCmdDispatch(buffer_, groups.x, groups.y, groups.z);
  mark_command(kernel->name());
}

void Commands::build(const KernelPtr& kernel) {
  constexpr std::array<std::byte, Kernel::kPushBytes> kZeros{};
  std::vector<Binding> buffers;
  for (const Slot& slot : kernel->slots())
    buffers.emplace_back(Buffer::create(device_, slot.element, 1));
  prepare(kernel, buffers, kZeros, Reader::kernel);
  vkCmdDispatch(buffer_, 0, 0, 0);
}

void Commands::run_indirect(const KernelPtr& kernel, std::span<const Binding> buffers,
                            std::span<const std::byte> push, const BufferPtr& arguments,
                            uint64_t offset) {
  touch(arguments->handle(), true, false);
  kept_.push_back(arguments);
  prepare(kernel, buffers, push, Reader::any);
  vkCmdDispatchIndirect(buffer_, arguments->handle(), offset);
  mark_command(kernel->name());
}

void Commands::begin_when(const BufferPtr& condition, uint64_t offset) {
  refuse_when("another condition");
  in_when_ = true;
  if (!device_->variant().conditional) return;
  touch(condition->handle(), true, false);
  barrier_if_needed(Reader::any, VK_PIPELINE_STAGE_CONDITIONAL_RENDERING_BIT_EXT);
  kept_.push_back(condition);
  device_->begin_conditional(buffer_, condition->handle(), offset);
}

void Commands::end_when() {
  in_when_ = false;
  if (device_->variant().conditional) device_->end_conditional(buffer_);
}

void Commands::refuse_when(const char* what) const {
  if (in_when_)
    throw Error(ErrorKind::internal, std::string(what) + " inside of a condition would run always");
}

void Commands::copy(std::span<const CopyPart> parts, const BufferPtr& target) {
  refuse_when("a copy");
  for (const CopyPart& part : parts) touch(part.source->handle(), true, false);
  touch(target->handle(), false, true);
  barrier_if_needed(Reader::any, VK_PIPELINE_STAGE_TRANSFER_BIT);
  kept_.push_back(target);
  for (const CopyPart& part : parts) {
    kept_.push_back(part.source);
    const VkBufferCopy region{part.source_offset, part.target_offset, part.bytes};
    vkCmdCopyBuffer(buffer_, part.source->handle(), target->handle(), 1, &region);
    count_transfer(part.bytes);
  }
  mark_command("copy");
}

void Commands::write_bytes(BufferPtr& table, Element element, std::span<const std::byte> data) {
  refuse_when("a copy");
  const size_t count = elements_of(element, data);
  if (!table || table->count() < count) table = Buffer::create(device_, element, count);
  if (data.empty()) return;
  touch(table->handle(), false, true);
  barrier_if_needed(Reader::any, VK_PIPELINE_STAGE_TRANSFER_BIT);
  kept_.push_back(table);
  constexpr size_t kAtOnce = 65536;  // Vulkan's limit
  for (size_t at = 0; at < data.size(); at += kAtOnce) {
    const size_t bytes = std::min(kAtOnce, data.size() - at);
    vkCmdUpdateBuffer(buffer_, table->handle(), at, bytes, &data[at]);
    count_transfer(bytes);
  }
  count_upload(data.size());
  mark_command("table");
}

void Commands::fill(const BufferPtr& buffer, uint32_t word) {
  constexpr uint64_t kSmall = 65536;  // up to which a kernel is faster than a transfer's barriers
  if (in_when_ || buffer->bytes() <= kSmall) {
    const auto count = static_cast<uint32_t>(buffer->bytes() / sizeof(uint32_t));
    dispatch(Program<shaders::gpu_fill>(device_), {.words = buffer}, {.count = count, .word = word},
             {count});
    return;
  }
  touch(buffer->handle(), false, true);
  barrier_if_needed(Reader::any, VK_PIPELINE_STAGE_TRANSFER_BIT);
  kept_.push_back(buffer);
  vkCmdFillBuffer(buffer_, buffer->handle(), 0, VK_WHOLE_SIZE, word);
  count_transfer(buffer->bytes());
  mark_command("fill");
}

void Commands::image_layout(VkImage image, VkImageLayout from, VkImageLayout to) {
  VkImageMemoryBarrier barrier{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER};
  barrier.srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT;
  barrier.dstAccessMask = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT;
  barrier.oldLayout = from;
  barrier.newLayout = to;
  barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.image = image;
  barrier.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
  vkCmdPipelineBarrier(buffer_, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT,
                       VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 0, nullptr, 0, nullptr, 1, &barrier);
  ++counts_.barriers;
}

void Commands::copy_from_image(const ImageRegion& region, const BufferPtr& target) {
  refuse_when("a copy");
  touch(target->handle(), false, true);
  barrier_if_needed(Reader::any, VK_PIPELINE_STAGE_TRANSFER_BIT);
  kept_.push_back(target);
  image_layout(region.image, region.layout, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
  VkBufferImageCopy copy{};
  copy.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
  copy.imageExtent = {region.width, region.height, 1};
  vkCmdCopyImageToBuffer(buffer_, region.image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                         target->handle(), 1, &copy);
  count_transfer(uint64_t{4} * region.width * region.height);
  image_layout(region.image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, region.layout_after);
}

void Commands::copy_to_image(const BufferPtr& source, const ImageRegion& region) {
  refuse_when("a copy");
  touch(source->handle(), true, false);
  barrier_if_needed(Reader::any, VK_PIPELINE_STAGE_TRANSFER_BIT);
  kept_.push_back(source);
  image_layout(region.image, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
  VkBufferImageCopy copy{};
  copy.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
  copy.imageExtent = {region.width, region.height, 1};
  vkCmdCopyBufferToImage(buffer_, source->handle(), region.image,
                         VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &copy);
  count_transfer(uint64_t{4} * region.width * region.height);
  image_layout(region.image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, region.layout_after);
}

void Commands::stage(const char* name) {
  if (!device_->variant().time_kernels) mark(name);
}

void Commands::mark(const char* name) {
  if (!queries_ || !stages_timed_ || stage_names_.size() >= kMaxStages) return;
  // The mark waits for the work before it, so that a stage's time is its own.
  barrier(Reader::any);
  stage_names_.push_back(name);
  vkCmdWriteTimestamp(buffer_, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, queries_,
                      static_cast<uint32_t>(stage_names_.size()));
}

void Commands::on_host(const std::function<void()>& work) {
  refuse_when("work on the host");
  mark(kUnfinished);
  submit();
  wait();
  const auto start = std::chrono::steady_clock::now();
  work();
  const std::chrono::duration<double, std::milli> taken = std::chrono::steady_clock::now() - start;
  Earlier earlier{stages_, device_ms_ + taken.count(), taken.count(), counts_};
  if (!earlier.stages.empty() && earlier.stages.back().name == kUnfinished) {
    earlier.unfinished_ms += earlier.stages.back().milliseconds;
    earlier.stages.pop_back();
  }
  if (device_->variant().time_kernels)
    earlier.stages.push_back({"host", std::exchange(earlier.unfinished_ms, 0)});
  begin();
  counts_ = earlier.counts;
  earlier_ = std::move(earlier);
}

void Commands::submit() {
  if (queries_ && !stages_timed_)
    vkCmdWriteTimestamp(buffer_, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, queries_, 1);
  VkMemoryBarrier barrier{VK_STRUCTURE_TYPE_MEMORY_BARRIER};
  barrier.srcAccessMask = kWrites;
  barrier.dstAccessMask = VK_ACCESS_HOST_READ_BIT;
  vkCmdPipelineBarrier(buffer_, kStages, VK_PIPELINE_STAGE_HOST_BIT, 0, 1, &barrier, 0, nullptr, 0,
                       nullptr);
  ++counts_.barriers;
  check(vkEndCommandBuffer(buffer_), "recording a frame");
  check(vkResetFences(device_->handle(), 1, &fence_), "resetting a fence");
  device_->submit(buffer_, fence_);
  in_flight_ = true;
}

bool Commands::wait(const std::function<bool()>& stop) {
  if (!in_flight_) return true;
  constexpr uint64_t kStep = 20'000'000;  // ns
  uint64_t left = timed_out_ ? 0 : device_->timeout_ns();
  VkResult result = VK_TIMEOUT;
  for (;;) {
    const uint64_t step = stop ? std::min(left, kStep) : left;
    result = vkWaitForFences(device_->handle(), 1, &fence_, VK_TRUE, step);
    left -= step;
    if (result != VK_TIMEOUT || left == 0) break;
    if (stop()) return false;
  }
  timed_out_ = result == VK_TIMEOUT;
  device_->note_unresponsive(timed_out_);
  if (timed_out_)
    throw Error(ErrorKind::device_lost,
                "the Vulkan device \"" + device_->name() + "\" did not finish a frame within " +
                    std::to_string(device_->timeout_ns() / 1'000'000'000) +
                    " seconds; use a smaller frame or another device, or raise INVERSE_TIMEOUT");
  if (result == VK_ERROR_DEVICE_LOST) device_->note_lost();
  in_flight_ = !is_over(result);
  check(result, "waiting for a frame");
  kept_.clear();  // planes go back to those who hold them still
  read_stages();
  return true;
}

bool Commands::done() const {
  return !in_flight_ || is_over(vkGetFenceStatus(device_->handle(), fence_));
}

BufferPtr make_table(const std::shared_ptr<Device>& device, Element element,
                     std::span<const std::byte> data) {
  const size_t count = elements_of(element, data);
  BufferPtr table = Buffer::create(device, element, count);
  const bool staged = !table->map();
  const BufferPtr target = staged ? Buffer::create(device, element, count, Memory::upload) : table;
  if (!data.empty()) std::memcpy(target->map(), data.data(), data.size());
  if (!staged) return table;
  Commands commands(device);
  commands.begin();
  commands.copy(target, table, table->bytes());
  commands.submit();
  commands.wait();
  return table;
}

void build_kernels(const std::shared_ptr<Device>& device) {
  if (!device->variant().warm_up) return;
  const Program<shaders::gpu_fill> fill(device);
  Commands commands(device);
  for (const KernelPtr& kernel : device->unused_kernels()) {
    commands.begin();
    commands.build(kernel);
    commands.submit();
    commands.wait();
  }
}

void Commands::read_stages() {
  stages_ = earlier_.stages;
  device_ms_ = earlier_.device_ms;
  const size_t marks = stages_timed_ ? stage_names_.size() : 1;
  if (!queries_ || !marks) return;
  std::vector<uint64_t> ticks(marks + 1);
  const VkResult result =
      vkGetQueryPoolResults(device_->handle(), queries_, 0, static_cast<uint32_t>(ticks.size()),
                            ticks.size() * sizeof(uint64_t), ticks.data(), sizeof(uint64_t),
                            VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT);
  check(result, "reading timestamps");
  const auto milliseconds = [&](size_t from, size_t to) {
    const Limits& limits = device_->limits();
    return static_cast<double>((ticks[to] - ticks[from]) & limits.timestamp_mask) *
           limits.timestamp_ns * 1e-6;
  };
  device_ms_ += milliseconds(0, marks);
  for (size_t i = 0; i < stage_names_.size(); ++i)
    stages_.push_back(
        {stage_names_[i], milliseconds(i, i + 1) + (i == 0 ? earlier_.unfinished_ms : 0)});
}

}  // namespace inverse::gpu
