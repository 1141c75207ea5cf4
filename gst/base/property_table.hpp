#pragma once
#include <gst/gst.h>

#include <algorithm>
#include <functional>
#include <mutex>
#include <string>
#include <type_traits>
#include <vector>

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
};

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
  return {name, {}, {}, {}, [access](P& to, const P& from) {
            field(to, access) = field(from, access);
          }};
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

/// The parameters of one element as GObject sees them; index = place in the table. Thread-safe.
class PropertyStore {
 public:
  virtual ~PropertyStore() = default;
  virtual void install(GObjectClass* object_class, guint first_id) const = 0;
  virtual void get(size_t index, GValue* value) const = 0;
  virtual void set(size_t index, const GValue* value) = 0;
};

/// The parameters of one element. `preset` turns the values that were set so far into a full set of
/// defaults (for `quality`); whatever was set explicitly wins over it.
template <typename P>
class Parameters final : public PropertyStore {
 public:
  using Preset = std::function<P(const P& set_so_far)>;
  explicit Parameters(const PropertyTable<P>& table, Preset preset = nullptr)
      : table_(table), preset_(std::move(preset)), explicitly_(table.size()) {}

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
      g_object_class_install_property(object_class, first_id + static_cast<guint>(i),
                                      table_[i].make_spec(defaults));
  }
  void get(size_t index, GValue* value) const override { table_[index].read(snapshot(), value); }
  void set(size_t index, const GValue* value) override {
    std::lock_guard lock(mutex_);
    table_[index].write(values_, value);
    explicitly_[index] = true;
  }

 private:
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
};

}  // namespace inverse
