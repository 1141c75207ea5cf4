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

  JsonCheck(const std::string& too_many, size_t max_list)
      : too_many_(too_many), max_list_(max_list) {}
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
    if (!open_.back().names.insert(name).second)
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
    const bool full = !open_.empty() && ++open_.back().values > max_list_;
    if (full || ++values_ > kMaxJsonValues) fault = too_many_;
    return fault.empty();
  }
  bool open() {
    if (!count()) return false;
    open_.emplace_back();
    if (open_.size() > kMaxJsonDepth)
      fault = "nests its JSON more than " + std::to_string(kMaxJsonDepth) + " deep";
    return fault.empty();
  }
  bool close() {
    open_.pop_back();
    return true;
  }

  struct Bracket {
    std::unordered_set<std::string> names;
    size_t values = 0;
  };

  const std::string too_many_;
  const size_t max_list_;
  size_t values_ = 0;
  std::vector<Bracket> open_;
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
Json parse_json(std::string_view text, std::string& fault, const std::string& too_many,
                size_t max_list) {
  JsonCheck<Json> check(
      too_many.empty() ? "has more than " + std::to_string(kMaxJsonValues) + " values in its JSON"
                       : too_many,
      max_list);
  const bool good = Json::sax_parse(text, &check);
  fault = check.fault;
  return good ? Json::parse(text) : Json(nlohmann::json::value_t::discarded);
}

template nlohmann::json parse_json(std::string_view, std::string&, const std::string&, size_t);
template nlohmann::ordered_json parse_json(std::string_view, std::string&, const std::string&,
                                           size_t);

}  // namespace inverse
