// SPDX-License-Identifier: LGPL-2.1-or-later
// Texts of the property tuning, and each of their values as one of every type: an Error, or a value
// within its range.
#include "gst/base/tuning.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "common/error.hpp"

// GLib drops its tables of names when they grow.
extern "C" const char* __asan_default_options() { return "detect_leaks=0"; }

extern "C" int LLVMFuzzerInitialize(int* count, char*** words) {
  gst_init(count, words);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace inverse;
  const auto flags = static_cast<GParamFlags>(G_PARAM_READWRITE | G_PARAM_STATIC_STRINGS);
  static GParamSpec* const specs[] = {
      g_param_spec_float("f", "f", "f", -1, 1, 0, flags),
      g_param_spec_double("d", "d", "d", 0, 1e300, 1, flags),
      g_param_spec_int("i", "i", "i", -5, 5, 0, flags),
      g_param_spec_uint("u", "u", "u", 1, G_MAXUINT, 1, flags),
      g_param_spec_boolean("b", "b", "b", TRUE, flags),
      g_param_spec_enum("e", "e", "e", GST_TYPE_STATE, GST_STATE_NULL, flags)};
  // A property's text ends with its first zero.
  const std::string text(reinterpret_cast<const char*>(data), size);
  std::vector<std::pair<std::string, std::string>> entries;
  try {
    entries = tuning_entries(text.c_str());
  } catch (const Error&) {
  }
  for (const auto& [name, written] : entries)
    for (GParamSpec* spec : specs) {
      GValue value = G_VALUE_INIT;
      try {
        tuning_value(spec, written, &value);
      } catch (const Error&) {
        if (G_IS_VALUE(&value)) abort();
        continue;
      }
      if (G_VALUE_HOLDS_FLOAT(&value) && !(std::abs(g_value_get_float(&value)) <= 1)) abort();
      if (G_VALUE_HOLDS_DOUBLE(&value) && !(g_value_get_double(&value) >= 0)) abort();
      if (G_VALUE_HOLDS_INT(&value) && std::abs(g_value_get_int(&value)) > 5) abort();
      if (G_VALUE_HOLDS_UINT(&value) && g_value_get_uint(&value) < 1) abort();
      g_value_unset(&value);
    }
  return 0;
}
