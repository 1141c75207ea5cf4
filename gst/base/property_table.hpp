// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/gst.h>

#include <functional>
#include <initializer_list>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
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

/// One value of an enumerated property.
struct Choice {
  int value;
  const char* nick;         ///< what users type
  const char* description;  ///< one sentence
};

/// Registers a GEnum of these choices under `type_name`, once.
GType enum_type(const char* type_name, std::span<const Choice> choices);

struct PropertyRow;

/// How GObject sees a field of one C++ type.
struct FieldType {
  GParamSpec* (*make_spec)(const PropertyRow& row, const void* field);  ///< whose default it is
  void (*read)(const void* field, GValue* to);
  void (*write)(const PropertyRow& row, void* field, const GValue* from);
  void (*copy)(void* to, const void* from);
  /// What is wrong with a value, in words; empty if nothing is. Null: the spec says it all.
  std::string (*wrong)(const PropertyRow& row, const GValue* value);
};

/// One GObject property that stands for one field of a parameter struct: name, range, default and
/// blurb are said here and nowhere else (the default is the field's initializer).
struct PropertyRow {
  const char* name;  ///< "show", or "strokes::radius": `radius` of the child object "strokes"
  const char* blurb;
  const FieldType* type;
  size_t offset;  ///< of the field in the struct, bytes
  Mutable when = Mutable::playing;
  double low = 0, high = 0;         ///< of numbers
  GType enumeration = G_TYPE_NONE;  ///< of choices
  /// An entry of the property `tuning` in place of a property of its own.
  bool in_tuning = false;
  /// What is wrong with a value, in words; empty if nothing is. Null: the type says it all.
  std::string (*wrong)(const GValue* value) = nullptr;

  /// The child object that has the property; empty if it is the element.
  std::string_view child() const;
  /// The name of the property in that object.
  const char* own_name() const;
};

/// A row whose field is in `P`.
template <typename P>
struct Property : PropertyRow {};

/// The rows of `P`.
template <typename P>
class PropertyTable {
 public:
  PropertyTable() = default;
  PropertyTable(std::initializer_list<Property<P>> rows) {
    rows_.reserve(rows.size());
    for (const PropertyRow& row : rows) rows_.push_back(row);
  }
  void append(const PropertyTable& other) {
    rows_.insert(rows_.end(), other.rows_.begin(), other.rows_.end());
  }
  const std::vector<PropertyRow>& rows() const { return rows_; }

 private:
  std::vector<PropertyRow> rows_;
};

/// Makes an entry of the property `tuning` out of a property that is rarely set. Its value's text
/// must have neither ':' nor ','.
template <typename P>
Property<P> tuning(Property<P> property) {
  property.in_tuning = true;
  return property;
}

namespace property_detail {

GParamFlags flags(Mutable when);
/// Of a text that stands for another type: it can be set while playing, but not controlled.
GParamFlags text_flags();
/// "w-data" → "w data": nicks are not translated and only shown by inspection tools.
const char* nick(const char* name);

extern const FieldType kFloat, kDouble, kInt, kUnsigned, kFlag, kText, kNumberOrAuto;
inline const FieldType* type_of(const float&) { return &kFloat; }
inline const FieldType* type_of(const double&) { return &kDouble; }
inline const FieldType* type_of(const int&) { return &kInt; }
inline const FieldType* type_of(const unsigned&) { return &kUnsigned; }
/// Of a C++ enum of that many bytes. Throws Error(internal) if there is none.
const FieldType* enum_type_of(size_t bytes);

/// A P with its defaults.
template <typename P>
P& defaults() {
  static P values{};
  return values;
}
/// The field that `access` names: a member pointer, or a function that reaches into nested structs.
template <typename P, typename Access>
auto& field(Access access) {
  return std::invoke(access, defaults<P>());
}
template <typename P, typename Access>
using FieldOf = std::remove_reference_t<std::invoke_result_t<Access, P&>>;

template <typename P>
Property<P> row(const char* name, const char* blurb, const FieldType* type, const void* field,
                Mutable when, double low = 0, double high = 0, GType enumeration = G_TYPE_NONE) {
  const auto offset = static_cast<size_t>(static_cast<const char*>(field) -
                                          reinterpret_cast<const char*>(&defaults<P>()));
  return {{name, blurb, type, offset, when, low, high, enumeration}};
}

}  // namespace property_detail

/// A numeric property: float, double, int or unsigned by the type of the field, which is a member
/// pointer or a function `F& (P&)` into nested structs. `blurb` names the unit.
template <typename P, typename Access, typename T = property_detail::FieldOf<P, Access>>
Property<P> number(const char* name, Access access, std::type_identity_t<T> low,
                   std::type_identity_t<T> high, const char* blurb,
                   Mutable when = Mutable::playing) {
  const T& field = property_detail::field<P>(access);
  return property_detail::row<P>(name, blurb, property_detail::type_of(field), &field, when,
                                 static_cast<double>(low), static_cast<double>(high));
}

/// A yes-or-no property.
template <typename P, typename Access>
Property<P> flag(const char* name, Access access, const char* blurb,
                 Mutable when = Mutable::playing) {
  const bool& field = property_detail::field<P>(access);
  return property_detail::row<P>(name, blurb, &property_detail::kFlag, &field, when);
}

/// A text; null is the empty one.
template <typename P, typename Access>
Property<P> text(const char* name, Access access, const char* blurb,
                 Mutable when = Mutable::playing) {
  const std::string& field = property_detail::field<P>(access);
  return property_detail::row<P>(name, blurb, &property_detail::kText, &field, when);
}

/// A number in [low, high] or the text "auto"; the field is std::optional<float>, empty for auto.
template <typename P, typename Access>
Property<P> number_or_auto(const char* name, Access access, float low, float high,
                           const char* blurb) {
  const std::optional<float>& field = property_detail::field<P>(access);
  return property_detail::row<P>(name, blurb, &property_detail::kNumberOrAuto, &field,
                                 Mutable::playing, static_cast<double>(low),
                                 static_cast<double>(high));
}

/// A property that is one of the values of a C++ enum.
template <typename P, typename Access>
Property<P> choice(const char* name, Access access, const char* type_name,
                   std::span<const Choice> choices, const char* blurb,
                   Mutable when = Mutable::playing) {
  using E = property_detail::FieldOf<P, Access>;
  static_assert(std::is_enum_v<E>);
  return property_detail::row<P>(name, blurb, property_detail::enum_type_of(sizeof(E)),
                                 &property_detail::field<P>(access), when, 0, 0,
                                 enum_type(type_name, choices));
}
template <typename P, typename Access>
Property<P> choice(const char* name, Access access, const char* type_name,
                   std::initializer_list<Choice> choices, const char* blurb,
                   Mutable when = Mutable::playing) {
  return choice<P>(name, access, type_name, std::span(choices.begin(), choices.size()), blurb,
                   when);
}

/// A color: an unsigned 0xAARRGGBB as in other GStreamer elements (sRGB; alpha is ignored).
template <typename P, typename Access>
Property<P> color(const char* name, Access access, const char* blurb) {
  return number<P>(name, access, 0u, 0xffffffffu, blurb);
}

/// A text that stands for a field of any type: `kText` is `std::string (const T&)`, `kWrite` is
/// `void (T&, const char*)`, which is given the empty text for null.
template <typename P, auto kText, auto kWrite, typename Access>
Property<P> text_for(const char* name, Access access, const char* blurb,
                     std::string (*wrong)(const GValue*) = nullptr) {
  using T = property_detail::FieldOf<P, Access>;
  static constexpr FieldType kType{
      [](const PropertyRow& row, const void* field) {
        return g_param_spec_string(row.own_name(), property_detail::nick(row.own_name()), row.blurb,
                                   g_intern_string(kText(*static_cast<const T*>(field)).c_str()),
                                   property_detail::text_flags());
      },
      [](const void* field, GValue* to) {
        g_value_set_string(to, kText(*static_cast<const T*>(field)).c_str());
      },
      [](const PropertyRow& /*row*/, void* field, const GValue* from) {
        const char* text = g_value_get_string(from);
        kWrite(*static_cast<T*>(field), text ? text : "");
      },
      [](void* to, const void* from) { *static_cast<T*>(to) = *static_cast<const T*>(from); },
      nullptr};
  Property<P> property = property_detail::row<P>(
      name, blurb, &kType, &property_detail::field<P>(access), Mutable::playing);
  property.wrong = wrong;
  return property;
}

/// The number that a text is, in [low, high]; empty for "auto". Throws Error(unsupported).
std::optional<float> number_or_auto(const char* text, float low, float high);
/// The text of a number, or "auto".
std::string text_of(const std::optional<float>& value);

/// The property `tuning`.
GParamSpec* tuning_spec();

/// The parameters of one element as GObject sees them; index = place in the table, behind them
/// `tuning`. Thread-safe.
class PropertyStore {
 public:
  virtual ~PropertyStore() = default;
  /// Installs the properties of a child object, or of the element.
  virtual void install(GObjectClass* object_class, guint first_id,
                       std::string_view child = {}) const = 0;
  /// The names of the child objects that have some of the properties.
  virtual std::vector<std::string> children() const { return {}; }
  virtual void get(size_t index, GValue* value) const = 0;
  virtual void set(size_t index, const GValue* value) = 0;
  /// Gives the text property `name` a valid value if it is `before` now, and returns whether it
  /// was; GObject::notify is for the caller. Throws Error(internal) if there is no such property.
  virtual bool exchange(const std::string& name, const std::string& before,
                        const std::string& after);
  /// What is wrong with what a property was set to last (of `tuning`: and which names it takes), in
  /// words; the value before stays in force. Empty if nothing is. Without an index: of any
  /// property.
  virtual std::string misconfigured(std::optional<size_t> /*index*/ = {}) const { return {}; }
  /// The entries of `tuning`, or the properties of child objects, one a line, "name: values
  /// (default): meaning"; empty if there are none.
  enum class Listed { tuning, children };
  virtual std::string text_of(Listed /*which*/) const { return {}; }
};

/// Installs an element class's parameters, and lists those that gst-inspect-1.0 does not find in
/// its metadata, which it shows.
void install_parameters(gpointer element_class, const PropertyStore& parameters, guint first_id);
/// GObject::set_property of one of them: a text that cannot be read becomes a warning if the
/// element runs.
void set_parameter(const Log& log, PropertyStore& parameters, size_t index, const GValue* value);
/// Posts an error and returns false if a text cannot be read: the element does not start.
bool check_parameters(const Log& log, const PropertyStore& parameters);

/// The part of Parameters that is the same for all parameter structs.
class RowParameters : public PropertyStore {
 public:
  RowParameters(const RowParameters&) = delete;
  RowParameters& operator=(const RowParameters&) = delete;

  /// Indices in use.
  size_t size() const { return rows_.size() + (has_tuning() ? 1 : 0); }
  void install(GObjectClass* object_class, guint first_id, std::string_view child) const override;
  std::vector<std::string> children() const override;
  void get(size_t index, GValue* value) const override;
  void set(size_t index, const GValue* value) override;
  bool exchange(const std::string& name, const std::string& before,
                const std::string& after) override;
  std::string misconfigured(std::optional<size_t> index) const override;
  std::string text_of(Listed which) const override;

 protected:
  /// `defaults` and `values` point to two parameter structs, the second to this one's own.
  RowParameters(const std::vector<PropertyRow>& rows, const void* defaults, void* values)
      : rows_(rows), defaults_(defaults), values_(values), explicitly_(rows.size()) {}
  /// Copies the fields that were set. mutex_ held.
  void copy_explicit(void* to) const;
  mutable std::mutex mutex_;

 private:
  /// Calls `use` with the values in force. mutex_ held.
  virtual void use_effective(const std::function<void(const void*)>& use) const = 0;
  bool has_tuning() const;
  /// Takes all entries of the text, or none. Entries that it does not name return to their
  /// defaults. mutex_ held.
  void set_tuning(const std::string& text);

  const std::vector<PropertyRow>& rows_;
  const void* defaults_;
  void* values_;
  std::vector<bool> explicitly_;
  std::string tuning_;
  std::map<size_t, std::string> misconfigured_;  // by index
};

/// The parameters of one element. `preset` turns the values that were set so far into a full set of
/// defaults (for `quality`); whatever was set explicitly wins over it.
template <typename P>
class Parameters final : public RowParameters {
 public:
  using Preset = std::function<P(const P& set_so_far)>;
  explicit Parameters(const PropertyTable<P>& table, Preset preset = nullptr)
      : RowParameters(table.rows(), &property_detail::defaults<P>(), &values_),
        preset_(std::move(preset)) {}

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
    copy_explicit(&result);
    return result;
  }

 private:
  void use_effective(const std::function<void(const void*)>& use) const override {
    const P values = effective();
    use(&values);
  }
  P effective() const {
    if (!preset_) return values_;
    P result = preset_(values_);
    copy_explicit(&result);
    return result;
  }

  Preset preset_;
  P values_{};
};

}  // namespace inverse
