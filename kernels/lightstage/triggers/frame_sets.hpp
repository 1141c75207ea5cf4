// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

namespace inverse {

/// Groups frames of the same trigger from several cameras. A set is decided once every camera that
/// is waited for has sent its frame or one of a later trigger. Sets are output in order.
class FrameSets {
 public:
  /// A frame whose set is decided.
  struct Decided {
    uint32_t camera;
    uint64_t token;  ///< of `add`
    bool out;        ///< output it; false: drop it with its incomplete set
  };
  /// `complete`: drop incomplete sets.
  explicit FrameSets(bool complete) : complete_(complete) {}

  void add_camera(uint32_t camera) { cameras_[camera] = {}; }
  /// Removes a camera and its frames. Later frames of it are ignored.
  void remove_camera(uint32_t camera);
  void forget_frames(uint32_t camera);
  /// Adds a frame; the keys of a camera increase. `token` is chosen by the caller.
  void add(uint32_t camera, uint64_t key, uint64_t token);
  /// Whether sets wait for a camera. If not, its frames still join their sets.
  void wait_for(uint32_t camera, bool wait);
  /// Cameras for which the oldest set waits; empty if there is no set.
  std::vector<uint32_t> lacking() const;
  /// Removes and returns the frames of all decided sets.
  std::vector<Decided> decide();

  uint64_t complete_sets() const { return complete_sets_; }
  uint64_t incomplete_sets() const { return incomplete_sets_; }

 private:
  struct Camera {
    std::optional<uint64_t> latest;
    bool waited_for = true;
  };
  bool complete_;
  std::map<uint32_t, Camera> cameras_;
  std::map<uint64_t, std::map<uint32_t, uint64_t>> sets_;  // tokens by key and camera
  uint64_t complete_sets_ = 0, incomplete_sets_ = 0;
};

}  // namespace inverse
