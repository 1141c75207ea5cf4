// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <vulkan/vulkan.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <unordered_map>
#include <vector>

#include "buffer.hpp"
#include "descriptor_sets.hpp"
#include "frame_ring.hpp"
#include "kernel.hpp"

namespace inverse::gpu {

/// Device time between two stage marks.
struct StageTime {
  const char* name;
  double milliseconds;
};

/// What one submit has recorded.
struct WorkCounts {
  uint32_t dispatches = 0;         ///< of kernels, also if the device skips them
  uint32_t transfers = 0;          ///< copies, fills, and tables written
  uint32_t barriers = 0;           ///< pipeline barriers, also those between stages
  uint64_t transferred_bytes = 0;  ///< written by transfers
  uint64_t uploaded_bytes = 0;     ///< of frames and tables, by the host
  uint64_t downloaded_bytes = 0;   ///< of frames, read by the host
};

/// Records one submit's worth of work. Barriers are automatic: what each kernel reads and writes is
/// known from its SPIR-V. Buffers and kernels that are recorded stay alive until the work is done.
/// Not thread-safe; many Commands may be used on one Device from many threads. Work of several
/// Commands runs in the order of their submits, and a later one sees all that an earlier one wrote.
class Commands {
 public:
  explicit Commands(std::shared_ptr<Device> device);
  Commands(const Commands&) = delete;
  Commands& operator=(const Commands&) = delete;
  /// Waits for work still in flight, not at all if the device is unresponsive. If the device does
  /// not finish it within `Device::timeout_ns`, everything that the work may use is never freed.
  ~Commands();

  const std::shared_ptr<Device>& device() const { return device_; }

  /// Starts recording; waits for the previous submit of this object and drops what it kept alive.
  void begin();

  /// Runs a kernel over `items` invocations, with buffers and push constants by the names that the
  /// shader gives them: dispatch(total, {.sums = a, .total = b}, {.count = n}, {}). Push constants
  /// may be those of another shader that declares the same ones.
  template <typename Shader, typename Push = typename Shader::Push>
  void dispatch(const Program<Shader>& program, const typename Shader::Buffers& buffers,
                const Push& push, Items items) {
    static_assert(Push::layout == Shader::Push::layout && sizeof(Push) <= Kernel::kPushBytes);
    run(program.kernel(), buffers.all(), std::as_bytes(std::span(&push, 1)), items);
  }
  template <typename Shader>
  void dispatch(const Program<Shader>& program, const typename Shader::Buffers& buffers,
                Items items) {
    static_assert(!requires { typename Shader::Push; });
    run(program.kernel(), buffers.all(), {}, items);
  }
  /// As `dispatch`; `push` has a member `first_row`, of any value.
  template <typename Shader, typename Push = typename Shader::Push>
  void dispatch_rows(const Program<Shader>& program, const typename Shader::Buffers& buffers,
                     Push push, const Rows& rows) {
    static_assert(Push::layout == Shader::Push::layout && sizeof(Push) <= Kernel::kPushBytes);
    const auto bindings = buffers.all();
    const uint32_t at_once = rows_at_once(bindings, rows.rows);
    const uint32_t end = std::min(rows.end, rows.rows);
    for (uint32_t first = rows.begin / Rows::kStep * Rows::kStep, count = 0; first < end;
         first += count) {
      count = std::min(at_once, end - first);
      const uint32_t down = (count - 1) / rows.rows_an_item + 1;
      push.first_row = first;
      run(program.kernel(), bindings, std::as_bytes(std::span(&push, 1)),
          rows.line ? Items(rows.width * down) : Items(rows.width, down),
          {first, count, rows.rows});
    }
  }
  /// As `dispatch`, with the number of workgroups (three uint32) read from `arguments` at `offset`
  /// bytes on the device.
  template <typename Shader, typename Push = typename Shader::Push>
  void dispatch_indirect(const Program<Shader>& program, const typename Shader::Buffers& buffers,
                         const Push& push, const BufferPtr& arguments, uint64_t offset = 0) {
    static_assert(Push::layout == Shader::Push::layout && sizeof(Push) <= Kernel::kPushBytes);
    run_indirect(program.kernel(), buffers.all(), std::as_bytes(std::span(&push, 1)), arguments,
                 offset);
  }
  template <typename Shader>
  void dispatch_indirect(const Program<Shader>& program, const typename Shader::Buffers& buffers,
                         const BufferPtr& arguments, uint64_t offset = 0) {
    static_assert(!requires { typename Shader::Push; });
    run_indirect(program.kernel(), buffers.all(), {}, arguments, offset);
  }

  /// Records a kernel over no invocations, on buffers of its own: a software device compiles it
  /// then.
  void build(const KernelPtr& kernel);

  /// Records kernels that the device skips if the word at `offset` bytes of `condition` is 0 when
  /// it reaches them. What a skipped kernel would have written stays unchanged. On a device without
  /// `Device::variant().conditional` all of them run. Copies would always run: they throw
  /// Error(internal) here. Not nested.
  template <typename Record>
  void when(const BufferPtr& condition, uint64_t offset, Record record) {
    begin_when(condition, offset);
    const std::unique_ptr<Commands, void (*)(Commands*)> end(
        this, [](Commands* self) { self->end_when(); });
    record();
  }

  struct CopyPart {
    BufferPtr source;
    uint64_t bytes, source_offset = 0, target_offset = 0;
  };
  /// Copies parts of several buffers to places of one that do not overlap.
  void copy(std::span<const CopyPart> parts, const BufferPtr& target);
  /// Copies `bytes` from one buffer to another.
  void copy(const BufferPtr& source, const BufferPtr& target, uint64_t bytes,
            uint64_t source_offset = 0, uint64_t target_offset = 0) {
    const CopyPart part{source, bytes, source_offset, target_offset};
    copy({&part, 1}, target);
  }
  /// Copies data from the host into `table`, which is made anew, of device memory, if it is too
  /// short or null. The host may change the data at once.
  template <typename T>
  void write_table(BufferPtr& table, Element element, const std::vector<T>& data) {
    static_assert(sizeof(T) % 4 == 0, "Vulkan copies whole words");
    write_bytes(table, element, std::as_bytes(std::span(data)));
  }
  /// Sets every 32-bit word of a buffer.
  void fill(const BufferPtr& buffer, uint32_t word = 0);

  struct ImageRegion {
    VkImage image;
    VkImageLayout layout;        ///< the image's layout before
    VkImageLayout layout_after;  ///< and after
    uint32_t width, height;
  };
  /// Copies a whole 4-byte-per-pixel image into a buffer of words, and back. Not inside of `when`.
  void copy_from_image(const ImageRegion& region, const BufferPtr& target);
  void copy_to_image(const BufferPtr& source, const ImageRegion& region);

  /// Marks the end of a stage for `stages()`. At most kMaxStages a submit; further ones are not
  /// timed. Ignored if kernels are timed one by one (Variant::time_kernels).
  void stage(const char* name);
  /// Whether stages are timed from the next `begin` on; they are at first. If not, they cost no
  /// barriers, and the device time of the whole submit is all that is known.
  void time_stages(bool timed) { time_stages_ = timed; }
  static constexpr uint32_t kMaxStages = 255;

  /// Submits what was recorded, waits until it is done, and calls `work`, which may read and write
  /// mapped buffers; recording then goes on as of one submit. Its time counts as device time of the
  /// stage that it is in. Not inside of `when`. Throws as `wait`.
  void on_host(const std::function<void()>& work);

  /// Hands the recorded work to the device.
  void submit();
  /// Waits until the submitted work is done. Throws Error(device_lost) if the device is lost, or
  /// after `Device::timeout_ns`; further waits then throw at once until the work is done. False if
  /// `stop`, which is asked every 20 ms, ended the wait.
  bool wait(const std::function<bool()>& stop = {});
  /// Whether `wait` would return at once.
  bool done() const;

  /// Device time of the stages of the last submit that was waited for. Empty if they were not
  /// timed, or if the device has no timestamps.
  const std::vector<StageTime>& stages() const { return stages_; }
  /// Milliseconds of that submit on the device: up to its last stage if stages are timed. 0 if the
  /// device has no timestamps.
  double device_ms() const { return device_ms_; }
  /// Keeps an object alive until this submit is done.
  void keep(std::shared_ptr<void> object) { kept_.push_back(std::move(object)); }
  uint32_t dispatches() const { return counts_.dispatches; }
  /// Of the recording since `begin`.
  const WorkCounts& counts() const { return counts_; }
  /// Counts bytes that the host writes to mapped memory for this submit, or reads after it.
  void count_upload(uint64_t bytes) { counts_.uploaded_bytes += bytes; }
  void count_download(uint64_t bytes) { counts_.downloaded_bytes += bytes; }

 private:
  struct Access {
    VkBuffer buffer;
    bool reads, writes;
  };
  /// The last commands that read and wrote a buffer, numbered from 1.
  struct Uses {
    uint32_t read = 0, written = 0;
  };
  /// Of the submits before work on the host: `unfinished_ms` are of the stage that goes on after
  /// it.
  struct Earlier {
    std::vector<StageTime> stages;
    double device_ms = 0, unfinished_ms = 0;
    WorkCounts counts;
  };
  /// Who has to see what earlier commands wrote: kernels alone, which the device need not wait for
  /// with more than its compute units, or also copies, and what its front end reads.
  enum class Reader { kernel, any };
  void write_bytes(BufferPtr& table, Element element, std::span<const std::byte> data);
  void begin_when(const BufferPtr& condition, uint64_t offset);
  void end_when();
  void mark(const char* name);
  /// After a kernel or a transfer.
  void mark_command(const char* name) {
    if (device_->variant().time_kernels) mark(name);
  }
  void refuse_when(const char* what) const;
  void touch(VkBuffer buffer, bool reads, bool writes);
  void barrier_if_needed(Reader reader, VkPipelineStageFlags stages);
  void barrier(Reader reader);
  void count_transfer(uint64_t bytes);
  /// The rows that buffers by_rows are bound from and to, of all that they have.
  struct Part {
    uint32_t first, count, rows;
  };
  static constexpr Part kWhole{0, 1, 1};
  void run(const KernelPtr& kernel, std::span<const Binding> buffers,
           std::span<const std::byte> push, Items items, const Part& part = kWhole);
  /// How many rows of the buffers by_rows fit a binding: all, or a multiple of 64.
  uint32_t rows_at_once(std::span<const Binding> buffers, uint32_t rows) const;
  void run_indirect(const KernelPtr& kernel, std::span<const Binding> buffers,
                    std::span<const std::byte> push, const BufferPtr& arguments, uint64_t offset);
  void prepare(const KernelPtr& kernel, std::span<const Binding> buffers,
               std::span<const std::byte> push, Reader reader, const Part& part = kWhole);
  void image_layout(VkImage image, VkImageLayout from, VkImageLayout to);
  void read_stages();
  void release();

  std::shared_ptr<Device> device_;
  VkCommandPool pool_ = VK_NULL_HANDLE;
  VkCommandBuffer buffer_ = VK_NULL_HANDLE;
  VkFence fence_ = VK_NULL_HANDLE;
  VkQueryPool queries_ = VK_NULL_HANDLE;
  std::shared_ptr<DescriptorSets> sets_;
  std::unordered_map<VkBuffer, Uses> uses_;
  std::vector<Access> pending_;                     // by the command being recorded
  uint32_t command_ = 0;                            // its number
  uint32_t seen_by_kernels_ = 0, seen_by_any_ = 0;  // the last command whose writes they see
  VkPipelineStageFlags unseen_stages_ = 0;          // of commands after seen_by_kernels_
  std::vector<const char*> stage_names_;
  std::vector<StageTime> stages_;
  double device_ms_ = 0;
  Earlier earlier_;
  std::vector<std::shared_ptr<void>> kept_;
  WorkCounts counts_;
  bool time_stages_ = true;   // of the next recording
  bool stages_timed_ = true;  // of this one
  bool in_when_ = false;
  bool in_flight_ = false;
  bool timed_out_ = false;
};

/// Builds all kernels that were made on the device and not yet recorded, so that no frame waits for
/// the compiler; nothing if `INVERSE_WARM_UP=0`. Waits for the device. Throws Error(out_of_memory).
void build_kernels(const std::shared_ptr<Device>& device);

/// A buffer of device memory with this data, at least one element long: for what is written once
/// and read often. Waits for the device if the host cannot write there.
BufferPtr make_table(const std::shared_ptr<Device>& device, Element element,
                     std::span<const std::byte> data);
template <typename T>
BufferPtr make_table(const std::shared_ptr<Device>& device, Element element,
                     const std::vector<T>& data) {
  return make_table(device, element, std::as_bytes(std::span(data)));
}

}  // namespace inverse::gpu
