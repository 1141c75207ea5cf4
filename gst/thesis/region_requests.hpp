// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstdint>
#include <cstdio>
#include <mutex>
#include <optional>
#include <string>
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
    // A click that waits this long refers to an old picture: drop it.
    if (waiting_.clicks.size() < kMaxClicks) waiting_.clicks.push_back(click);
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
  static constexpr size_t kMaxClicks = 1000;
  mutable std::mutex mutex_;
  Taken waiting_{};
};

/// Positions written as x,y and apart by spaces, as in "120,80 31,200"; nothing if it is
/// something else.
inline std::optional<std::vector<std::pair<int, int>>> positions_of(const std::string& text) {
  std::vector<std::pair<int, int>> positions;
  const char* at = text.c_str();
  for (int x, y, read = 0; sscanf(at, " %d,%d%n", &x, &y, &read) == 2; at += read)
    positions.emplace_back(x, y);
  if (text.find_first_not_of(' ', static_cast<size_t>(at - text.c_str())) != std::string::npos)
    return {};
  return positions;
}

}  // namespace inverse
