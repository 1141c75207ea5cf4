// SPDX-License-Identifier: LGPL-2.1-or-later
#include "property_table.hpp"

#include <algorithm>
#include <deque>
#include <memory>
#include <sstream>

#include "meta/registered_once.hpp"
#include "tuning.hpp"

namespace inverse {

GType enum_type(const char* type_name, std::span<const Choice> choices) {
  return type_registered_once(type_name, [&] {
    // GObject reads the table for the life of the process. It ends with an entry of nothing.
    static auto* const tables = new std::deque<std::vector<GEnumValue>>;
    auto& values = tables->emplace_back(choices.size() + 1);
    for (size_t i = 0; i < choices.size(); ++i)
      values[i] = {choices[i].value, g_intern_string(choices[i].description),
                   g_intern_string(choices[i].nick)};
    return g_enum_register_static(g_intern_string(type_name), values.data());
  });
}

std::string_view PropertyRow::child() const {
  const std::string_view all = name;
  const size_t end = all.find("::");
  return end == std::string_view::npos ? std::string_view() : all.substr(0, end);
}

const char* PropertyRow::own_name() const {
  const std::string_view first = child();
  return first.empty() ? name : name + first.size() + 2;
}

namespace property_detail {

GParamFlags flags(Mutable when) {
  const int base = G_PARAM_READWRITE | G_PARAM_STATIC_STRINGS;
  return static_cast<GParamFlags>(base | (when == Mutable::playing
                                              ? GST_PARAM_CONTROLLABLE | GST_PARAM_MUTABLE_PLAYING
                                              : GST_PARAM_MUTABLE_READY));
}

GParamFlags text_flags() {
  return static_cast<GParamFlags>(G_PARAM_READWRITE | G_PARAM_STATIC_STRINGS |
                                  GST_PARAM_MUTABLE_PLAYING);
}

const char* nick(const char* name) {
  std::string text = name;
  std::ranges::replace(text, '-', ' ');
  return g_intern_string(text.c_str());
}

namespace {

/// A field of type T that GValue has as a G: float as gfloat, a C++ enum as gint.
template <typename T, typename G, GParamSpec* (*kSpec)(const PropertyRow&, G),
          G (*kGet)(const GValue*), void (*kSet)(GValue*, G)>
constexpr FieldType kPlain{
    [](const PropertyRow& row, const void* field) {
      return kSpec(row, static_cast<G>(*static_cast<const T*>(field)));
    },
    [](const void* field, GValue* to) { kSet(to, static_cast<G>(*static_cast<const T*>(field))); },
    [](const PropertyRow& /*row*/, void* field, const GValue* from) {
      *static_cast<T*>(field) = static_cast<T>(kGet(from));
    },
    [](void* to, const void* from) { *static_cast<T*>(to) = *static_cast<const T*>(from); },
    nullptr};

template <typename G,
          GParamSpec* (*kMake)(const gchar*, const gchar*, const gchar*, G, G, G, GParamFlags)>
GParamSpec* in_range(const PropertyRow& row, G value) {
  return kMake(row.own_name(), nick(row.own_name()), row.blurb, static_cast<G>(row.low),
               static_cast<G>(row.high), value, flags(row.when));
}
GParamSpec* boolean_spec(const PropertyRow& row, gboolean value) {
  return g_param_spec_boolean(row.own_name(), nick(row.own_name()), row.blurb, value,
                              flags(row.when));
}
GParamSpec* enum_spec(const PropertyRow& row, gint value) {
  return g_param_spec_enum(row.own_name(), nick(row.own_name()), row.blurb, row.enumeration, value,
                           flags(row.when));
}
template <typename T>
constexpr FieldType kEnum = kPlain<T, gint, enum_spec, g_value_get_enum, g_value_set_enum>;

using Auto = std::optional<float>;
float low(const PropertyRow& row) { return static_cast<float>(row.low); }
float high(const PropertyRow& row) { return static_cast<float>(row.high); }

}  // namespace

constexpr FieldType kFloat = kPlain<float, gfloat, in_range<gfloat, g_param_spec_float>,
                                    g_value_get_float, g_value_set_float>;
constexpr FieldType kDouble = kPlain<double, gdouble, in_range<gdouble, g_param_spec_double>,
                                     g_value_get_double, g_value_set_double>;
constexpr FieldType kInt =
    kPlain<int, gint, in_range<gint, g_param_spec_int>, g_value_get_int, g_value_set_int>;
constexpr FieldType kUnsigned =
    kPlain<unsigned, guint, in_range<guint, g_param_spec_uint>, g_value_get_uint, g_value_set_uint>;
constexpr FieldType kFlag =
    kPlain<bool, gboolean, boolean_spec, g_value_get_boolean, g_value_set_boolean>;
constexpr FieldType kText{[](const PropertyRow& row, const void* field) {
                            return g_param_spec_string(
                                row.own_name(), nick(row.own_name()), row.blurb,
                                static_cast<const std::string*>(field)->c_str(), flags(row.when));
                          },
                          [](const void* field, GValue* to) {
                            g_value_set_string(to, static_cast<const std::string*>(field)->c_str());
                          },
                          [](const PropertyRow& /*row*/, void* field, const GValue* from) {
                            const char* value = g_value_get_string(from);
                            *static_cast<std::string*>(field) = value ? value : "";
                          },
                          [](void* to, const void* from) {
                            *static_cast<std::string*>(to) = *static_cast<const std::string*>(from);
                          },
                          nullptr};
constexpr FieldType kNumberOrAuto{
    [](const PropertyRow& row, const void* field) {
      return g_param_spec_string(row.own_name(), nick(row.own_name()), row.blurb,
                                 text_of(*static_cast<const Auto*>(field)).c_str(), text_flags());
    },
    [](const void* field, GValue* to) {
      g_value_set_string(to, text_of(*static_cast<const Auto*>(field)).c_str());
    },
    [](const PropertyRow& row, void* field, const GValue* from) {
      *static_cast<Auto*>(field) = number_or_auto(g_value_get_string(from), low(row), high(row));
    },
    [](void* to, const void* from) { *static_cast<Auto*>(to) = *static_cast<const Auto*>(from); },
    [](const PropertyRow& row, const GValue* value) -> std::string {
      try {
        number_or_auto(g_value_get_string(value), low(row), high(row));
        return {};
      } catch (const Error& error) {
        return std::string(row.name) + error.what();
      }
    }};

const FieldType* enum_type_of(size_t bytes) {
  if (bytes == sizeof(uint8_t)) return &kEnum<uint8_t>;
  if (bytes == sizeof(int)) return &kEnum<int>;
  throw Error(ErrorKind::internal, "a property's enum is neither of uint8_t nor of int");
}

}  // namespace property_detail

namespace {

using SpecPtr = std::unique_ptr<GParamSpec, decltype(&g_param_spec_unref)>;

const void* field(const PropertyRow& row, const void* values) {
  return static_cast<const char*>(values) + row.offset;
}
void* field(const PropertyRow& row, void* values) {
  return static_cast<char*>(values) + row.offset;
}
SpecPtr spec_of(const PropertyRow& row, const void* defaults) {
  return {g_param_spec_ref_sink(row.type->make_spec(row, field(row, defaults))),
          g_param_spec_unref};
}
std::string wrong(const PropertyRow& row, const GValue* value) {
  if (row.type->wrong)
    if (std::string text = row.type->wrong(row, value); !text.empty()) return text;
  return row.wrong ? row.wrong(value) : std::string();
}

}  // namespace

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

GParamSpec* tuning_spec() {
  return g_param_spec_string(
      "tuning", "tuning",
      "Further settings as name=value:name=value; listed below and by gst-inspect-1.0", "",
      property_detail::text_flags());
}

bool PropertyStore::exchange(const std::string& name, const std::string& /*before*/,
                             const std::string& /*after*/) {
  throw Error(ErrorKind::internal, "there is no property " + name);
}

void RowParameters::install(GObjectClass* object_class, guint first_id,
                            std::string_view child) const {
  const std::lock_guard lock(mutex_);
  use_effective([&](const void* defaults) {
    for (size_t i = 0; i < rows_.size(); ++i)
      if (!rows_[i].in_tuning && rows_[i].child() == child)
        g_object_class_install_property(
            object_class, first_id + static_cast<guint>(i),
            rows_[i].type->make_spec(rows_[i], field(rows_[i], defaults)));
  });
  if (has_tuning() && child.empty())
    g_object_class_install_property(object_class, first_id + static_cast<guint>(rows_.size()),
                                    tuning_spec());
}

std::vector<std::string> RowParameters::children() const {
  std::vector<std::string> names;
  for (const PropertyRow& row : rows_)
    if (!row.child().empty() && std::ranges::find(names, row.child()) == names.end())
      names.emplace_back(row.child());
  return names;
}

void RowParameters::get(size_t index, GValue* value) const {
  const std::lock_guard lock(mutex_);
  if (index == rows_.size()) return g_value_set_string(value, tuning_.c_str());
  use_effective(
      [&](const void* values) { rows_[index].type->read(field(rows_[index], values), value); });
}

void RowParameters::set(size_t index, const GValue* value) {
  const std::lock_guard lock(mutex_);
  if (index == rows_.size()) {
    const char* text = g_value_get_string(value);
    return set_tuning(text ? text : "");
  }
  const PropertyRow& row = rows_[index];
  misconfigured_.erase(index);
  if (const std::string text = wrong(row, value); !text.empty()) {
    misconfigured_[index] = text;
    return;
  }
  row.type->write(row, field(row, values_), value);
  explicitly_[index] = true;
}

bool RowParameters::exchange(const std::string& name, const std::string& before,
                             const std::string& after) {
  const std::lock_guard lock(mutex_);
  const auto row = std::ranges::find(rows_, name, &PropertyRow::name);
  if (row == rows_.end()) return PropertyStore::exchange(name, before, after);
  GValue value = G_VALUE_INIT;
  g_value_init(&value, G_TYPE_STRING);
  use_effective([&](const void* values) { row->type->read(field(*row, values), &value); });
  const bool same = before == g_value_get_string(&value);
  if (same) {
    g_value_set_string(&value, after.c_str());
    row->type->write(*row, field(*row, values_), &value);
    const auto index = static_cast<size_t>(row - rows_.begin());
    explicitly_[index] = true;
    misconfigured_.erase(index);
  }
  g_value_unset(&value);
  return same;
}

std::string RowParameters::misconfigured(std::optional<size_t> index) const {
  const std::lock_guard lock(mutex_);
  const auto found = index ? misconfigured_.find(*index) : misconfigured_.begin();
  return found == misconfigured_.end() ? std::string() : found->second;
}

std::string RowParameters::text_of(Listed which) const {
  const std::lock_guard lock(mutex_);
  std::string lines;
  use_effective([&](const void* defaults) {
    for (const PropertyRow& row : rows_) {
      if (which == Listed::tuning ? !row.in_tuning : row.child().empty()) continue;
      const SpecPtr spec = spec_of(row, defaults);
      lines += std::string(row.name) + ": " + values_of(spec.get()) + ": " +
               g_param_spec_get_blurb(spec.get()) + "\n";
    }
  });
  return lines;
}

void RowParameters::copy_explicit(void* to) const {
  for (size_t i = 0; i < rows_.size(); ++i)
    if (explicitly_[i]) rows_[i].type->copy(field(rows_[i], to), field(rows_[i], values_));
}

bool RowParameters::has_tuning() const {
  return std::ranges::any_of(rows_, &PropertyRow::in_tuning);
}

void RowParameters::set_tuning(const std::string& text) {
  struct Value {
    size_t index;
    GValue value;
  };
  std::vector<Value> entries;
  const auto free_entries = [&] {
    for (Value& entry : entries) g_value_unset(&entry.value);
  };
  try {
    for (const auto& [name, written] : tuning_entries(text)) {
      const auto row = std::ranges::find_if(
          rows_, [&name = name](const PropertyRow& r) { return r.in_tuning && r.name == name; });
      if (row == rows_.end())
        throw Error(ErrorKind::unsupported, "there is no \"" + name.substr(0, 40) + "\"");
      GValue value = G_VALUE_INIT;
      tuning_value(spec_of(*row, defaults_).get(), written, &value);
      entries.push_back({static_cast<size_t>(row - rows_.begin()), value});
    }
  } catch (const Error& error) {
    free_entries();
    std::string& wrong = misconfigured_[rows_.size()];
    wrong = "tuning=\"" + text.substr(0, 100) + (text.size() > 100 ? "…" : "") +
            "\": " + error.what() + "; its names are";
    for (const PropertyRow& row : rows_)
      if (row.in_tuning) wrong += " " + std::string(row.name);
    return;
  }
  for (size_t i = 0; i < rows_.size(); ++i)
    if (rows_[i].in_tuning) {
      rows_[i].type->copy(field(rows_[i], values_), field(rows_[i], defaults_));
      explicitly_[i] = false;
    }
  for (const auto& [index, value] : entries) {
    rows_[index].type->write(rows_[index], field(rows_[index], values_), &value);
    explicitly_[index] = true;
  }
  free_entries();
  tuning_ = text;
  misconfigured_.erase(rows_.size());
}

void install_parameters(gpointer element_class, const PropertyStore& parameters, guint first_id) {
  parameters.install(G_OBJECT_CLASS(element_class), first_id);
  for (const auto& [key, which] : {std::pair{"Children", PropertyStore::Listed::children},
                                   std::pair{"Tuning", PropertyStore::Listed::tuning}})
    if (const std::string text = parameters.text_of(which); !text.empty())
      gst_element_class_add_metadata(GST_ELEMENT_CLASS(element_class), key, text.c_str());
}

void set_parameter(const Log& log, PropertyStore& parameters, size_t index, const GValue* value) {
  parameters.set(index, value);
  const std::string text = parameters.misconfigured(index);
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
