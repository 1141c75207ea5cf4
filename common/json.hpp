// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

namespace inverse {

/// Brackets in each other that JSON may have: readers of it recurse.
inline constexpr int kMaxJsonDepth = 100;
/// Values and names that JSON may have: each takes some 50 bytes of memory, however short.
inline constexpr size_t kMaxJsonValues = size_t{8} << 20;

/// Parses JSON from strangers. If it is none, is nested deeper than kMaxJsonDepth, has more than
/// kMaxJsonValues values or one name twice in an object, of which readers take either, the result
/// is discarded and `fault` says why, as the end of a message that starts with the file's name.
template <typename Json>
Json parse_json(std::string_view text, std::string& fault) {
  struct Refused {
    std::string why;
  };
  fault.clear();
  size_t values = 0;
  std::vector<std::unordered_set<std::string>> names;  // of the objects that are open
  const auto check = [&](int depth, typename Json::parse_event_t event, Json& parsed) {
    using Event = typename Json::parse_event_t;
    if ((event == Event::object_start || event == Event::array_start) && depth >= kMaxJsonDepth)
      throw Refused{"nests its JSON more than " + std::to_string(kMaxJsonDepth) + " deep"};
    if (event != Event::object_end && event != Event::array_end && ++values > kMaxJsonValues)
      throw Refused{"has more than " + std::to_string(kMaxJsonValues) + " values in its JSON"};
    if (event == Event::object_start) names.emplace_back();
    if (event == Event::object_end) names.pop_back();
    if (event == Event::key &&
        !names.back().insert(parsed.template get_ref<const std::string&>()).second)
      throw Refused{"has the field \"" +
                    parsed.template get_ref<const std::string&>().substr(0, 40) + "\" twice"};
    return true;
  };
  try {
    return Json::parse(text, check);
  } catch (const Refused& refused) {
    fault = refused.why;
  } catch (const nlohmann::json::exception& error) {
    fault = std::string("is not JSON: ") + error.what();
  }
  return Json(nlohmann::json::value_t::discarded);
}

}  // namespace inverse
