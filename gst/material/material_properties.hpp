// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <mutex>
#include <optional>

#include "gst/base/color.hpp"
#include "gst/base/property_table.hpp"
#include "kernels/material/estimate/material.hpp"

namespace inverse {

/// The read-only properties of an element that estimates a material.
inline constexpr std::array kMaterialResults{"diffuse-albedo", "specular-albedo", "shininess"};

/// The parameters of an element that estimates a material, and behind them read-only properties
/// that say what it found. Thread-safe.
template <typename P>
class MaterialProperties final : public PropertyStore {
 public:
  explicit MaterialProperties(const PropertyTable<P>& table) : own_(table), count_(own_.size()) {}

  P snapshot() const { return own_.snapshot(); }
  /// What is known now; nothing if there is no object.
  void publish(const std::optional<Material>& material) {
    std::lock_guard lock(mutex_);
    material_ = material;
  }

  void install(GObjectClass* object_class, guint first_id, std::string_view child) const override {
    own_.install(object_class, first_id, child);
    const auto flags = static_cast<GParamFlags>(G_PARAM_READABLE | G_PARAM_STATIC_STRINGS);
    guint id = first_id + static_cast<guint>(count_);
    const auto add = [&](GParamSpec* spec) {
      g_object_class_install_property(object_class, id++, spec);
    };
    const auto& [diffuse, specular, shininess] = kMaterialResults;
    add(g_param_spec_uint(diffuse, "diffuse albedo",
                          "Diffuse albedo of the object (0xAARRGGBB, sRGB), notified with the "
                          "message material; 0 if there is no object",
                          0, G_MAXUINT, 0, flags));
    add(g_param_spec_float(specular, "specular albedo",
                           "Specular albedo of the object, white; 0 if there is no object", 0, 1, 0,
                           flags));
    add(g_param_spec_float(
        shininess, "shininess",
        "Exponent of the object's highlights (Blinn-Phong), 2 to 1024; 0 if there is no object", 0,
        1024, 0, flags));
  }
  void get(size_t index, GValue* value) const override {
    if (index < count_) return own_.get(index, value);
    std::lock_guard lock(mutex_);
    const Material m = material_.value_or(Material{});
    switch (index - count_) {
      case 0:
        g_value_set_uint(value, material_ ? srgb_color(m.diffuse) : 0);
        break;
      case 1:
        g_value_set_float(value, m.specular);
        break;
      case 2:
        g_value_set_float(value, material_ ? m.shininess() : 0);
        break;
    }
  }
  void set(size_t index, const GValue* value) override { own_.set(index, value); }
  std::string misconfigured(std::optional<size_t> index) const override {
    return own_.misconfigured(index);
  }
  std::string text_of(Listed which) const override { return own_.text_of(which); }

 private:
  Parameters<P> own_;
  size_t count_;
  mutable std::mutex mutex_;
  std::optional<Material> material_;
};

}  // namespace inverse
