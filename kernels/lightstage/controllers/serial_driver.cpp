// SPDX-License-Identifier: LGPL-2.1-or-later
// Light programs stored in a controller, over a serial line.
#include <fcntl.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <termios.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>
#include <map>

#include "common/error.hpp"
#include "descriptor.hpp"
#include "light_drivers.hpp"
#include "serial_protocol.hpp"

namespace inverse {
namespace {

using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

constexpr double kHelloInterval = 0.5;  // s; a controller that boots on open misses the first ones
constexpr Seconds kPulseTimeout{0.1};
constexpr int kPollInterval = 50;  // ms between checks of cancelled_

Clock::time_point after(double seconds) {
  return Clock::now() + std::chrono::duration_cast<Clock::duration>(Seconds(seconds));
}

speed_t speed_of(uint32_t baud) {
  static const std::map<uint32_t, speed_t> kSpeeds = {
      {9600, B9600},       {19200, B19200},     {38400, B38400},     {57600, B57600},
      {115200, B115200},   {230400, B230400},   {460800, B460800},   {500000, B500000},
      {921600, B921600},   {1000000, B1000000}, {1500000, B1500000}, {2000000, B2000000},
      {3000000, B3000000}, {4000000, B4000000}};
  const auto found = kSpeeds.find(baud);
  if (found == kSpeeds.end())
    throw Error(ErrorKind::unsupported, "serial ports do not run at " + std::to_string(baud) +
                                            " baud; 115200 and 921600 are usual");
  return found->second;
}

class SerialDriver final : public LightDriver {
 public:
  explicit SerialDriver(const LightDriverSettings::Serial& settings) : settings_(settings) {
    if (settings_.port.empty())
      throw Error(ErrorKind::unsupported,
                  "a serial controller needs the name of its port, such as /dev/ttyUSB0");
    if (!(settings_.timeout > 0 && settings_.timeout <= 3600))
      throw Error(ErrorKind::unsupported,
                  "the timeout of a serial controller has to be above 0 and at most 3600 s");
    speed_of(settings_.baud);
  }
  ~SerialDriver() override {
    try {
      black();
    } catch (const Error&) {
      // A destructor cannot throw; call black() first to receive errors.
    }
  }

  void upload(const LightProgram& program) override {
    black();
    if (port_ && loaded_ == program.id() && restarts()) return;
    loaded_.reset();
    if (!port_) open();
    try {
      handshake();
      const auto lines = serial::program_lines(program);
      for (const std::string& line : lines) {
        const std::string answer = command(line);
        if (line == lines.back() && answer != serial::checksum_of(lines))
          fail("has the checksum \"" + answer + "\" of the program, not " +
               serial::checksum_of(lines) +
               ": the line corrupts data; use a shorter cable or a lower baud rate");
      }
      go();
      loaded_ = program.id();
    } catch (...) {
      running_ = false;
      port_.reset();
      throw;
    }
  }

  void show(uint64_t trigger) override {
    if (!running_)
      throw Error(ErrorKind::internal, "lights are shown before a program is uploaded");
    receive();
    while (auto line = lines_.next()) fail_on(*line);
    if (settings_.pulses) write("pulse " + std::to_string(trigger) + "\n", kPulseTimeout);
  }

  void black() override {
    if (!running_) return;
    running_ = false;
    try {
      command("off\n");
    } catch (...) {
      port_.reset();
      throw;
    }
  }

  void cancel() override { cancelled_ = true; }

 private:
  [[noreturn]] void fail(const std::string& text) const {
    throw Error(ErrorKind::connection, "the light controller at " + settings_.port + " " + text);
  }
  [[noreturn]] void fail_disconnected() const {
    fail("has disconnected; check its cable and its power");
  }
  void check_cancelled() const {
    if (cancelled_) fail("was given up: stopped");
  }

  void go() {
    running_ = true;
    command(settings_.pulses ? "go pulses\n" : "go trigger\n");
  }
  /// Whether the controller starts the program that was uploaded before; it may have lost it if it
  /// was switched off.
  bool restarts() {
    try {
      go();
      return true;
    } catch (const Error&) {
      running_ = false;
      port_.reset();
      return false;
    }
  }

  void open() {
    Descriptor port(::open(settings_.port.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
    if (!port)
      throw Error(ErrorKind::connection, "cannot open the serial port " + settings_.port + ": " +
                                             strerror(errno) +
                                             "; name the tty of the light controller, which you "
                                             "may have to be allowed to use (group dialout)");
    termios options{};
    if (tcgetattr(port.get(), &options) != 0)
      throw Error(ErrorKind::connection, settings_.port + " is no serial port");
    if (flock(port.get(), LOCK_EX | LOCK_NB) != 0)
      throw Error(ErrorKind::connection,
                  "the serial port " + settings_.port + " is in use by another program; end that");
    cfmakeraw(&options);
    options.c_cflag |= CLOCAL | CREAD;
    options.c_cflag &= ~static_cast<tcflag_t>(CSTOPB | CRTSCTS);
    cfsetispeed(&options, speed_of(settings_.baud));
    cfsetospeed(&options, speed_of(settings_.baud));
    if (tcsetattr(port.get(), TCSANOW, &options) != 0)
      throw Error(ErrorKind::connection, "the serial port " + settings_.port + " does not run at " +
                                             std::to_string(settings_.baud) +
                                             " baud: " + strerror(errno));
    tcflush(port.get(), TCIOFLUSH);
    lines_ = {};
    port_ = std::move(port);
  }

  /// Sends `hello` until the controller answers the last one. Other replies are older and ignored.
  void handshake() {
    const auto end = after(settings_.timeout);
    std::string last_reply;
    while (Clock::now() < end) {
      write("hello " + std::to_string(++token_) + "\n", Seconds(settings_.timeout));
      const auto again = std::min(end, after(kHelloInterval));
      while (auto line = read_line(again)) {
        const serial::Reply reply = serial::parse_reply(*line);
        last_reply = *line;
        if (reply.kind != serial::Reply::Kind::hello || reply.token != token_) continue;
        if (reply.version != serial::kVersion)
          fail("has version " + std::to_string(reply.version) +
               " of the protocol, this program has version " + std::to_string(serial::kVersion) +
               "; update the older of the two");
        return;
      }
    }
    if (last_reply.empty())
      fail("does not answer; check its cable, its power and the baud rate (" +
           std::to_string(settings_.baud) + ")");
    fail("answers \"" + last_reply.substr(0, 40) +
         "\", which is not of this protocol; check the baud rate (" +
         std::to_string(settings_.baud) + ") and what is connected");
  }

  /// Sends a line; returns the text after `ok` in the reply.
  std::string command(const std::string& line) {
    const std::string name = line.substr(0, line.find_first_of(" \n"));
    write(line, Seconds(settings_.timeout));
    const auto answer = read_line(after(settings_.timeout));
    if (!answer) fail("does not answer \"" + name + "\"");
    const serial::Reply reply = serial::parse_reply(*answer);
    if (reply.kind != serial::Reply::Kind::ok) fail_on(*answer);
    return reply.text;
  }

  /// Throws for an error reply or an unexpected line.
  [[noreturn]] void fail_on(const std::string& line) const {
    const serial::Reply reply = serial::parse_reply(line);
    if (reply.kind == serial::Reply::Kind::error)
      fail("reports: " + (reply.text.empty() ? "error" : reply.text));
    fail("sends \"" + line.substr(0, 40) + "\", which is no reply; check the baud rate");
  }

  /// The next line; empty after a timeout.
  std::optional<std::string> read_line(Clock::time_point end) {
    while (true) {
      if (auto line = lines_.next()) return line;
      const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - Clock::now()).count();
      if (left <= 0) return std::nullopt;
      check_cancelled();
      wait(POLLIN, static_cast<int>(std::min<int64_t>(left, kPollInterval)));
      receive();
    }
  }

  /// Reads the bytes that have arrived; does not wait.
  void receive() {
    std::array<char, 1024> bytes;
    while (true) {
      const ssize_t size = read(port_.get(), bytes.data(), bytes.size());
      if (size > 0) {
        lines_.take(std::span(bytes).first(static_cast<size_t>(size)));
        if (static_cast<size_t>(size) < bytes.size()) return;
      } else if (size < 0 && errno == EINTR) {
        continue;
      } else if (size < 0 && errno == EAGAIN) {
        return;
      } else {
        fail_disconnected();
      }
    }
  }

  void write(std::string_view text, Seconds timeout) {
    const auto start = Clock::now();
    auto progress = start;
    while (!text.empty()) {
      const ssize_t size = ::write(port_.get(), text.data(), text.size());
      if (size > 0) {
        text.remove_prefix(static_cast<size_t>(size));
        progress = Clock::now();
      } else if (errno != EAGAIN && errno != EINTR) {
        fail_disconnected();
      } else {
        if (Clock::now() - progress > timeout) fail("accepts no more data; restart it");
        check_cancelled();
        wait(POLLOUT, static_cast<int>(std::min(1000 * timeout.count(), double{kPollInterval})));
      }
    }
  }

  void wait(short events, int milliseconds) const {
    pollfd wanted{port_.get(), events, 0};
    poll(&wanted, 1, milliseconds);
    // Bytes sent before the disconnection are read first.
    if ((wanted.revents & (POLLHUP | POLLERR)) && !(wanted.revents & POLLIN)) fail_disconnected();
  }

  LightDriverSettings::Serial settings_;
  Descriptor port_;
  serial::LineReader lines_;
  uint32_t token_ = 0;
  bool running_ = false;
  std::optional<uint64_t> loaded_;  // id of the program in the controller, while the port is open
  std::atomic<bool> cancelled_{false};
};

}  // namespace

std::unique_ptr<LightDriver> make_serial_driver(const LightDriverSettings::Serial& settings) {
  return std::make_unique<SerialDriver>(settings);
}

}  // namespace inverse
