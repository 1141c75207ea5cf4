// The device layer itself: barriers, partial sums, limits, sharing.
#include "gpu/reduce.hpp"
#include "gpu/shaders.hpp"
#include "gpu_fixture.hpp"
#include "image/pyramid.hpp"

namespace inverse::testing {

class DeviceTest : public GpuTest {};

TEST_F(DeviceTest, SameDeviceIsShared) { EXPECT_EQ(device, gpu::Device::open(device->name())); }

TEST_F(DeviceTest, UnknownDeviceNamesTheChoices) {
  try {
    gpu::Device::open("no such device");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::no_device);
    EXPECT_NE(std::string(error.what()).find(device->name()), std::string::npos);
  }
}

TEST_F(DeviceTest, TooLargeABufferNamesTheLimit) {
  try {
    gpu::Buffer::create(device, gpu::Element::vec4, device->limits().storage_buffer_bytes / 16 + 1);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::limit);
    EXPECT_NE(std::string(error.what()).find("maxStorageBufferRange"), std::string::npos);
  }
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

TEST_F(DeviceTest, BuffersReturnTheirMemory) {
  const uint64_t before = device->memory_bytes();
  {
    const auto buffer = gpu::Buffer::create(device, gpu::Element::vec4, 1000);
    EXPECT_GE(device->memory_bytes(), before + 16000);
  }
  EXPECT_EQ(device->memory_bytes(), before);
}

TEST_F(DeviceTest, StagesAreTimed) {
  if (device->limits().timestamp_ns == 0) GTEST_SKIP() << "this device has no timestamps";
  const auto buffer = gpu::Buffer::create(device, gpu::Element::word, 1 << 20);
  gpu::Commands commands(device);
  commands.begin();
  commands.fill(buffer, 7);
  commands.stage("fill");
  commands.submit();
  commands.wait();
  ASSERT_EQ(commands.stages().size(), 1u);
  EXPECT_STREQ(commands.stages()[0].name, "fill");
  EXPECT_GE(commands.stages()[0].milliseconds, 0.0);
}

}  // namespace inverse::testing
