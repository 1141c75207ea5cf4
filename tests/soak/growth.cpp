// SPDX-License-Identifier: LGPL-2.1-or-later
#include "growth.hpp"

#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <thread>

namespace inverse::soak {
namespace {

constexpr double kMib = 1024 * 1024;

double entries(const char* folder) {
  const std::filesystem::directory_iterator files(folder);
  return static_cast<double>(std::distance(begin(files), end(files)));
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<ptrdiff_t>((values.size() - 1) / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

Holding holding_now(uint64_t device_bytes) {
  malloc_trim(0);
  Holding holding;
  double total = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> total >> resident;
  holding.resident_mib = resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / kMib;
  holding.device_mib = static_cast<double>(device_bytes) / kMib;
  holding.descriptors = entries("/proc/self/fd");
  holding.threads = entries("/proc/self/task");
  return holding;
}

void Growth::sample_now(uint64_t device_bytes, std::chrono::milliseconds timeout) {
  const auto smallest_count = [&](double Holding::*field) {
    double smallest = std::numeric_limits<double>::max();
    for (const Holding& sample : samples_) smallest = std::min(smallest, sample.*field);
    return smallest;
  };
  const double threads = smallest_count(&Holding::threads),
               descriptors = smallest_count(&Holding::descriptors);
  const auto end = std::chrono::steady_clock::now() + timeout;
  Holding now = holding_now(device_bytes);
  while ((now.threads > threads || now.descriptors > descriptors) &&
         std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    now = holding_now(device_bytes);
  }
  sample(now);
}

bool Growth::judge() const {
  const size_t warm_up = samples_.size() / 5;
  const size_t rest = samples_.size() - warm_up;
  if (rest < 3) {
    printf("%-12s only %zu samples: nothing to judge by  FAILED\n", phase_.c_str(),
           samples_.size());
    return false;
  }
  const size_t third = rest / 3;
  bool good = true;
  const auto line = [&](const char* what, double Holding::*field, double slack) {
    const auto of = [&](size_t first) {
      std::vector<double> values;
      for (size_t i = first; i < first + third; ++i) values.push_back(samples_[i].*field);
      return median(values);
    };
    const double before = of(warm_up), after = of(samples_.size() - third);
    const bool fits = after - before <= slack;
    good = good && fits;
    fprintf(fits ? stdout : stderr, "%-12s %-20s %10.2f %10.2f %+10.2f %8.2f  %s\n", phase_.c_str(),
            what, before, after, after - before, slack, fits ? "ok" : "GREW");
  };
  line("resident MiB", &Holding::resident_mib, slack_.resident_mib);
  line("device MiB", &Holding::device_mib, slack_.device_mib);
  line("open files", &Holding::descriptors, slack_.descriptors);
  line("threads", &Holding::threads, slack_.threads);
  return good;
}

}  // namespace inverse::soak
