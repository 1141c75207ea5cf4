// SPDX-License-Identifier: LGPL-2.1-or-later
// inverse-light-program, as a user runs it.
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>

#include "kernels/lightstage/program/light_program.hpp"
#include "tests/expect_error.hpp"
#include "tests/temporary_folder.hpp"

namespace inverse::testing {
namespace {

/// Its output and exit status.
std::pair<std::string, int> tool(const std::string& arguments, const std::string& before = {}) {
  FILE* pipe = popen((before + TOOL + " " + arguments + " 2>&1").c_str(), "r");
  std::string text;
  for (int c; (c = fgetc(pipe)) != EOF;) text += static_cast<char>(c);
  const int status = pclose(pipe);
  return {text, WEXITSTATUS(status)};
}

TEST(ProgramTool, WritesProgramsAtAnyRate) {
  const auto [text, status] = tool("static:96 --rate 30");
  ASSERT_EQ(status, 0) << text;
  EXPECT_EQ(LightProgram::parse(text).id(), light_program("static:96", 30).id());
  const std::string file = ::testing::TempDir() + "/program.json";
  ASSERT_EQ(tool("performance --rate 30000/1001 --overwrite " + file).second, 0);
  const LightProgram program = LightProgram::load(file);
  EXPECT_EQ(program.rate_numerator, 30000U);
  EXPECT_EQ(program.rate_denominator, 1001U);
  EXPECT_EQ(program.lights.size(), 331U);
  // One of its own at another rate.
  EXPECT_EQ(LightProgram::parse(tool(file + " --rate 60").first).id(),
            performance(program.lights).id());
  std::filesystem::remove(file);
}

TEST(ProgramTool, KeepsAFileThatExists) {
  const TemporaryFolder folder;
  const std::string file = folder.write("a.json", "mine");
  const auto [text, refused] = tool("static:4 " + file);
  EXPECT_EQ(refused, 1);
  expect_contains(text, file + " exists: give another name, or --overwrite");
  EXPECT_EQ(std::filesystem::file_size(file), 4U);
  // A write that fails leaves what was there, and nothing beside it.
  EXPECT_EQ(tool("static:4 --overwrite " + file, "trap '' XFSZ; ulimit -f 1; ").second, 1);
  EXPECT_EQ(std::filesystem::file_size(file), 4U);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
  EXPECT_EQ(tool("static:4 --overwrite " + file).second, 0);
  EXPECT_EQ(LightProgram::load(file).lights.size(), 4U);
  const std::string longest = folder / (std::string(250, 'a') + ".json");
  EXPECT_EQ(tool("static:4 " + longest).second, 0);
  EXPECT_EQ(LightProgram::load(longest).lights.size(), 4U);
  EXPECT_EQ(tool("static:4 /dev/null").second, 0);
}

TEST(ProgramTool, UnknownArgumentsAreErrors) {
  EXPECT_EQ(tool("").second, 2);
  EXPECT_EQ(tool("static --rates 5").second, 2);
  EXPECT_EQ(tool("static --rate fast").second, 1);
  EXPECT_NE(tool("/nowhere.json").first.find("/nowhere.json"), std::string::npos);
}

}  // namespace
}  // namespace inverse::testing
