// SPDX-License-Identifier: LGPL-2.1-or-later
// A light controller at the other end of a pseudo-terminal.
#pragma once
#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <stdlib.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <map>
#include <mutex>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "kernels/lightstage/controllers/descriptor.hpp"

namespace inverse::testing {

inline bool has_pseudo_terminals() {
  return static_cast<bool>(Descriptor(posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC)));
}

/// The other end of the line: a thread that reads lines and replies with `answer`.
class Controller {
 public:
  using Answer = std::function<std::string(const std::string& line)>;
  explicit Controller(Answer answer) : answer_(std::move(answer)) {
    master_ = Descriptor(posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
    EXPECT_EQ(grantpt(master_.get()), 0);
    EXPECT_EQ(unlockpt(master_.get()), 0);
    path_ = ptsname(master_.get());
    // Held open, so that the master does not see a hang-up before the driver comes.
    slave_ = Descriptor(open(path_.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC));
    thread_ = std::thread([this] { run(); });
  }
  ~Controller() {
    stop_ = true;
    thread_.join();
  }
  const std::string& path() const { return path_; }
  /// Disconnects.
  void hang_up() {
    stop_ = true;
    thread_.join();
    thread_ = std::thread([] {});
    slave_.reset();
    master_.reset();
  }
  void say(const std::string& text) {
    std::lock_guard lock(mutex_);
    (void)!write(master_.get(), text.data(), text.size());
  }
  /// Number of lines that began with this word.
  int count(const std::string& word) {
    std::lock_guard lock(mutex_);
    return static_cast<int>(std::ranges::count_if(
        lines_, [&](const std::string& line) { return line.starts_with(word); }));
  }
  /// Waits for this many lines and returns all received ones.
  std::vector<std::string> lines(size_t count) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, std::chrono::seconds(10), [&] { return lines_.size() >= count; });
    return lines_;
  }

 private:
  void run() {
    std::string partial;
    while (!stop_) {
      pollfd wanted{master_.get(), POLLIN, 0};
      poll(&wanted, 1, 20);
      std::array<char, 256> bytes;
      const ssize_t size = read(master_.get(), bytes.data(), bytes.size());
      for (ssize_t i = 0; i < size; ++i) {
        if (bytes[static_cast<size_t>(i)] != '\n') {
          partial += bytes[static_cast<size_t>(i)];
          continue;
        }
        const std::string reply = answer(partial);
        {
          std::lock_guard lock(mutex_);
          lines_.push_back(partial);
          changed_.notify_all();
        }
        partial.clear();
        if (!reply.empty()) say(reply);
      }
    }
  }

  /// One at a time: controllers of a test may share a rig.
  std::string answer(const std::string& line) {
    static std::mutex answering;
    std::lock_guard lock(answering);
    return answer_(line);
  }

  Answer answer_;
  Descriptor master_, slave_;
  std::string path_;
  std::atomic<bool> stop_{false};
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<std::string> lines_;
  std::thread thread_;
};

/// A controller written from docs/reference/light-stage-serial.md alone: stores a program and
/// tracks the state of its lights.
class Rig {
 public:
  std::string operator()(const std::string& line) {
    std::istringstream words(line);
    std::string verb;
    words >> verb;
    if (verb == "hello") {
      std::string token;
      words >> token;
      return "hello " + token + " 1 a rig\n";
    }
    if (verb == "begin") {
      std::string id;
      words >> id >> count_ >> intro_ >> loop_ >> repeat_;
      steps_.clear();
      bytes_.clear();
    }
    if (verb == "begin" || verb == "set") bytes_ += line + "\n";
    if (verb == "set") set(words);
    if (verb == "end") {
      std::string sum;
      words >> sum;
      char own[9];
      snprintf(own, sizeof own, "%08x", crc());
      return sum == own ? "ok " + sum + "\n" : "error checksum\n";
    }
    if (verb == "pulse") {
      uint64_t n = 0;
      words >> n;
      const uint64_t pass = n < intro_ ? 0 : (n - intro_) / loop_;
      const uint64_t step = n < intro_ ? n : intro_ + (n - intro_) % loop_;
      std::lock_guard lock(mutex_);
      now_ = repeat_ && pass >= repeat_ ? Lights(count_) : steps_[step];
      ++pulses_;
      return "";
    }
    if (verb == "off" || verb == "go") {
      std::lock_guard lock(mutex_);
      now_ = Lights(count_);
    }
    return "ok\r\n";
  }

  using Lights = std::vector<std::array<int, 3>>;
  Lights after(uint64_t pulses) {
    for (int i = 0; i < 1000; ++i) {
      {
        std::lock_guard lock(mutex_);
        if (pulses_ >= pulses) return now_;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return {};
  }

 private:
  void set(std::istringstream& words) {
    uint64_t step = 0;
    std::string how, hex;
    words >> step >> how;
    Lights& lights = steps_[step];
    lights.assign(count_, {});
    if (how == "one") {
      size_t light = 0;
      words >> light >> hex;
      lights[light] = color(hex, 0);
    } else if (how == "all") {
      words >> hex;
      lights.assign(count_, color(hex, 0));
    } else if (how == "each") {
      words >> hex;
      for (size_t i = 0; i < count_; ++i) lights[i] = color(hex, 12 * i);
    }
  }
  static std::array<int, 3> color(const std::string& hex, size_t at) {
    std::array<int, 3> result{};
    for (size_t c = 0; c < 3; ++c) result[c] = std::stoi(hex.substr(at + 4 * c, 4), nullptr, 16);
    return result;
  }
  /// The polynomial division, bit by bit with the message's bits reversed.
  uint32_t crc() const {
    uint32_t rest = 0xffffffff;
    for (const char c : bytes_)
      for (int bit = 0; bit < 8; ++bit) {
        const uint32_t top = (rest >> 31) ^ ((static_cast<uint8_t>(c) >> bit) & 1U);
        rest = (rest << 1) ^ (top ? 0x04c11db7U : 0);
      }
    uint32_t reversed = 0;
    for (int i = 0; i < 32; ++i) reversed |= ((~rest >> i) & 1U) << (31 - i);
    return reversed;
  }

  size_t count_ = 0;
  uint64_t intro_ = 0, loop_ = 0, repeat_ = 0, pulses_ = 0;
  std::map<uint64_t, Lights> steps_;
  std::string bytes_;
  Lights now_;
  std::mutex mutex_;
};

/// A rig at the other end of a pseudo-terminal.
class ConnectedRig : public Rig, public Controller {
 public:
  ConnectedRig() : Controller([this](const std::string& line) { return (*this)(line); }) {}
};

}  // namespace inverse::testing
