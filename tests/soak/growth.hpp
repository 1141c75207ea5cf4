#pragma once
#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

namespace inverse::soak {

/// What a process holds at one moment.
struct Holding {
  double resident_mib = 0;  ///< resident memory, free heap returned first
  double device_mib = 0;    ///< memory allocated on the Vulkan device
  double descriptors = 0;   ///< open files
  double threads = 0;
};

/// This process now. `device_bytes` is what an element's stats say.
Holding holding_now(uint64_t device_bytes);

/// How much a process may hold at the end beyond what it held after the warm-up.
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
  /// Samples this process once it has settled: a thread that is ending is gone soon, a leaked one
  /// is not. Waits, as long as `patience` lasts, for as few threads and files as ever in this
  /// phase.
  void sample_now(uint64_t device_bytes,
                  std::chrono::milliseconds patience = std::chrono::seconds(1));
  size_t samples() const { return samples_.size(); }
  const Holding& last() const { return samples_.back(); }
  /// Prints the phase's lines of the table; false where something grew beyond its slack.
  bool judge() const;

 private:
  std::string phase_;
  Slack slack_;
  std::vector<Holding> samples_;
};

}  // namespace inverse::soak
