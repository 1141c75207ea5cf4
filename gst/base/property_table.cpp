// SPDX-License-Identifier: LGPL-2.1-or-later
#include "property_table.hpp"

#include <deque>
#include <sstream>

namespace inverse {

GType enum_type(const char* type_name, const std::vector<Choice>& choices) {
  static std::mutex mutex;
  std::lock_guard lock(mutex);
  if (const GType known = g_type_from_name(type_name)) return known;
  // GObject reads the table for the life of the process. It ends with an entry of nothing.
  static auto* const tables = new std::deque<std::vector<GEnumValue>>;
  auto& values = tables->emplace_back(choices.size() + 1);
  for (size_t i = 0; i < choices.size(); ++i)
    values[i] = {choices[i].value, g_intern_string(choices[i].description),
                 g_intern_string(choices[i].nick)};
  return g_enum_register_static(g_intern_string(type_name), values.data());
}

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

std::optional<float> number_or_auto(const char* text, float low, float high) {
  if (text && g_ascii_strcasecmp(text, "auto") == 0) return {};
  gchar* end = nullptr;
  const double number = text ? g_ascii_strtod(text, &end) : 0;
  if (text && end != text && *end == '\0' && number >= static_cast<double>(low) &&
      number <= static_cast<double>(high))
    return static_cast<float>(number);
  std::ostringstream message;
  message << " takes auto or a number from " << low << " to " << high << ", not \""
          << (text ? text : "") << "\"";
  throw Error(ErrorKind::unsupported, message.str());
}

std::string text_of(const std::optional<float>& value) {
  if (!value) return "auto";
  std::ostringstream text;
  text.precision(7);
  text << *value;
  return text.str();
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
                  "\"" + entry + "\" has no value; write name=value:name=value");
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
  throw Error(ErrorKind::unsupported,
              std::string(spec->name) + " takes " + values_of(spec) + ", not \"" + text + "\"");
}

GParamSpec* tuning_spec() {
  return g_param_spec_string(
      "tuning", "tuning",
      "Further settings as name=value:name=value; listed below and by gst-inspect-1.0", "",
      static_cast<GParamFlags>(G_PARAM_READWRITE | G_PARAM_STATIC_STRINGS |
                               GST_PARAM_MUTABLE_PLAYING));
}

void install_parameters(gpointer element_class, const PropertyStore& parameters, guint first_id) {
  parameters.install(G_OBJECT_CLASS(element_class), first_id);
  const std::string tuning = parameters.tuning_entries_text();
  if (!tuning.empty())
    gst_element_class_add_metadata(GST_ELEMENT_CLASS(element_class), "Tuning", tuning.c_str());
}

void set_parameter(const Log& log, PropertyStore& parameters, size_t index, const GValue* value,
                   const GParamSpec* spec) {
  parameters.set(index, value);
  const std::string text = parameters.misconfigured(spec->name);
  // An element that does not run yet posts it as an error when it starts: check_parameters.
  if (!text.empty() && GST_STATE_TARGET(log.object) > GST_STATE_READY)
    post_warning(log, GST_LIBRARY_ERROR, GST_LIBRARY_ERROR_SETTINGS, "%s", text.c_str());
}

bool check_parameters(const Log& log, const PropertyStore& parameters) {
  const std::string text = parameters.misconfigured();
  if (text.empty()) return true;
  GST_CAT_ERROR_OBJECT(log.category, log.object, "%s", text.c_str());
  GST_ELEMENT_ERROR(log.object, LIBRARY, SETTINGS, ("%s", text.c_str()), (nullptr));
  return false;
}

}  // namespace inverse
