#pragma once
#include <cstdint>
#include <mutex>
#include <utility>
#include <vector>

namespace inverse {

/// What users ask globalintrinsicthesis for, from any thread, until the next frame takes it.
class RegionRequests {
 public:
  struct Click {
    enum class What : uint8_t {
      frame,    ///< marks a pixel of the frame
      picture,  ///< of what is shown
      unmark,   ///< takes `region` back
    };
    int x, y, region;
    What what;
  };
  struct Taken {
    std::vector<Click> clicks;  ///< in the order that they came in
    bool refine;
  };

  void add(const Click& click) {
    std::lock_guard lock(mutex_);
    // What nobody looks at for so long is no click on a picture any more.
    if (waiting_.clicks.size() < kMostClicks) waiting_.clicks.push_back(click);
  }
  void refine() {
    std::lock_guard lock(mutex_);
    waiting_.refine = true;
  }
  Taken take() {
    std::lock_guard lock(mutex_);
    return std::exchange(waiting_, Taken{});
  }
  void forget_clicks() {
    std::lock_guard lock(mutex_);
    waiting_.clicks.clear();
  }
  bool empty() const {
    std::lock_guard lock(mutex_);
    return waiting_.clicks.empty() && !waiting_.refine;
  }

 private:
  static constexpr size_t kMostClicks = 1000;
  mutable std::mutex mutex_;
  Taken waiting_{};
};

}  // namespace inverse
