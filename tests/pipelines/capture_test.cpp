// SPDX-License-Identifier: LGPL-2.1-or-later
// The line that writes a static capture of a light stage.
#include <filesystem>
#include <fstream>

#include "pipeline_test.hpp"

namespace inverse::testing {
namespace {

class Capture : public PipelineTest {};

TEST_F(Capture, EveryLightIsWritten) {
  ASSERT_EQ(run("static-capture", {"static:20", file("set"), "160", "120"}), 0) << output_;
  const std::filesystem::path folder = file("set") + "/camera_0";
  size_t lights = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "olat"))
    lights += entry.path().extension() == ".exr" && entry.file_size() > 10000 ? 1 : 0;
  EXPECT_EQ(lights, 20U);
  for (const char* name : {"tracking.exr", "gradient-a.exr", "gradient-b.exr", "lights.json"})
    EXPECT_TRUE(std::filesystem::exists(folder / name)) << name;
}

TEST_F(Capture, MissingInputIsAnError) {
  expect_failure("static-capture", {"/no/such/program.json", file("set")},
                 "there is no light program");
  expect_failure("static-capture", {"static:4", "/proc/nowhere"}, "/proc/nowhere");
}

}  // namespace
}  // namespace inverse::testing
