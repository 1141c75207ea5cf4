// SPDX-License-Identifier: LGPL-2.1-or-later
#include "pipeline_test.hpp"

#include <chrono>
#include <thread>

namespace inverse::testing {

std::string PipelineTest::script(const std::string& name) { return SCRIPTS "/" + name; }

Process::Environment PipelineTest::environment(const Process::Environment& more) {
  Process::Environment all{{"DISPLAY", ""}, {"WAYLAND_DISPLAY", ""}, {"SOURCE", ""}, {"SINK", ""}};
  for (const auto& [name, value] : more) all[name] = value;
  return all;
}

int PipelineTest::run(const std::string& name, const std::vector<std::string>& words,
                      const Process::Environment& more, double seconds) {
  std::vector<std::string> command{script(name)};
  command.insert(command.end(), words.begin(), words.end());
  Process process(command, environment(more));
  const int status = process.wait(seconds);
  output_ = process.output();
  EXPECT_NE(status, -1) << name << " did not end within " << seconds << " s:\n" << output_;
  return status;
}

void PipelineTest::expect_failure(const std::string& name, const std::vector<std::string>& words,
                                  const std::string& text, const Process::Environment& more) {
  EXPECT_EQ(run(name, words, more), 1);
  expect_contains(output_, text);
}

void PipelineTest::end_when_grown(Process& line, const std::string& path, uintmax_t bytes,
                                  Process* peer) {
  for (int i = 0; i < 1200; ++i) {  // two minutes
    std::error_code code;
    if (std::filesystem::file_size(path, code) > bytes && !code) break;
    ASSERT_TRUE(line.running()) << line.output();
    ASSERT_TRUE(!peer || peer->running()) << peer->output();
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  line.interrupt();
  EXPECT_EQ(line.wait(30), 0) << line.output();
}

std::string raw_file(const std::string& path) {
  return "queue ! video/x-raw,format=I420 ! matroskamux ! filesink location=" + path;
}

void expect_mosaic(const Image& frame) {
  EXPECT_GT(frame.variance(0, 0, .5, .5), 100) << "the input is flat";
  EXPECT_GT(frame.variance(.5, 0, 1, .5), 20) << "the reflectance is flat";
  EXPECT_GT(frame.mean(0, 0, .5, .5, 1), 16) << "the shading is black";
}

}  // namespace inverse::testing

int main(int count, char** arguments) {
  ::testing::InitGoogleTest(&count, arguments);
  gst_init(&count, &arguments);
  return RUN_ALL_TESTS();
}
