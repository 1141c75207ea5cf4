// SPDX-License-Identifier: LGPL-2.1-or-later
// inverse-light-program, as a user runs it.
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>

#include "stage/program/light_program.hpp"

namespace inverse::testing {
namespace {

/// Its output and exit status.
std::pair<std::string, int> tool(const std::string& arguments) {
  FILE* pipe = popen((std::string(TOOL) + " " + arguments + " 2>&1").c_str(), "r");
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
  ASSERT_EQ(tool("performance --rate 30000/1001 " + file).second, 0);
  const LightProgram program = LightProgram::load(file);
  EXPECT_EQ(program.rate_numerator, 30000U);
  EXPECT_EQ(program.rate_denominator, 1001U);
  EXPECT_EQ(program.lights.size(), 331U);
  // One of its own at another rate.
  EXPECT_EQ(LightProgram::parse(tool(file + " --rate 60").first).id(),
            performance(program.lights).id());
  std::filesystem::remove(file);
}

TEST(ProgramTool, UnknownArgumentsAreErrors) {
  EXPECT_EQ(tool("").second, 2);
  EXPECT_EQ(tool("static --rates 5").second, 2);
  EXPECT_EQ(tool("static --rate fast").second, 1);
  EXPECT_NE(tool("/nowhere.json").first.find("/nowhere.json"), std::string::npos);
}

}  // namespace
}  // namespace inverse::testing
