// SPDX-License-Identifier: LGPL-2.1-or-later
// Memory that buffers share, and compiled kernels in a file.
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>

#include "kernels/gpu/commands.hpp"
#include "kernels/gpu/pipeline_cache.hpp"
#include "tests/kernels/gpu_fixture.hpp"
#include "tests/temporary_folder.hpp"

namespace inverse::testing {

class MemoryTest : public GpuTest {};

TEST_F(MemoryTest, SmallBuffersShareAllocations) {
  const size_t before = device->memory().allocations();
  std::vector<gpu::BufferPtr> buffers;
  for (uint32_t i = 0; i < 4096; ++i) buffers.push_back(buffer(1 + i % 256));
  EXPECT_LE(device->memory().allocations(), before + 2);
  buffers.clear();
  EXPECT_LE(device->memory().allocations(), before + 1) << "one block is kept";
}

TEST_F(MemoryTest, LargeBuffersReturnToTheDriver) {
  const size_t before = device->memory().allocations();
  gpu::BufferPtr large = buffer(gpu::MemoryBlocks::kOwn / 16);
  EXPECT_EQ(device->memory().allocations(), before + 1);
  large.reset();
  EXPECT_EQ(device->memory().allocations(), before);
}

// Each buffer holds a number of its own while others come and go.
TEST_F(MemoryTest, BuffersNeverOverlap) {
  struct Owned {
    gpu::BufferPtr buffer;
    uint32_t number;
  };
  std::mt19937 random(3);
  std::vector<Owned> held;
  const auto check_and_drop = [&](size_t i) {
    const auto* words = held[i].buffer->map_as<uint32_t>();
    for (uint64_t k = 0; k < held[i].buffer->count(); ++k) ASSERT_EQ(words[k], held[i].number);
    held.erase(held.begin() + static_cast<ptrdiff_t>(i));
  };
  for (uint32_t round = 0; round < 3000; ++round) {
    if (held.size() > 100 || (!held.empty() && random() % 3 == 0)) {
      ASSERT_NO_FATAL_FAILURE(check_and_drop(random() % held.size()));
      continue;
    }
    const uint64_t words = 1 + random() % (random() % 10 == 0 ? 1U << 21U : 5000U);
    held.push_back(
        {gpu::Buffer::create(device, gpu::Element::word, words, gpu::Memory::upload), round});
    std::fill_n(held.back().buffer->map_as<uint32_t>(), words, round);
  }
  while (!held.empty()) ASSERT_NO_FATAL_FAILURE(check_and_drop(held.size() - 1));
}

class PipelineCacheTest : public GpuTest {
 protected:
  void SetUp() override {
    GpuTest::SetUp();
    vkGetPhysicalDeviceProperties(device->physical(), &properties_);
    const char* before = std::getenv(kVariable);
    before_ = before ? before : "";
    was_set_ = before;
  }
  void TearDown() override {
    was_set_ ? setenv(kVariable, before_.c_str(), 1) : unsetenv(kVariable);
  }
  /// Makes a cache that keeps its file in `folder`.
  void use(const std::filesystem::path& folder) const {
    setenv(kVariable, folder.c_str(), 1);
    EXPECT_NO_THROW(gpu::PipelineCache(device->handle(), properties_));
  }
  static size_t files_in(const std::filesystem::path& folder) {
    if (!std::filesystem::exists(folder)) return 0;
    return static_cast<size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
  }

  static constexpr const char* kVariable = "INVERSE_PIPELINE_CACHE";
  VkPhysicalDeviceProperties properties_{};
  std::string before_;
  bool was_set_ = false;
};

TEST_F(PipelineCacheTest, IsKeptInOneFile) {
  const TemporaryFolder folder;
  const std::filesystem::path inside = std::filesystem::path(folder.path()) / "a" / "b";
  use(inside);
  ASSERT_EQ(files_in(inside), 1U);
  const auto file = std::filesystem::directory_iterator(inside)->path();
  EXPECT_GE(std::filesystem::file_size(file), 32U);  // Vulkan's header
  use(inside);
  EXPECT_EQ(files_in(inside), 1U);
}

TEST_F(PipelineCacheTest, FilesOfOthersAndBrokenOnesAreReplaced) {
  const TemporaryFolder folder;
  use(folder.path());
  const auto file = std::filesystem::directory_iterator(folder.path())->path();
  const auto size = std::filesystem::file_size(file);
  for (const size_t length : {size_t{0}, size_t{7}, size_t{32}, size_t{1000}}) {
    std::ofstream(file, std::ios::trunc) << std::string(length, 'x');
    use(folder.path());
    EXPECT_EQ(std::filesystem::file_size(file), size) << length;
  }
  EXPECT_EQ(files_in(folder.path()), 1U);
}

// Drivers parse what it has, and trust it.
TEST_F(PipelineCacheTest, DamagedFilesAndThoseThatOthersMayWriteToAreReplaced) {
  const TemporaryFolder folder;
  use(folder.path());
  const auto file = std::filesystem::directory_iterator(folder.path())->path();
  const auto content = [&] {
    std::ifstream stream(file, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(stream), {});
  };
  const std::string whole = content();
  std::string damaged = whole;
  damaged.back() ^= 1;
  std::ofstream(file, std::ios::binary) << damaged;
  std::ofstream(file.string() + ".abcdef") << "of a process that was killed";
  std::filesystem::last_write_time(
      file.string() + ".abcdef",
      std::filesystem::file_time_type::clock::now() - std::chrono::hours(2));
  use(folder.path());
  EXPECT_EQ(content(), whole);
  EXPECT_EQ(files_in(folder.path()), 1U);
  using Permissions = std::filesystem::perms;
  std::filesystem::permissions(file, Permissions::others_write, std::filesystem::perm_options::add);
  use(folder.path());
  EXPECT_EQ(std::filesystem::status(file).permissions() & Permissions::others_write,
            Permissions::none)
      << "written anew";
}

TEST_F(PipelineCacheTest, AFolderThatCannotBeWrittenIsIgnored) {
  const TemporaryFolder folder;
  const std::filesystem::path file(folder / "file");
  std::ofstream(file) << "not a folder";
  use(file);
  use("");
  EXPECT_EQ(std::filesystem::file_size(file), 12U);
}

}  // namespace inverse::testing
