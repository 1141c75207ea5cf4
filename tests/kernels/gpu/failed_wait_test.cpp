// SPDX-License-Identifier: LGPL-2.1-or-later
// Waits for the device that fail, by a vkWaitForFences of our own.
#include <dlfcn.h>

#include <memory>
#include <utility>

#include "common/error.hpp"
#include "kernels/gpu/commands.hpp"
#include "tests/kernels/gpu_fixture.hpp"

namespace {
VkResult next_result = VK_SUCCESS;  // of the next call
}

extern "C" VKAPI_ATTR VkResult VKAPI_CALL vkWaitForFences(VkDevice device, uint32_t count,
                                                          const VkFence* fences, VkBool32 all,
                                                          uint64_t timeout) {
  static const auto wait =
      reinterpret_cast<PFN_vkWaitForFences>(dlsym(RTLD_NEXT, "vkWaitForFences"));
  const VkResult result = std::exchange(next_result, VK_SUCCESS);
  // A device that is lost runs nothing any more, so this one must not, either.
  if (result == VK_ERROR_DEVICE_LOST) wait(device, count, fences, all, UINT64_MAX);
  return result == VK_SUCCESS ? wait(device, count, fences, all, timeout) : result;
}

namespace inverse::testing {

/// The device is lost behind each test: others get another one, without what is abandoned here.
class FailedWait : public GpuTest {
 protected:
  void TearDown() override {
    if (device->lost()) return;
    gpu::Commands commands(device);
    submit(commands, buffer(1));
    next_result = VK_ERROR_DEVICE_LOST;
    EXPECT_THROW(commands.wait(), Error);
  }
  /// Submits work that only its commands hold.
  static std::weak_ptr<gpu::Buffer> submit(gpu::Commands& commands, const gpu::BufferPtr& made) {
    commands.begin();
    commands.fill(made, 7);
    commands.keep(made);
    commands.submit();
    return made;
  }
};

TEST_F(FailedWait, WorkThatMayStillRunKeepsItsBuffers) {
  for (const VkResult failure : {VK_ERROR_OUT_OF_HOST_MEMORY, VK_ERROR_OUT_OF_DEVICE_MEMORY}) {
    gpu::Commands commands(device);
    const auto words = submit(commands, buffer(64));
    next_result = failure;
    EXPECT_THROW(commands.wait(), Error);
    EXPECT_FALSE(words.expired());
    commands.wait();
    EXPECT_TRUE(words.expired());
  }
}

TEST_F(FailedWait, WorkThatMayStillRunOutlivesItsCommands) {
  std::weak_ptr<gpu::Buffer> words;
  {
    gpu::Commands commands(device);
    words = submit(commands, buffer(64));
    next_result = VK_ERROR_OUT_OF_HOST_MEMORY;
  }
  EXPECT_FALSE(words.expired());
}

TEST_F(FailedWait, ALostDeviceIsDone) {
  gpu::Commands commands(device);
  const auto words = submit(commands, buffer(64));
  next_result = VK_ERROR_DEVICE_LOST;
  EXPECT_THROW(commands.wait(), Error);
  EXPECT_TRUE(commands.done());
  EXPECT_TRUE(device->lost());
}

}  // namespace inverse::testing
