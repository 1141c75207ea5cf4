#pragma once
#include <cstdint>
#include <optional>

namespace inverse {

/// Notices frames that show the very picture of the frame before: paused players, slides, screens
/// on which nothing happens, video whose rate was raised by sending frames twice.
class Repeats {
 public:
  /// Takes note of the next frame; nothing where its fingerprint is not known. Returns whether it
  /// repeats the frame before.
  bool next(std::optional<uint64_t> fingerprint) {
    const bool repeated = fingerprint && fingerprint == last_;
    last_ = fingerprint;
    since_ = repeated ? 0 : since_ + (since_ < kMemory);
    return repeated;
  }
  /// Whether one of the last `kMemory` frames was a repeat: whoever holds on to a frame's planes,
  /// so that editors cannot work in place, does so only while it is likely to be of use.
  bool going_on() const { return since_ < kMemory; }
  /// The next frame has no frame before.
  void reset() { *this = {}; }
  static constexpr unsigned kMemory = 16;

 private:
  std::optional<uint64_t> last_;
  unsigned since_ = kMemory;  // frames since the last repeat
};

}  // namespace inverse
