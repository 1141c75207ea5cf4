// SPDX-License-Identifier: LGPL-2.1-or-later
// How many frames may wait in lightstagesync.
#include <algorithm>
#include <cmath>

#include "sync_element.hpp"

namespace inverse {
namespace {

constexpr size_t kFew = 4;  // frames

/// Max number of frames of a camera that may wait, by their memory.
size_t fitting(const SyncCamera& camera) {
  constexpr size_t kMaxBytes = size_t{1} << 30;
  return kMaxBytes / std::max<size_t>(camera.frame_bytes, 1);
}

}  // namespace

/// Max number of frames that may wait for downstream. Sinks wait for the latency: a frame without
/// delay waits there as long as others wait here, and those behind it must not block the camera.
size_t SyncElement::max_outgoing(const SyncCamera& camera) const {
  const GstClockTime ours = camera.live ? own_latency() : 0;
  const uint64_t frames = labels_ ? std::max(ours, camera.sinks_wait) / labels_->period() : 0;
  return kFew + static_cast<size_t>(std::min<uint64_t>(frames, fitting(camera)));
}

/// Max number of frames of a camera that may wait for those of others: as many as come until others
/// are given up, and a few more, since threads are not punctual.
size_t SyncElement::max_in_sets(const SyncCamera& camera) const {
  if (params_.max_frames || !labels_) return std::max(params_.max_frames, 1u);
  const double timeout = 1e9 * params_.timeout / static_cast<double>(labels_->period());
  const size_t frames = static_cast<size_t>(std::ceil(timeout)) + kLongestWait + kFew;
  return std::clamp(frames, kFew, kFew + fitting(camera));
}

}  // namespace inverse
