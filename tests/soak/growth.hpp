// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

namespace inverse::soak {

/// Resources of a process.
struct Holding {
  double resident_mib = 0;  ///< resident memory, free heap returned first
  double device_mib = 0;    ///< memory allocated on the Vulkan device
  double descriptors = 0;   ///< open files
  double threads = 0;
};

/// Resources of this process. `device_bytes` is from an element's stats.
Holding holding_now(uint64_t device_bytes);

/// Allowed growth between the warm-up and the end.
struct Slack {
  double resident_mib = 4;
  double device_mib = 0;
  double descriptors = 0;
  double threads = 0;
};

/// Growth of one phase: the first fifth of the samples is warm-up; of the rest, the (lower) median
/// of the first third is compared with that of the last.
class Growth {
 public:
  Growth(std::string phase, const Slack& slack) : phase_(std::move(phase)), slack_(slack) {}
  void sample(const Holding& holding) { samples_.push_back(holding); }
  /// Samples this process once it is stable: an ending thread disappears soon, a leaked one does
  /// not. Waits up to `timeout` for the minimum number of threads and files of this phase.
  void sample_now(uint64_t device_bytes,
                  std::chrono::milliseconds timeout = std::chrono::seconds(1));
  size_t samples() const { return samples_.size(); }
  const Holding& last() const { return samples_.back(); }
  /// Prints the phase's lines of the table; false if a resource grew beyond its limit.
  bool judge() const;

 private:
  std::string phase_;
  Slack slack_;
  std::vector<Holding> samples_;
};

}  // namespace inverse::soak
