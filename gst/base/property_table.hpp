// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/gst.h>

#include <algorithm>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "common/error.hpp"
#include "gst/base/log/log.hpp"

namespace inverse {

/// When a property may change.
enum class Mutable {
  playing,  ///< at any time; takes effect with the next frame, and can be driven by a GstController
  ready,    ///< only before the element leaves READY
};

/// One GObject property that stands for one field of a parameter struct `P`: name, range, default
/// and blurb are said here and nowhere else (the default is the field's initializer).
template <typename P>
struct Property {
  std::string name;
  std::function<GParamSpec*(const P& defaults)> make_spec;
  std::function<void(const P&, GValue*)> read;
  std::function<void(P&, const GValue*)> write;
  std::function<void(P& to, const P& from)> copy;
  /// An entry of the property `tuning` in place of a property of its own.
  bool in_tuning = false;
  /// What is wrong with a value, in words; empty if nothing is. Not set: the spec says it all.
  std::function<std::string(const GValue*)> wrong;
};

/// Makes an entry of the property `tuning` out of a property that is rarely set. Its value's text
/// must have neither ':' nor ','.
template <typename P>
Property<P> tuning(Property<P> property) {
  property.in_tuning = true;
  return property;
}

namespace property_detail {

inline GParamFlags flags(Mutable when) {
  const int base = G_PARAM_READWRITE | G_PARAM_STATIC_STRINGS;
  return static_cast<GParamFlags>(base | (when == Mutable::playing
                                              ? GST_PARAM_CONTROLLABLE | GST_PARAM_MUTABLE_PLAYING
                                              : GST_PARAM_MUTABLE_READY));
}

/// "w-data" → "w data": nicks are not translated and only shown by inspection tools.
inline const char* nick(const std::string& name) {
  std::string text = name;
  std::replace(text.begin(), text.end(), '-', ' ');
  return g_intern_string(text.c_str());
}

/// The field that `access` names in `params`: a member pointer, or a function that reaches into
/// nested structs.
template <typename P, typename Access>
auto& field(P& params, const Access& access) {
  return std::invoke(access, params);
}
template <typename P, typename Access>
const auto& field(const P& params, const Access& access) {
  return std::invoke(access, const_cast<P&>(params));
}
template <typename P, typename Access>
using FieldOf = std::remove_reference_t<std::invoke_result_t<Access, P&>>;

template <typename P, typename Access>
Property<P> named(const char* name, Access access) {
  Property<P> property;
  property.name = name;
  property.copy = [access](P& to, const P& from) { field(to, access) = field(from, access); };
  return property;
}

}  // namespace property_detail

/// A numeric property: float, double, int or unsigned by the type of the field, which is a member
/// pointer or a function `F& (P&)` into nested structs. `blurb` names the unit.
template <typename P, typename Access, typename T = property_detail::FieldOf<P, Access>>
Property<P> number(const char* name, Access access, std::type_identity_t<T> low,
                   std::type_identity_t<T> high, const char* blurb,
                   Mutable when = Mutable::playing) {
  using property_detail::field;
  Property<P> property = property_detail::named<P>(name, access);
  property.make_spec = [=](const P& defaults) {
    const char* nick = property_detail::nick(name);
    const GParamFlags flags = property_detail::flags(when);
    const T value = field(defaults, access);
    if constexpr (std::is_same_v<T, float>)
      return g_param_spec_float(name, nick, blurb, low, high, value, flags);
    else if constexpr (std::is_same_v<T, double>)
      return g_param_spec_double(name, nick, blurb, low, high, value, flags);
    else if constexpr (std::is_signed_v<T>)
      return g_param_spec_int(name, nick, blurb, low, high, value, flags);
    else
      return g_param_spec_uint(name, nick, blurb, low, high, value, flags);
  };
  property.read = [access](const P& from, GValue* to) {
    if constexpr (std::is_same_v<T, float>)
      g_value_set_float(to, field(from, access));
    else if constexpr (std::is_same_v<T, double>)
      g_value_set_double(to, field(from, access));
    else if constexpr (std::is_signed_v<T>)
      g_value_set_int(to, field(from, access));
    else
      g_value_set_uint(to, field(from, access));
  };
  property.write = [access](P& to, const GValue* from) {
    if constexpr (std::is_same_v<T, float>)
      field(to, access) = g_value_get_float(from);
    else if constexpr (std::is_same_v<T, double>)
      field(to, access) = g_value_get_double(from);
    else if constexpr (std::is_signed_v<T>)
      field(to, access) = g_value_get_int(from);
    else
      field(to, access) = g_value_get_uint(from);
  };
  return property;
}

/// A yes-or-no property.
template <typename P, typename Access>
Property<P> flag(const char* name, Access access, const char* blurb,
                 Mutable when = Mutable::playing) {
  using property_detail::field;
  Property<P> property = property_detail::named<P>(name, access);
  property.make_spec = [=](const P& defaults) {
    return g_param_spec_boolean(name, property_detail::nick(name), blurb, field(defaults, access),
                                property_detail::flags(when));
  };
  property.read = [access](const P& from, GValue* to) {
    g_value_set_boolean(to, field(from, access));
  };
  property.write = [access](P& to, const GValue* from) {
    field(to, access) = g_value_get_boolean(from);
  };
  return property;
}

/// A text; null is the empty one.
template <typename P, typename Access>
Property<P> text(const char* name, Access access, const char* blurb,
                 Mutable when = Mutable::playing) {
  using property_detail::field;
  Property<P> property = property_detail::named<P>(name, access);
  property.make_spec = [=](const P& defaults) {
    return g_param_spec_string(name, property_detail::nick(name), blurb,
                               field(defaults, access).c_str(), property_detail::flags(when));
  };
  property.read = [access](const P& from, GValue* to) {
    g_value_set_string(to, field(from, access).c_str());
  };
  property.write = [access](P& to, const GValue* from) {
    const char* value = g_value_get_string(from);
    field(to, access) = value ? value : "";
  };
  return property;
}

/// The number that a text is, in [low, high]; empty for "auto". Throws Error(unsupported).
std::optional<float> number_or_auto(const char* text, float low, float high);
/// The text of a number, or "auto".
std::string text_of(const std::optional<float>& value);

/// A number in [low, high] or the text "auto"; the field is std::optional<float>, empty for auto.
template <typename P, typename Access>
Property<P> number_or_auto(const char* name, Access access, float low, float high,
                           const char* blurb) {
  using property_detail::field;
  Property<P> property = property_detail::named<P>(name, access);
  property.make_spec = [=](const P& defaults) {
    return g_param_spec_string(name, property_detail::nick(name), blurb,
                               text_of(field(defaults, access)).c_str(),
                               static_cast<GParamFlags>(G_PARAM_READWRITE | G_PARAM_STATIC_STRINGS |
                                                        GST_PARAM_MUTABLE_PLAYING));
  };
  property.read = [access](const P& from, GValue* to) {
    g_value_set_string(to, text_of(field(from, access)).c_str());
  };
  property.write = [=](P& to, const GValue* from) {
    field(to, access) = number_or_auto(g_value_get_string(from), low, high);
  };
  property.wrong = [=](const GValue* value) -> std::string {
    try {
      number_or_auto(g_value_get_string(value), low, high);
      return {};
    } catch (const Error& error) {
      return std::string(name) + error.what();
    }
  };
  return property;
}

/// One value of an enumerated property.
struct Choice {
  int value;
  const char* nick;         ///< what users type
  const char* description;  ///< one sentence
};

/// Registers a GEnum of these choices under `type_name`, once.
GType enum_type(const char* type_name, const std::vector<Choice>& choices);

/// A property that is one of the values of a C++ enum.
template <typename P, typename Access>
Property<P> choice(const char* name, Access access, const char* type_name,
                   const std::vector<Choice>& choices, const char* blurb,
                   Mutable when = Mutable::playing) {
  using property_detail::field;
  using E = property_detail::FieldOf<P, Access>;
  static_assert(std::is_enum_v<E>);
  Property<P> property = property_detail::named<P>(name, access);
  property.make_spec = [=](const P& defaults) {
    return g_param_spec_enum(
        name, property_detail::nick(name), blurb, enum_type(type_name, choices),
        static_cast<int>(field(defaults, access)), property_detail::flags(when));
  };
  property.read = [access](const P& from, GValue* to) {
    g_value_set_enum(to, static_cast<int>(field(from, access)));
  };
  property.write = [access](P& to, const GValue* from) {
    field(to, access) = static_cast<E>(g_value_get_enum(from));
  };
  return property;
}

/// A color: an unsigned 0xAARRGGBB as in other GStreamer elements (sRGB; alpha is ignored).
template <typename P, typename Access>
Property<P> color(const char* name, Access access, const char* blurb) {
  return number<P>(name, access, 0u, 0xffffffffu, blurb);
}

template <typename P>
using PropertyTable = std::vector<Property<P>>;

/// The values that a property takes, and its default: "0…1 (0.5)".
std::string values_of(GParamSpec* spec);

/// The text of a `tuning` property, "name=value:name=value" (or with ','), as pairs in order.
/// Throws Error(unsupported) if it is something else.
std::vector<std::pair<std::string, std::string>> tuning_entries(const std::string& text);

/// Reads `text` as a value of the property `spec` into `value`, which is unset. Throws
/// Error(unsupported) if it is none, or out of range.
void tuning_value(GParamSpec* spec, const std::string& text, GValue* value);

/// The property `tuning`.
GParamSpec* tuning_spec();

/// The parameters of one element as GObject sees them; index = place in the table, behind them
/// `tuning`. Thread-safe.
class PropertyStore {
 public:
  virtual ~PropertyStore() = default;
  virtual void install(GObjectClass* object_class, guint first_id) const = 0;
  virtual void get(size_t index, GValue* value) const = 0;
  virtual void set(size_t index, const GValue* value) = 0;
  /// What is wrong with what the property `name` was set to last (of `tuning`: and which names it
  /// takes), in words; the value before stays in force. Empty if nothing is. Null: of any property.
  virtual std::string misconfigured(const char* /*name*/ = nullptr) const { return {}; }
  /// The entries of `tuning`, one a line, "name: values (default): meaning"; empty if it has
  /// none.
  virtual std::string tuning_entries_text() const { return {}; }
};

/// Installs an element class's parameters, and lists the entries of `tuning` in its metadata, which
/// gst-inspect-1.0 shows.
void install_parameters(gpointer element_class, const PropertyStore& parameters, guint first_id);
/// GObject::set_property of one of them: a text that cannot be read becomes a warning if the
/// element runs.
void set_parameter(const Log& log, PropertyStore& parameters, size_t index, const GValue* value,
                   const GParamSpec* spec);
/// Posts an error and returns false if a text cannot be read: the element does not start.
bool check_parameters(const Log& log, const PropertyStore& parameters);

/// The parameters of one element. `preset` turns the values that were set so far into a full set of
/// defaults (for `quality`); whatever was set explicitly wins over it.
template <typename P>
class Parameters final : public PropertyStore {
 public:
  using Preset = std::function<P(const P& set_so_far)>;
  explicit Parameters(const PropertyTable<P>& table, Preset preset = nullptr)
      : table_(table), preset_(std::move(preset)), explicitly_(table.size()) {}

  /// Indices in use.
  size_t size() const { return table_.size() + (has_tuning() ? 1 : 0); }

  /// The values in force now.
  P snapshot() const {
    std::lock_guard lock(mutex_);
    return effective();
  }
  /// The same with `adjust(P&)` applied to the preset: what was set explicitly wins over that, too.
  template <typename Adjust>
  P snapshot(Adjust adjust) const {
    std::lock_guard lock(mutex_);
    P result = preset_ ? preset_(values_) : values_;
    adjust(result);
    return with_explicit(result);
  }

  void install(GObjectClass* object_class, guint first_id) const override {
    const P defaults = effective();
    for (size_t i = 0; i < table_.size(); ++i)
      if (!table_[i].in_tuning)
        g_object_class_install_property(object_class, first_id + static_cast<guint>(i),
                                        table_[i].make_spec(defaults));
    if (has_tuning())
      g_object_class_install_property(object_class, first_id + static_cast<guint>(table_.size()),
                                      tuning_spec());
  }
  void get(size_t index, GValue* value) const override {
    if (index < table_.size()) return table_[index].read(snapshot(), value);
    std::lock_guard lock(mutex_);
    g_value_set_string(value, tuning_.c_str());
  }
  void set(size_t index, const GValue* value) override {
    std::lock_guard lock(mutex_);
    if (index == table_.size()) {
      const char* text = g_value_get_string(value);
      return set_tuning(text ? text : "");
    }
    const Property<P>& property = table_[index];
    misconfigured_.erase(property.name);
    if (property.wrong)
      if (const std::string wrong = property.wrong(value); !wrong.empty()) {
        misconfigured_[property.name] = wrong;
        return;
      }
    property.write(values_, value);
    explicitly_[index] = true;
  }
  std::string misconfigured(const char* name) const override {
    std::lock_guard lock(mutex_);
    const auto found = name ? misconfigured_.find(name) : misconfigured_.begin();
    return found == misconfigured_.end() ? std::string() : found->second;
  }
  std::string tuning_entries_text() const override {
    const P defaults = effective();
    std::string lines;
    for (const Property<P>& property : table_) {
      if (!property.in_tuning) continue;
      const auto spec = spec_of(property, defaults);
      lines += property.name + ": " + values_of(spec.get()) + ": " +
               g_param_spec_get_blurb(spec.get()) + "\n";
    }
    return lines;
  }

 private:
  using SpecPtr = std::unique_ptr<GParamSpec, decltype(&g_param_spec_unref)>;
  static SpecPtr spec_of(const Property<P>& property, const P& defaults) {
    return {g_param_spec_ref_sink(property.make_spec(defaults)), g_param_spec_unref};
  }
  bool has_tuning() const {
    return std::any_of(table_.begin(), table_.end(), [](const auto& p) { return p.in_tuning; });
  }

  /// Takes all entries of the text, or none. Entries that it does not name return to their
  /// defaults. mutex_ held.
  void set_tuning(const std::string& text) {
    const P defaults{};
    P values = values_;
    std::vector<bool> explicitly = explicitly_;
    for (size_t i = 0; i < table_.size(); ++i)
      if (table_[i].in_tuning) {
        table_[i].copy(values, defaults);
        explicitly[i] = false;
      }
    try {
      for (const auto& [name, value] : tuning_entries(text))
        write_entry(name, value, values, explicitly);
    } catch (const Error& error) {
      std::string& wrong = misconfigured_["tuning"];
      wrong = "tuning=\"" + text + "\": " + error.what() + "; its names are";
      for (const Property<P>& property : table_)
        if (property.in_tuning) wrong += " " + property.name;
      return;
    }
    values_ = values;
    explicitly_ = explicitly;
    tuning_ = text;
    misconfigured_.erase("tuning");
  }
  void write_entry(const std::string& name, const std::string& value, P& values,
                   std::vector<bool>& explicitly) const {
    const auto entry = std::find_if(table_.begin(), table_.end(), [&](const auto& property) {
      return property.in_tuning && property.name == name;
    });
    if (entry == table_.end()) throw Error(ErrorKind::unsupported, "there is no \"" + name + "\"");
    GValue read = G_VALUE_INIT;
    tuning_value(spec_of(*entry, P{}).get(), value, &read);
    entry->write(values, &read);
    g_value_unset(&read);
    explicitly[static_cast<size_t>(entry - table_.begin())] = true;
  }
  P effective() const { return preset_ ? with_explicit(preset_(values_)) : values_; }
  P with_explicit(P result) const {
    for (size_t i = 0; i < table_.size(); ++i)
      if (explicitly_[i]) table_[i].copy(result, values_);
    return result;
  }

  const PropertyTable<P>& table_;
  Preset preset_;
  mutable std::mutex mutex_;
  P values_{};
  std::vector<bool> explicitly_;
  std::string tuning_;
  std::map<std::string, std::string> misconfigured_;  // by property
};

}  // namespace inverse
