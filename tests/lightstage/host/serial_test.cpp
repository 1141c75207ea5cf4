// SPDX-License-Identifier: LGPL-2.1-or-later
// The serial backend against a simulated controller on a pseudo-terminal.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "common/error.hpp"
#include "kernels/lightstage/controllers/light_driver.hpp"
#include "kernels/lightstage/controllers/serial_protocol.hpp"
#include "serial_controller.hpp"
#include "two_lights.hpp"

namespace inverse::testing {
namespace {

using Clock = std::chrono::steady_clock;

LightDriverSettings settings_for(const std::string& port) {
  LightDriverSettings settings;
  settings.backend = LightDriverSettings::Backend::serial;
  settings.serial.port = port;
  settings.serial.timeout = 1;
  return settings;
}

/// A driver that has uploaded a program.
std::unique_ptr<LightDriver> started(const LightDriverSettings& settings) {
  auto driver = make_light_driver(settings);
  driver->upload(two_lights());
  return driver;
}

/// Error of `upload` for a controller with these replies, within about the timeout.
std::string upload_error(Controller& controller) {
  const auto start = Clock::now();
  const std::string error = error_of([&] { started(settings_for(controller.path())); });
  EXPECT_LT(Clock::now() - start, std::chrono::seconds(6));
  return error;
}

class SerialDriver : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!has_pseudo_terminals())
      GTEST_SKIP() << "this system has no pseudo-terminals: mount /dev/pts";
  }
};

TEST(SerialProtocol, ChecksumIsTheUsualOne) {
  EXPECT_EQ(serial::crc32("123456789"), 0xcbf43926U);  // the check value of CRC-32
  EXPECT_EQ(serial::crc32(""), 0U);
}

TEST(SerialProtocol, LinesAreCutAndBounded) {
  serial::LineReader reader;
  const std::string text =
      "ok\r\n\n\x01"
      "error\xff now\nrest";
  for (const char c : text) reader.take({&c, 1});
  EXPECT_EQ(reader.next(), "ok");
  EXPECT_EQ(reader.next(), "?error? now");
  EXPECT_FALSE(reader.next());
  const std::string flood(1 << 20, 'x');
  reader.take(flood);
  reader.take(std::string("\n"));
  EXPECT_EQ(reader.next()->size(), serial::kMaxReplyLength);
  const std::string many(1 << 20, '\n');
  std::string alternating;
  for (int i = 0; i < 100000; ++i) alternating += "a\n";
  reader.take(alternating);
  int lines = 0;
  while (reader.next()) ++lines;
  EXPECT_LE(lines, 1024);
}

TEST(SerialProtocol, Replies) {
  using Kind = serial::Reply::Kind;
  EXPECT_EQ(serial::parse_reply("ok 1234abcd").text, "1234abcd");
  EXPECT_EQ(serial::parse_reply("error lamp 3 is dead").text, "lamp 3 is dead");
  const auto hello = serial::parse_reply("hello 7 1 a big rig");
  EXPECT_EQ(hello.kind, Kind::hello);
  EXPECT_EQ(hello.token, 7U);
  EXPECT_EQ(hello.version, 1);
  EXPECT_EQ(hello.text, "a big rig");
  for (const char* text : {"", " ", "okay", "hello", "hello x 1", "hello 1", "hello 99999999999 1",
                           "hello -1 1", "Error", "hello  1 1"})
    EXPECT_EQ(serial::parse_reply(text).kind, Kind::other) << text;
}

// 100 kB of JSON would be 3 GB of lines.
TEST(SerialProtocol, ProgramsThatExpandToGigabytesAreRefused) {
  const auto gradients = [](size_t steps) {
    LightProgram program = performance(stage_lights(geodesic_directions(4096)));
    program.steps.resize(steps, program.steps.front());
    return program;
  };
  expect_error(ErrorKind::unsupported, "more than 64 MiB of colors for a serial controller",
               [&] { serial::program_lines(gradients(LightProgram::kMaxSteps)); });
  EXPECT_EQ(serial::program_lines(gradients(100)).size(), 105U);
}

TEST_F(SerialDriver, UploadsOnceAndSteps) {
  for (const auto marker :
       {LightProgram::Marker::start, LightProgram::Marker::pass, LightProgram::Marker::none}) {
    ConnectedRig rig;
    LightProgram program = two_lights();
    program.marker = marker;
    const auto driver = make_light_driver(settings_for(rig.path()));
    driver->upload(program);
    uint64_t pulses = 0;
    for (uint64_t t = 0; t <= program.triggers().value() + 2; ++t) {
      if (t == 4) continue;  // a pulse that was never sent does no harm
      driver->show(t);
      const auto lights = rig.after(++pulses);
      const auto colors = program.colors(program.at(t));
      ASSERT_EQ(lights.size(), colors.size());
      for (size_t i = 0; i < lights.size(); ++i)
        for (size_t c = 0; c < 3; ++c)
          EXPECT_NEAR(lights[i][c], 65535 * colors[i][c], .5001) << "trigger " << t;
    }
    driver->show(1);
    driver->black();
    EXPECT_EQ(rig.after(0), Rig::Lights(2));
    EXPECT_EQ(rig.lines(0).back(), "off");
    driver->upload(program);  // another start of the same one
    driver->show(0);
    driver->black();
    EXPECT_EQ(rig.count("begin"), 1);
    EXPECT_EQ(rig.count("go"), 2);
    program.steps.pop_back();
    driver->upload(program);
    EXPECT_EQ(rig.count("begin"), 2);
  }
}

TEST_F(SerialDriver, RestartedControllersReceiveTheProgramAgain) {
  Rig rig;
  bool forgotten = false;
  Controller controller([&](const std::string& line) -> std::string {
    if (line.starts_with("begin")) forgotten = false;
    return forgotten && line.starts_with("go") ? "error no program\n" : rig(line);
  });
  const auto driver = started(settings_for(controller.path()));
  driver->black();
  forgotten = true;
  driver->upload(two_lights());
  driver->show(0);
  EXPECT_EQ(controller.count("begin"), 2);
}

TEST_F(SerialDriver, UploadsBigPrograms) {
  ConnectedRig rig;
  LightProgram program = static_capture(stage_lights(geodesic_directions(331)), 60);
  const auto driver = make_light_driver(settings_for(rig.path()));
  driver->upload(program);
  driver->show(3 + 330 + 30);  // the last light comes after 30 tracking frames
  const auto lights = rig.after(1);
  ASSERT_EQ(lights.size(), 331U);
  EXPECT_EQ(lights[330][1], 65535);
  EXPECT_EQ(lights[329][1], 0);
}

TEST_F(SerialDriver, DoesNotStepForTheRig) {
  ConnectedRig rig;
  auto settings = settings_for(rig.path());
  settings.serial.pulses = false;
  const auto driver = started(settings);
  for (int t = 0; t < 5; ++t) driver->show(t);
  driver->black();
  const auto lines = rig.lines(0);
  EXPECT_EQ(lines[lines.size() - 2], "go trigger");
}

TEST_F(SerialDriver, WaitsForControllersThatStart) {
  Rig rig;
  std::atomic<int> greetings = 0;
  Controller controller([&](const std::string& line) -> std::string {
    if (line.starts_with("hello") && ++greetings < 3) return greetings == 1 ? "" : "booting...\n";
    return rig(line);
  });
  auto settings = settings_for(controller.path());
  settings.serial.timeout = 5;
  const auto driver = started(settings);
  EXPECT_EQ(greetings, 3);
}

TEST_F(SerialDriver, AnUnresponsiveControllerIsAnError) {
  Controller unresponsive([](const std::string&) { return ""; });
  expect_contains(upload_error(unresponsive), "does not answer; check its cable");
  Rig rig;
  Controller half(
      [&](const std::string& line) { return line.starts_with("set 3") ? "" : rig(line); });
  expect_contains(upload_error(half), "does not answer \"set\"");
}

TEST_F(SerialDriver, MalformedRepliesAreErrors) {
  Controller rubbish([](const std::string&) { return "\x80\xffU*U*\x01\n"; });
  expect_contains(upload_error(rubbish), "is not of this protocol; check the baud rate");
  Rig rig;
  Controller later(
      [&](const std::string& line) { return line.starts_with("set") ? "what?\n" : rig(line); });
  expect_contains(upload_error(later), "sends \"what?\", which is no reply");
  Controller flood([](const std::string&) { return std::string(3000, 'x'); });
  expect_contains(upload_error(flood), "does not answer");
  Controller newer([](const std::string& line) { return line + " 2 a rig of tomorrow\n"; });
  expect_contains(upload_error(newer), "has version 2");
}

TEST_F(SerialDriver, ErrorsOfTheControllerAreReported) {
  Rig rig;
  Controller small([&](const std::string& line) {
    return line.starts_with("begin") ? "error no memory for 2 lights\n" : rig(line);
  });
  expect_contains(upload_error(small), "reports: no memory for 2 lights");
  Controller wrong([&](const std::string& line) {
    return line.starts_with("end") ? "ok 00000000\n" : rig(line);
  });
  expect_contains(upload_error(wrong), "checksum \"00000000\"");
  ConnectedRig dying;
  const auto driver = started(settings_for(dying.path()));
  driver->show(0);
  dying.say("error lamp 1 is dead\n");
  std::string error;
  for (int t = 1; t < 100 && error.empty(); ++t) {
    error = error_of([&] { driver->show(t); });
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  expect_contains(error, "reports: lamp 1 is dead");
}

TEST_F(SerialDriver, ADisconnectedControllerIsAnError) {
  ConnectedRig rig;
  const auto driver = started(settings_for(rig.path()));
  driver->show(0);
  rig.hang_up();
  expect_contains(error_of([&] { driver->show(1); }), "has disconnected");
  expect_contains(error_of([&] { driver->black(); }), "has disconnected");
}

TEST_F(SerialDriver, ControllersThatStopTakingPulses) {
  Rig rig;
  std::atomic<bool> stuck{false};
  Controller controller([&](const std::string& line) {
    while (stuck) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    return rig(line);
  });
  auto driver = started(settings_for(controller.path()));
  stuck = true;
  std::string error;
  const auto start = Clock::now();
  for (uint64_t t = 0; t < 10'000'000 && error.empty(); ++t)
    error = error_of([&] { driver->show(t); });
  EXPECT_LT(Clock::now() - start, std::chrono::seconds(20));
  expect_contains(error, "accepts no more data");
  stuck = false;
  driver.reset();
}

TEST_F(SerialDriver, CanBeCancelled) {
  Controller unresponsive([](const std::string&) { return ""; });
  auto settings = settings_for(unresponsive.path());
  settings.serial.timeout = 60;
  const auto driver = make_light_driver(settings);
  std::thread other([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    driver->cancel();
  });
  const auto start = Clock::now();
  expect_contains(error_of([&] { driver->upload(two_lights()); }), "given up");
  EXPECT_LT(Clock::now() - start, std::chrono::seconds(5));
  other.join();
}

TEST_F(SerialDriver, InvalidPortsAreErrors) {
  const auto upload = [](LightDriverSettings settings) {
    return error_of([&] { started(settings); });
  };
  expect_contains(upload(settings_for("/dev/no-such-tty")), "cannot open the serial port");
  expect_contains(upload(settings_for("/dev/null")), "is no serial port");
  expect_contains(upload(settings_for("")), "needs the name of its port");
  auto settings = settings_for("/dev/null");
  settings.serial.baud = 12345;
  expect_contains(upload(settings), "12345 baud");
  ConnectedRig rig;
  const auto driver = started(settings_for(rig.path()));
  expect_contains(upload(settings_for(rig.path())), "in use by another program");
}

}  // namespace
}  // namespace inverse::testing
