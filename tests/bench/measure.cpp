#include <sys/resource.h>

#include <chrono>
#include <cstdio>

#include "tests/bench/method.hpp"

namespace inverse::bench {
namespace {

double processor_time() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto milliseconds = [](const timeval& t) {
    return double(t.tv_sec) * 1e3 + double(t.tv_usec) * 1e-3;
  };
  return milliseconds(usage.ru_utime) + milliseconds(usage.ru_stime);
}

}  // namespace

Cost measure(const std::function<void()>& work) {
  using Clock = std::chrono::steady_clock;
  Cost cost;
  const double before = processor_time();
  const auto start = Clock::now();
  work();
  cost.wall = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  cost.processor = processor_time() - before;
  return cost;
}

std::string text_of(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%g", value);
  return buffer;
}

}  // namespace inverse::bench
