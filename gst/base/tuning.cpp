// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tuning.hpp"

#include <algorithm>
#include <sstream>

#include "common/error.hpp"

namespace inverse {
namespace {

template <typename Spec>
std::string range(const Spec* spec) {
  std::ostringstream text;
  text.precision(7);
  text << spec->minimum << "…" << spec->maximum << " (" << spec->default_value << ")";
  return text.str();
}

std::string without_spaces_around(const std::string& text) {
  constexpr const char* kSpaces = " \t\n";
  const size_t first = text.find_first_not_of(kSpaces);
  return first == std::string::npos
             ? ""
             : text.substr(first, text.find_last_not_of(kSpaces) + 1 - first);
}

}  // namespace

std::string values_of(GParamSpec* spec) {
  if (G_IS_PARAM_SPEC_FLOAT(spec)) return range(G_PARAM_SPEC_FLOAT(spec));
  if (G_IS_PARAM_SPEC_DOUBLE(spec)) return range(G_PARAM_SPEC_DOUBLE(spec));
  if (G_IS_PARAM_SPEC_INT(spec)) return range(G_PARAM_SPEC_INT(spec));
  if (G_IS_PARAM_SPEC_UINT(spec)) return range(G_PARAM_SPEC_UINT(spec));
  if (G_IS_PARAM_SPEC_BOOLEAN(spec))
    return G_PARAM_SPEC_BOOLEAN(spec)->default_value ? "boolean (true)" : "boolean (false)";
  if (G_IS_PARAM_SPEC_ENUM(spec)) {
    const auto* s = G_PARAM_SPEC_ENUM(spec);
    std::string values;
    for (guint i = 0; i < s->enum_class->n_values; ++i)
      values += (i ? ", " : "") + std::string(s->enum_class->values[i].value_nick);
    return values + " (" + g_enum_get_value(s->enum_class, s->default_value)->value_nick + ")";
  }
  return "text";
}

std::vector<std::pair<std::string, std::string>> tuning_entries(const std::string& text) {
  std::vector<std::pair<std::string, std::string>> entries;
  for (size_t from = 0; from <= text.size();) {
    const size_t to = std::min(text.find_first_of(":,", from), text.size());
    const std::string entry = without_spaces_around(text.substr(from, to - from));
    from = to + 1;
    if (entry.empty()) continue;
    const size_t equals = entry.find('=');
    if (equals == std::string::npos)
      throw Error(ErrorKind::unsupported,
                  "\"" + entry.substr(0, 40) + "\" has no value; write name=value:name=value");
    entries.emplace_back(without_spaces_around(entry.substr(0, equals)),
                         without_spaces_around(entry.substr(equals + 1)));
  }
  return entries;
}

void tuning_value(GParamSpec* spec, const std::string& text, GValue* value) {
  g_value_init(value, G_PARAM_SPEC_VALUE_TYPE(spec));
  // Validation changes a value that is out of range, also NaN.
  if (gst_value_deserialize(value, text.c_str()) && !g_param_value_validate(spec, value)) return;
  g_value_unset(value);
  throw Error(ErrorKind::unsupported, std::string(spec->name) + " takes " + values_of(spec) +
                                          ", not \"" + text.substr(0, 40) + "\"");
}

}  // namespace inverse
