// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <future>
#include <thread>
#include <utility>

namespace inverse {

/// Runs work in a thread of its own. The future that is returned does not wait for it when it is
/// dropped, as that of std::async does: a file on a network may take minutes. So the work has to
/// own all that it uses.
template <typename Work>
auto in_background(Work work) {
  std::packaged_task<decltype(work())()> task(std::move(work));
  auto result = task.get_future();
  std::thread(std::move(task)).detach();
  return result;
}

}  // namespace inverse
