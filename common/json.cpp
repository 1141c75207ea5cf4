// SPDX-License-Identifier: LGPL-2.1-or-later
#include "json.hpp"

#include <limits>
#include <nlohmann/json.hpp>
#include <unordered_set>
#include <vector>

namespace inverse {
namespace {

/// Checks JSON without storing it. `fault` says what is wrong.
template <typename Json>
class JsonCheck final : public nlohmann::json_sax<Json> {
 public:
  std::string fault;

  explicit JsonCheck(const std::string& too_many) : too_many_(too_many) {}
  bool null() override { return count(); }
  bool boolean(bool) override { return count(); }
  bool number_integer(typename Json::number_integer_t) override { return count(); }
  bool number_unsigned(typename Json::number_unsigned_t) override { return count(); }
  bool number_float(typename Json::number_float_t, const std::string&) override { return count(); }
  bool string(std::string&) override { return count(); }
  bool binary(typename Json::binary_t&) override { return count(); }
  bool start_array(size_t) override { return open(); }
  bool end_array() override { return close(); }
  bool start_object(size_t) override { return open(); }
  bool end_object() override { return close(); }
  bool key(std::string& name) override {
    if (!names_.back().insert(name).second)
      fault = "has the field \"" + name.substr(0, 40) + "\" twice";
    return fault.empty() && count();
  }
  bool parse_error(size_t position, const std::string&,
                   const nlohmann::detail::exception& error) override {
    // "[json...] parse error at line 1, column 2: ..."; numbers out of range have no line.
    const std::string what = error.what();
    const size_t from = what.find("line "), to = what.find(':', from);
    fault = "is not valid JSON at " + (from == std::string::npos
                                           ? "character " + std::to_string(position)
                                           : what.substr(from, to - from));
    return false;
  }

 private:
  bool count() {
    if (++values_ > kMaxJsonValues) fault = too_many_;
    return fault.empty();
  }
  bool open() {
    names_.emplace_back();
    if (names_.size() > kMaxJsonDepth)
      fault = "nests its JSON more than " + std::to_string(kMaxJsonDepth) + " deep";
    return fault.empty() && count();
  }
  bool close() {
    names_.pop_back();
    return true;
  }

  const std::string too_many_;
  size_t values_ = 0;
  std::vector<std::unordered_set<std::string>> names_;  // in each open bracket
};

}  // namespace

std::string json_fault(const std::exception& error) {
  const std::string what = error.what();  // "[json...] ..."
  const size_t from = what.find("] ");
  return from == std::string::npos ? what : what.substr(from + 2);
}

std::optional<uint32_t> json_count(const nlohmann::json& number) {
  const auto value = number.get<double>();
  if (!(value >= 0 && value <= std::numeric_limits<uint32_t>::max())) return {};
  return static_cast<uint32_t>(value);
}

template <typename Json>
Json parse_json(std::string_view text, std::string& fault, const std::string& too_many) {
  JsonCheck<Json> check(too_many.empty() ? "has more than " + std::to_string(kMaxJsonValues) +
                                               " values in its JSON"
                                         : too_many);
  const bool good = Json::sax_parse(text, &check);
  fault = check.fault;
  return good ? Json::parse(text) : Json(nlohmann::json::value_t::discarded);
}

template nlohmann::json parse_json(std::string_view, std::string&, const std::string&);
template nlohmann::ordered_json parse_json(std::string_view, std::string&, const std::string&);

}  // namespace inverse
