// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "kernels/thesis/chapter5/global_thesis.hpp"
#include "kernels/thesis/chapter5/regions/marked_regions.hpp"
#include "kernels/thesis_chapter5_correction_survey.spv.hpp"
#include "misclustering_survey.hpp"

namespace inverse {

/// Proposes regions of a video that look like another base color than they have, without a click
/// (find_misclustered), and marks them where that is wanted. In the background of a live stream:
/// every few frames the device makes a small one, and the host looks at it once the device is done
/// with the frame.
class RegionProposals {
 public:
  enum class Mode : uint8_t {
    off,
    report,   ///< only reports
    correct,  ///< marks the regions as a click would and gives them the color that they seem to
              ///< have
  };
  struct Proposal {
    int x, y;         ///< of a pixel of the frame in it
    uint64_t pixels;  ///< of the frame, about
    int cluster;      ///< slot that they were taken for
    int color;        ///< slot that they seem to have
    float score;      ///< how much speaks for it, 0…1
    int region;       ///< number of the region that was marked, 0: none
  };

  /// Of `most` proposals at a time is kept in mind that they were made; there are no others until
  /// some are over. Throws Error(limit, out_of_memory).
  RegionProposals(const std::shared_ptr<gpu::Device>& device, Extent extent, size_t most = 256);

  /// After `method` has recorded a frame with `regions`: records a small one where one is due.
  /// Returns a number for `collect`. With the first frame that is not in Mode::correct any more the
  /// regions that were proposed go (Loss::withdrawn), from the next one on; what frames before it
  /// may still report is ignored.
  uint64_t record(gpu::Commands& commands, const GlobalThesis& method, MarkedRegions& regions,
                  Mode mode);
  /// Reads the results of one of the last three frames, once its Commands have been waited for.
  /// Gives what is proposed anew. In Mode::correct regions are marked where numbers are free, and
  /// those that have not looked misclustered for a while go again.
  std::vector<Proposal> collect(uint64_t number, MarkedRegions& regions);

  /// Proposes this region no more until `reset`, as somebody has taken its mark away.
  void refuse(int region);
  /// Forgets everything: at a flush, a discontinuity or a scene cut.
  void reset();
  /// Whether frames in this mode may still bring something new while the picture stays as it is.
  bool pending(Mode mode) const { return !quiet_ || mode != mode_; }
  /// What is proposed at present.
  int count() const;

 private:
  static constexpr uint64_t kMaxPixels = 160 * 160;  ///< of a small frame
  static constexpr uint64_t kSoon = 4, kLater = 15;  ///< frames from one to the next
  static constexpr int kMisses = 3;                  ///< after which a proposal is over
  static constexpr int kMaxFailures = 2;             ///< after which it is refused
  struct Frame {
    gpu::BufferPtr pixels;
    std::vector<BaseColors::Color> colors;
    std::array<int, MarkedRegions::kMaxRegions + 1> given{};
    Mode mode = Mode::off;
    uint32_t epoch = 0;
    bool pending = false;
  };
  /// A proposal of before.
  struct Seen {
    int x, y;  ///< of the small frame
    int region;
    int misses;
    bool refused;
    int failures = 0;  ///< regions that were lost
  };

  void change(Mode mode, MarkedRegions& regions);
  void forget_lost(const MarkedRegions& regions);

  std::shared_ptr<gpu::Device> device_;
  Extent extent_, small_;
  size_t most_;
  int factor_ = 1;
  gpu::Program<shaders::thesis_chapter5_correction_survey> survey_;
  gpu::BufferPtr pixels_;
  gpu::FrameRing<Frame> frames_;
  std::vector<Seen> seen_;
  uint64_t recorded_ = 0, due_ = 0;
  uint32_t epoch_ = 0;     // resets
  Mode mode_ = Mode::off;  // of the frame before
  bool quiet_ = false;
};

}  // namespace inverse
