// SPDX-License-Identifier: LGPL-2.1-or-later
// Work in the background: its result, its errors, and nobody who waits for it.
#include "common/background.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <stdexcept>

namespace inverse {

TEST(Background, GivesResultsAndErrors) {
  EXPECT_EQ(in_background([] { return 7; }).get(), 7);
  EXPECT_THROW(in_background([]() -> int { throw std::runtime_error("no file"); }).get(),
               std::runtime_error);
}

TEST(Background, IsNotWaitedForWhenItsResultIsDropped) {
  auto go_on = std::make_shared<std::promise<void>>();
  auto done = std::make_shared<std::promise<void>>();
  auto ended = done->get_future();
  {
    const auto dropped = in_background([go_on, done, wait = go_on->get_future().share()] {
      wait.get();
      done->set_value();
    });
  }  // would hang here
  go_on->set_value();
  EXPECT_EQ(ended.wait_for(std::chrono::seconds(60)), std::future_status::ready);
}

}  // namespace inverse
