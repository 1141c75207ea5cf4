// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>

namespace inverse {

/// Brackets in each other that JSON may have: readers of it recurse.
inline constexpr size_t kMaxJsonDepth = 100;
/// Values and names that JSON may have: each takes some 50 bytes of memory, however short.
inline constexpr size_t kMaxJsonValues = size_t{8} << 20;

/// What is wrong with JSON that lacks something, in words for who wrote it: "key 'x' not found".
/// `error` is of nlohmann::json.
std::string json_fault(const std::exception& error);

/// A number that is from 0 to 2^32 - 1, without its fraction; nothing for other numbers, of which
/// get() would make any. Throws nlohmann::json::exception if it is no number.
std::optional<uint32_t> json_count(const nlohmann::json& number);

/// Parses JSON from strangers, to nlohmann::json or ordered_json. If it is none, is nested deeper
/// than kMaxJsonDepth, has more than kMaxJsonValues values or one name twice in an object, of which
/// readers take either, the result is discarded and `fault` says why, as the end of a message that
/// starts with the file's name; `too_many` is that of more than kMaxJsonValues, or more
/// than `max_list` in one list.
template <typename Json>
Json parse_json(std::string_view text, std::string& fault, const std::string& too_many = {},
                size_t max_list = kMaxJsonValues);

}  // namespace inverse
