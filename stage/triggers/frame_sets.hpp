#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

namespace inverse {

/// Frames of the same trigger from several cameras. A set is decided once each camera has sent its
/// frame, or one of a later trigger, or is not waited for any more; sets leave in their order.
class FrameSets {
 public:
  /// A frame whose set is decided.
  struct Decided {
    uint32_t camera;
    uint64_t token;  ///< the caller's name for the frame
    bool out;        ///< it leaves; else it belongs to an incomplete set
  };
  /// `complete`: incomplete sets do not leave.
  explicit FrameSets(bool complete) : complete_(complete) {}

  void add_camera(uint32_t camera) { cameras_[camera] = {}; }
  /// Its frames are forgotten. What comes of a camera that is not there is left out.
  void remove_camera(uint32_t camera);
  void forget_frames(uint32_t camera);
  /// A frame; those of a camera come in rising order of `key`.
  void add(uint32_t camera, uint64_t key, uint64_t token);
  /// Whether sets wait for a camera. Frames of one that is not waited for still join.
  void wait_for(uint32_t camera, bool wait);
  /// Cameras that the oldest set lacks and waits for; none where there is no set.
  std::vector<uint32_t> lacking() const;
  /// The sets that are decided.
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
