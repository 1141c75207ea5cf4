// SPDX-License-Identifier: LGPL-2.1-or-later
// The device layer itself: barriers, partial sums, limits, sharing, devices that hang, validation.
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <thread>

#include "kernels/gpu/reduce.hpp"
#include "kernels/image/pyramid.hpp"
#include "kernels/palette_paint.spv.hpp"
#include "tests/expect_error.hpp"
#include "tests/kernels/gpu_fixture.hpp"

namespace inverse::testing {

class DeviceTest : public GpuTest {};

bool validation_layer_installed() {
  uint32_t count = 0;
  vkEnumerateInstanceLayerProperties(&count, nullptr);
  std::vector<VkLayerProperties> layers(count);
  vkEnumerateInstanceLayerProperties(&count, layers.data());
  return std::any_of(layers.begin(), layers.end(), [](const VkLayerProperties& layer) {
    return std::string(layer.layerName) == "VK_LAYER_KHRONOS_validation";
  });
}

TEST_F(DeviceTest, SameDeviceIsShared) { EXPECT_EQ(device, gpu::Device::open(device->name())); }

/// Leaves the fixture's device aside: another process opens it anew.
TEST(QueuesDeathTest, UsersThatDifferHaveQueuesOfTheirOwn) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto queues = [] {
    setenv("INVERSE_QUEUES", "2", 1);
    const auto fail = [](bool wrong, const char* what) {
      if (!wrong) return;
      fprintf(stderr, "wrong: %s\n", what);
      _exit(1);
    };
    const int users[3] = {};
    auto first = gpu::Device::open({}, &users[0]), second = gpu::Device::open({}, &users[1]);
    fail(first == second, "two users share an object");
    fail(first->handle() != second->handle(), "they have two devices");
    fail(first != gpu::Device::open({}, &users[0]), "a user has two objects");
    const auto third = gpu::Device::open({}, &users[2]);
    fail(third != first && third != second, "there are more than INVERSE_QUEUES");
    // Many submits at once, each of which sees its own order.
    std::vector<std::thread> threads;
    for (const auto& device : {first, second, third})
      threads.emplace_back([&fail, device] {
        const auto words =
            gpu::Buffer::create(device, gpu::Element::word, 4096, gpu::Memory::readback);
        gpu::Commands commands(device);
        for (uint32_t i = 0; i < 200; ++i) {
          commands.begin();
          commands.fill(words, i);
          commands.submit();
          commands.wait();
          fail(words->map_as<uint32_t>()[4095] != i, "a fill");
        }
      });
    for (std::thread& thread : threads) thread.join();
    second.reset();
    const auto after = gpu::Device::open({}, &users[1]);
    fail(!after, "none is left");
    first->note_lost();
    fail(!after->lost() || !third->lost(), "one is lost, not the others");
    fail(gpu::Device::open({}, &users[0])->lost(), "a lost device is opened again");
    _exit(0);
  };
  EXPECT_EXIT(queues(), ::testing::ExitedWithCode(0), "");
}

TEST_F(DeviceTest, UnknownDeviceNamesTheChoices) {
  expect_error(ErrorKind::no_device, device->name(), [] { gpu::Device::open("no such device"); });
}

TEST_F(DeviceTest, TooLargeABufferNamesTheLimit) {
  const uint64_t bytes = device->limits().storage_buffer_bytes;
  if (bytes > uint64_t{1} << 28) GTEST_SKIP() << "this device binds " << bytes << " bytes";
  const auto small = gpu::Buffer::create(device, gpu::Element::vec4, 1);
  expect_error(ErrorKind::limit, "maxStorageBufferRange",
               [&] { gpu::Buffer::create(device, gpu::Element::vec4, bytes / 16 + 1); });
  if (!device->variant().texel_views) return;
  const auto large = gpu::Buffer::create_by_rows(device, gpu::Element::vec4, bytes / 16 + 1);
  gpu::Commands commands(device);
  commands.begin();
  expect_error(ErrorKind::limit, "maxStorageBufferRange", [&] {
    commands.dispatch(gpu::Program<shaders::image_halve>(device), {.fine = small, .coarse = large},
                      {.fine_size = {2, 2}, .size = {1, 1}, .first_row = 0}, {1});
  });
  expect_error(ErrorKind::limit, "maxTexelBufferElements", [&] {
    gpu::Buffer::create_by_rows(device, gpu::Element::vec4, device->limits().texel_elements + 1);
  });
}

// What exceeds the limit is bound and written a part at a time. The order of rows: other tests with
// INVERSE_WINDOW_BYTES.
TEST_F(DeviceTest, RowsBeyondTheLargestBindingAreWritten) {
  const gpu::Limits& limits = device->limits();
  const uint64_t bytes = limits.window_bytes;
  if (bytes > uint64_t{1} << 28) GTEST_SKIP() << "this device binds " << bytes << " bytes";
  if (!device->variant().texel_views && bytes == limits.storage_buffer_bytes)
    GTEST_SKIP() << "this variant reads storage buffers";
  const Extent extent{64 * 15, static_cast<uint32_t>(bytes / 64 / 15 / 16 + 100)};
  const Plane target{extent,
                     gpu::Buffer::create_by_rows(device, gpu::Element::vec4, extent.pixels())};
  if (!target.buffer->map()) GTEST_SKIP() << "the host cannot read this device's memory";
  run([&](gpu::Commands& commands) {
    commands.fill(target.buffer);
    commands.dispatch_rows(gpu::Program<shaders::palette_paint>(device),
                           {.model = target.buffer,
                            .palette = buffer(1),
                            .painted = gpu::by_rows(gpu::aliased(target.buffer))},
                           {.size = extent, .clusters = 0, .first_row = 0},
                           {extent.width, extent.height});
  });
  const auto* pixels = target.buffer->map_as<float>();
  for (uint64_t i = 0; i < extent.pixels(); ++i) ASSERT_EQ(pixels[4 * i + 3], 1) << i;
}

TEST_F(DeviceTest, WorkIsCounted) {
  const Halve halve(device);
  const Plane fine = plane({4, 4}), middle = plane({2, 2}), coarse = plane({1, 1}),
              other = plane({2, 2});
  gpu::BufferPtr table;
  gpu::Commands commands(device);
  for (int again = 0; again < 2; ++again) {
    commands.begin();  // a barrier after earlier submits
    halve.record(commands, fine, middle);
    halve.record(commands, fine, other);             // needs none
    halve.record(commands, middle, coarse);          // reads what the first wrote
    commands.copy(middle.buffer, other.buffer, 32);  // overwrites what the second wrote
    commands.fill(coarse.buffer);                    // a kernel, as it is small
    commands.write_table(table, gpu::Element::word, std::vector<uint32_t>(20000));  // two updates
    commands.count_upload(100);
    commands.count_download(7);
    commands.submit();  // a barrier for the host
    commands.wait();
    const gpu::WorkCounts& counts = commands.counts();
    EXPECT_EQ(counts.dispatches, 4u);
    EXPECT_EQ(counts.transfers, 3u);
    EXPECT_EQ(counts.barriers, 4u) << "begin, third kernel, copy, submit";
    EXPECT_EQ(counts.transferred_bytes, 32u + 80000);
    EXPECT_EQ(counts.uploaded_bytes, 80000u + 100);
    EXPECT_EQ(counts.downloaded_bytes, 7u);
  }
  commands.begin();
  commands.stage("empty");
  if (device->limits().timestamp_ns > 0) {
    EXPECT_EQ(commands.counts().barriers, 2u) << "begin, stage";
  }
  EXPECT_EQ(commands.counts().dispatches, 0u);
  commands.submit();
}

TEST_F(DeviceTest, ChainedKernelsSeeEachOthersWrites) {
  const Halve halve(device);
  Pixels pixels(256 * 256 * 4, 3.0f);
  std::vector<Plane> levels{plane({256, 256}, pixels)};
  while (levels.back().extent.width > 1) levels.push_back(plane(half_of(levels.back().extent)));
  run([&](gpu::Commands& commands) {
    for (size_t i = 0; i + 1 < levels.size(); ++i) halve.record(commands, levels[i], levels[i + 1]);
    commands.stage("pyramid");
  });
  EXPECT_EQ(download(levels.back().buffer), Pixels(4, 3.0f));
}

// The device decides: the second condition is what a kernel wrote in the same submit.
TEST_F(DeviceTest, KernelsAreSkippedIfTheirConditionIsZero) {
  const Halve halve(device);
  const Plane ones = plane({2, 2}, Pixels(16, 1.0f)), zeros = plane({2, 2}, Pixels(16, 0.0f));
  for (const bool runs : {true, false}) {
    const Plane condition = plane({1, 1}, Pixels(4, runs ? 0.0f : 1.0f));
    const Plane target = plane({1, 1}, Pixels(4, 5.0f)), filled = plane({1, 1}, Pixels(4, 5.0f));
    run([&](gpu::Commands& commands) {
      halve.record(commands, runs ? ones : zeros, condition);
      commands.when(condition.buffer, 4, [&] {
        halve.record(commands, ones, target);
        commands.fill(filled.buffer, 0x3f800000);
      });
    });
    const bool ran = runs || !device->variant().conditional;
    EXPECT_EQ(download(target), Pixels(4, ran ? 1.0f : 5.0f));
    EXPECT_EQ(download(filled), Pixels(4, ran ? 1.0f : 5.0f));
  }
}

TEST_F(DeviceTest, UnconditionalWorkIsRefusedInsideACondition) {
  const auto word = gpu::Buffer::create(device, gpu::Element::word, 1);
  gpu::Commands commands(device);
  commands.begin();
  expect_error(ErrorKind::internal, "a copy inside of a condition",
               [&] { commands.when(word, 0, [&] { commands.copy(word, word, 4); }); });
  commands.begin();
  expect_error(ErrorKind::internal, "another condition inside of a condition",
               [&] { commands.when(word, 0, [&] { commands.when(word, 0, [] {}); }); });
  commands.begin();
  EXPECT_NO_THROW(commands.fill(word));
  commands.submit();
  commands.wait();
}

TEST_F(DeviceTest, OneBufferIsBoundTwiceOnPurposeOnly) {
  const auto buffer = gpu::Buffer::create(device, gpu::Element::vec4, 4);
  const gpu::Program<shaders::image_halve> halve(device);
  gpu::Commands commands(device);
  commands.begin();
  expect_error(ErrorKind::internal, "one buffer at bindings 0 and 1", [&] {
    commands.dispatch(halve, {.fine = buffer, .coarse = buffer},
                      {.fine_size = {2, 2}, .size = {1, 1}, .first_row = 0}, {1});
  });
  commands.begin();
  EXPECT_NO_THROW(commands.dispatch(halve, {.fine = gpu::aliased(buffer), .coarse = buffer},
                                    {.fine_size = {2, 2}, .size = {1, 1}, .first_row = 0}, {1}));
  commands.submit();
  commands.wait();
}

TEST_F(DeviceTest, BuffersReturnTheirMemory) {
  const uint64_t before = device->memory_bytes();
  {
    const auto buffer = gpu::Buffer::create(device, gpu::Element::vec4, 1000);
    EXPECT_GE(device->memory_bytes(), before + 16000);
  }
  EXPECT_EQ(device->memory_bytes(), before);
}

TEST_F(DeviceTest, BuildsEveryKernelThatWasMadeOnce) {
  const gpu::Program<shaders::image_halve> made(device, {}, 24);  // no other test has this size
  const uint64_t before = device->kernels_used();
  gpu::build_kernels(device);
  const uint64_t built = device->kernels_used();
  EXPECT_EQ(built > before, device->variant().warm_up);
  gpu::build_kernels(device);
  EXPECT_EQ(device->kernels_used(), built);
}

TEST_F(DeviceTest, StagesAreTimed) {
  if (device->limits().timestamp_ns == 0) GTEST_SKIP() << "this device has no timestamps";
  const auto buffer = gpu::Buffer::create(device, gpu::Element::word, 1 << 20);
  gpu::Commands commands(device);
  commands.begin();
  for (const int fills : {1, 50}) {
    for (int i = 0; i < fills; ++i) commands.fill(buffer, 7);
    commands.stage(fills == 1 ? "one fill" : "fifty fills");
  }
  const auto began = std::chrono::steady_clock::now();
  commands.submit();
  commands.wait();
  const std::chrono::duration<double, std::milli> passed = std::chrono::steady_clock::now() - began;
  ASSERT_EQ(commands.stages().size(), 2u);
  EXPECT_STREQ(commands.stages()[0].name, "one fill");
  EXPECT_STREQ(commands.stages()[1].name, "fifty fills");
  EXPECT_GT(commands.stages()[0].milliseconds, 0);
  EXPECT_GT(commands.stages()[1].milliseconds, 0);
  const double sum = commands.stages()[0].milliseconds + commands.stages()[1].milliseconds;
  EXPECT_LE(sum, passed.count());
  EXPECT_NEAR(commands.device_ms(), sum, 1e-6);
}

TEST_F(DeviceTest, TheHostWorksBetweenTwoHalvesOfOneSubmit) {
  const auto buffer = gpu::Buffer::create(device, gpu::Element::word, 64, gpu::Memory::readback);
  const auto more = gpu::Buffer::create(device, gpu::Element::word, 64, gpu::Memory::upload);
  const auto result = gpu::Buffer::create(device, gpu::Element::word, 64, gpu::Memory::readback);
  gpu::Commands commands(device);
  for (int run = 0; run < 2; ++run) {
    commands.begin();
    commands.fill(buffer, 7);
    commands.stage("before");
    commands.on_host([&] {
      for (int i = 0; i < 64; ++i) {
        EXPECT_EQ(buffer->map_as<uint32_t>()[i], 7U);
        more->map_as<uint32_t>()[i] = 8 + unsigned(i + run);
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    });
    commands.copy(more, result, result->bytes());
    commands.stage("after");
    commands.submit();
    commands.wait();
    for (int i = 0; i < 64; ++i) EXPECT_EQ(result->map_as<uint32_t>()[i], 8U + unsigned(i + run));
    EXPECT_EQ(commands.counts().transfers + commands.counts().dispatches, 2U);  // fill, copy
    if (device->limits().timestamp_ns == 0) continue;
    ASSERT_EQ(commands.stages().size(), 2U);
    EXPECT_STREQ(commands.stages()[0].name, "before");
    EXPECT_STREQ(commands.stages()[1].name, "after");
    EXPECT_GE(commands.stages()[1].milliseconds, 5);  // the host's time is in the stage around it
    EXPECT_GE(commands.device_ms(), commands.stages()[1].milliseconds);
  }
  commands.begin();
  const auto condition = gpu::make_table(device, gpu::Element::word, std::vector<uint32_t>{1});
  EXPECT_THROW(commands.when(condition, 0, [&] { commands.on_host([] {}); }), Error);
}

TEST_F(DeviceTest, StagesThatAreNotTimedCostNoBarriers) {
  if (device->limits().timestamp_ns == 0) GTEST_SKIP() << "this device has no timestamps";
  const auto buffer = gpu::Buffer::create(device, gpu::Element::word, 1 << 20);
  gpu::Commands commands(device);
  commands.time_stages(false);
  uint32_t barriers = 0;
  for (const int stages : {0, 5}) {
    commands.begin();
    commands.fill(buffer, 7);
    for (int i = 0; i < stages; ++i) commands.stage("nothing");
    commands.submit();
    commands.wait();
    EXPECT_TRUE(commands.stages().empty());
    EXPECT_GT(commands.device_ms(), 0);
    if (stages == 0) barriers = commands.counts().barriers;
    EXPECT_EQ(commands.counts().barriers, barriers);
  }
  commands.time_stages(true);
  commands.begin();
  commands.stage("timed");
  commands.submit();
  commands.wait();
  EXPECT_EQ(commands.stages().size(), 1u);
}

TEST_F(DeviceTest, MalformedEnvironmentVariablesAreRefused) {
  shared_device().reset();
  device.reset();
  for (const char* text : {"ten", "10s", "-1", "1.5", "99999999999", " 5"}) {
    setenv("INVERSE_TIMEOUT", text, 1);
    expect_contains(expect_error(ErrorKind::unsupported, text, [] { gpu::Device::open(); }),
                    "INVERSE_TIMEOUT");
  }
  setenv("INVERSE_TIMEOUT", "75", 1);
  EXPECT_EQ(gpu::Device::open()->timeout_ns(), 75'000'000'000U);
  unsetenv("INVERSE_TIMEOUT");
}

// A device that does not finish in time is reported, and what it still works on stays its own.
TEST_F(DeviceTest, AnUnresponsiveDeviceIsLostAndKeepsItsBuffers) {
  const uint64_t before = device->memory_bytes();
  const uint64_t words = device->limits().storage_buffer_bytes >= (1u << 27) ? 1u << 25 : 1u << 22;
  const auto kept = std::make_shared<int>();
  {
    device->set_timeout(0);
    gpu::Commands commands(device), behind(device);
    const auto buffer = gpu::Buffer::create(device, gpu::Element::word, words);
    for (gpu::Commands* work : {&commands, &behind}) {
      work->begin();
      for (int i = 0; i < 20; ++i) work->fill(buffer, i);
      work->submit();
    }
    behind.keep(kept);
    expect_error(ErrorKind::device_lost, "INVERSE_TIMEOUT", [&] { commands.wait(); });
    expect_error(ErrorKind::device_lost, "did not finish", [&] { commands.begin(); });
    EXPECT_TRUE(device->unresponsive());
    device->set_timeout(60);
  }
  EXPECT_EQ(kept.use_count(), 2) << "what stands in line behind it is not waited for, either";
  EXPECT_GE(device->memory_bytes(), before + 4 * words);
  // The device itself continues: later work runs after its unfinished work.
  const auto buffer = gpu::Buffer::create(device, gpu::Element::word, 4);
  run([&](gpu::Commands& commands) { commands.fill(buffer, 0x3f800000); });
  EXPECT_EQ(download(buffer), Pixels(4, 1.0f));
  EXPECT_FALSE(device->unresponsive());
}

// Under INVERSE_VALIDATION=1 a misuse of Vulkan ends the process, so that no test can miss it.
TEST(ValidationDeathTest, AMisuseOfVulkanEndsTheProcess) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto misuse = [] {
    setenv("INVERSE_VALIDATION", "1", 1);
    try {
      const auto device = gpu::Device::open();
      const auto buffer = gpu::Buffer::create(device, gpu::Element::word, 16);
      gpu::Commands commands(device);
      commands.begin();
      commands.copy(buffer, buffer, 64, 0, 64);  // beyond the end of the target
    } catch (const Error& error) {
      fprintf(stderr, "%s\n", error.what());
      _exit(0);
    }
    _exit(0);
  };
  if (!validation_layer_installed()) GTEST_SKIP() << "the Vulkan validation layer is missing";
  EXPECT_EXIT(misuse(), ::testing::KilledBySignal(SIGABRT), "Vulkan validation: .*vkCmdCopyBuffer");
}

}  // namespace inverse::testing
