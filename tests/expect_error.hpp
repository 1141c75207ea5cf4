// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gtest/gtest.h>

#include <concepts>
#include <optional>
#include <string>
#include <vector>

#include "common/error.hpp"

namespace inverse::testing {

/// The text of the Error that `call` throws; empty without one. If `kind` is given, the Error must
/// be of it.
template <std::invocable Call>
std::string error_of(Call call, std::optional<ErrorKind> kind = {}) {
  try {
    call();
  } catch (const Error& error) {
    if (kind) {
      EXPECT_EQ(error.kind(), *kind) << error.what();
    }
    return error.what();
  }
  return "";
}

inline void expect_contains(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << '"' << text << "\" lacks \"" << part << '"';
}

/// Expects one text, which contains each part.
template <typename... Parts>
void expect_one(const std::vector<std::string>& texts, const Parts&... parts) {
  ASSERT_EQ(texts.size(), 1U) << ::testing::PrintToString(texts) << " for "
                              << ::testing::PrintToString(std::vector<std::string>{parts...});
  (expect_contains(texts[0], parts), ...);
}

/// Expects that `call` throws an Error of this kind whose text contains `part`. Returns the text.
template <std::invocable Call>
std::string expect_error(ErrorKind kind, const std::string& part, Call call) {
  std::string text = error_of(call, kind);
  EXPECT_NE(text, "") << "no error";
  expect_contains(text, part);
  return text;
}

}  // namespace inverse::testing
