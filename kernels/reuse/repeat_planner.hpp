// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstdint>
#include <optional>

namespace inverse {

/// Decides for each frame of a decomposer whether it reuses all layers of the frame before, because
/// its picture is repeated. Needs no device.
class RepeatPlanner {
 public:
  struct Frame {
    uint64_t number = 0;            ///< from 0, one more each time
    bool adaptive = true;           ///< the property
    bool repeated = false;          ///< the picture is that of the frame before
    bool params_changed = false;    ///< the method's
    bool layers_available = false;  ///< those of the frame before
    bool converged = false;         ///< another run would change nothing, by what `completed` found
  };
  struct Decision {
    bool reuse = false;
    const char* reason = "";  ///< for the log and `stats`
  };

  /// The last frame that is sure to be done when frame `number` is planned, if it shows the same
  /// picture with the same parameters as the frame before `number`. It is found by number, not by
  /// time, so that the same video always gets the same decisions.
  std::optional<uint64_t> completed(uint64_t number) const;
  Decision next(const Frame& frame);
  /// Forgets the frames so far.
  void reset() { *this = {}; }

  /// Times in a row that a video may show each of its pictures: such a repeat reuses layers before
  /// they have converged.
  static constexpr uint64_t kMaxRepeats = 4;

 private:
  std::optional<uint64_t> first_;          // frame of this picture with these parameters
  uint64_t shown_ = 0, shown_before_ = 0;  // frames of this picture, and of the one before
};

}  // namespace inverse
