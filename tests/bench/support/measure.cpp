// SPDX-License-Identifier: LGPL-2.1-or-later
#include <algorithm>
#include <atomic>
#include <cstdio>
#include <exception>
#include <mutex>
#include <thread>

#include "method.hpp"
#include "timing.hpp"

namespace inverse::bench {

Cost measure(const std::function<void()>& work) {
  Cost cost;
  const double before = processor_ms();
  const auto start = Clock::now();
  work();
  cost.wall = milliseconds(Clock::now() - start);
  cost.processor = processor_ms() - before;
  return cost;
}

void in_parallel(std::size_t count, const std::function<void(std::size_t)>& work) {
  std::atomic<std::size_t> next{0};
  std::exception_ptr failure;
  std::mutex mutex;
  const auto run = [&] {
    for (std::size_t k; (k = next++) < count;) try {
        work(k);
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (!failure) failure = std::current_exception();
      }
  };
  std::vector<std::thread> threads;
  for (std::size_t k = 1; k < std::min<std::size_t>(count, std::thread::hardware_concurrency());
       ++k)
    threads.emplace_back(run);
  run();
  for (std::thread& thread : threads) thread.join();
  if (failure) std::rethrow_exception(failure);
}

std::string text_of(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%g", value);
  return buffer;
}

}  // namespace inverse::bench
