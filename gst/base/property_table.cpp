#include "property_table.hpp"

#include <deque>

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

}  // namespace inverse
