// SPDX-License-Identifier: LGPL-2.1-or-later
// Writes the elements' pages for the manual: docs/reference/elements/ELEMENT.md, then tables of its
// pads and properties, as gst-inspect-1.0 shows them. Fails if an element has no page, or if a
// plugin of ours in a folder of GST_PLUGIN_PATH cannot be loaded.
//
// usage: element-pages OUTPUT_FOLDER PAGES_FOLDER
#include <gst/gst.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace {

/// Text for a cell of a Markdown table.
std::string cell(std::string text) {
  for (size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2)
    text.insert(at, 1, 0x5c);
  return text;
}

template <typename T>
std::string plain(T value) {
  std::ostringstream text;
  text.precision(7);
  text << value;
  return text.str();
}

/// "0…1 (0.5)": range and default of a property.
template <typename Spec>
std::string range(const Spec* spec) {
  return plain(spec->minimum) + "…" + plain(spec->maximum) + " (" + plain(spec->default_value) +
         ")";
}

std::string values_of(GParamSpec* spec) {
  if (G_IS_PARAM_SPEC_FLOAT(spec)) return range(G_PARAM_SPEC_FLOAT(spec));
  if (G_IS_PARAM_SPEC_DOUBLE(spec)) return range(G_PARAM_SPEC_DOUBLE(spec));
  if (G_IS_PARAM_SPEC_INT(spec)) return range(G_PARAM_SPEC_INT(spec));
  if (G_IS_PARAM_SPEC_UINT(spec)) {
    auto* s = G_PARAM_SPEC_UINT(spec);
    if (std::string(g_param_spec_get_blurb(spec)).find("0xAARRGGBB") == std::string::npos)
      return range(s);
    char text[32];
    g_snprintf(text, sizeof text, "color (0x%08x)", s->default_value);
    return text;
  }
  if (G_IS_PARAM_SPEC_BOOLEAN(spec))
    return G_PARAM_SPEC_BOOLEAN(spec)->default_value ? "boolean (true)" : "boolean (false)";
  if (G_IS_PARAM_SPEC_ENUM(spec)) {
    auto* s = G_PARAM_SPEC_ENUM(spec);
    std::string values;
    for (guint i = 0; i < s->enum_class->n_values; ++i)
      values += (i ? ", " : "") + std::string(s->enum_class->values[i].value_nick);
    return values + " (" + g_enum_get_value(s->enum_class, s->default_value)->value_nick + ")";
  }
  if (G_IS_PARAM_SPEC_STRING(spec)) {
    const char* value = G_PARAM_SPEC_STRING(spec)->default_value;
    return value && *value ? "text (" + std::string(value) + ")" : "text";
  }
  return g_type_name(spec->value_type);
}

/// When a property can be set; each case has a table.
std::string when(GParamFlags flags) {
  if (!(flags & G_PARAM_WRITABLE)) return "Read only";
  if (flags & GST_PARAM_MUTABLE_PLAYING) return "At any time";
  return "Before the element starts";
}

/// The formats of a caps structure, separated by ", ".
std::string formats_of(const GstStructure* structure) {
  const GValue* format = gst_structure_get_value(structure, "format");
  if (!format) return "any";
  gchar* text = gst_value_serialize(format);
  const std::string formats =
      std::regex_replace(std::string(text), std::regex("\\(string\\)|[{}]"), "");
  g_free(text);
  const size_t first = formats.find_first_not_of(' ');
  return formats.substr(first, formats.find_last_not_of(' ') + 1 - first);
}

/// A list's words in alphabetical order, so that lists of the same words are equal.
std::multiset<std::string> sorted_words(const std::string& list) {
  std::istringstream words(list + ",");
  std::multiset<std::string> sorted;
  for (std::string word; words >> word;) sorted.insert(word);
  return sorted;
}

/// Adds an object's properties to the table for when they can be set, and what their values mean.
/// `child`: "strokes::" of a child object.
void add_properties(GObject* object, const std::string& child,
                    std::map<std::string, std::string>& tables, std::ostream& choices) {
  guint count = 0;
  GParamSpec** specs = g_object_class_list_properties(G_OBJECT_GET_CLASS(object), &count);
  for (guint i = 0; i < count; ++i) {
    GParamSpec* spec = specs[i];
    if (spec->owner_type == GST_TYPE_OBJECT || spec->owner_type == GST_TYPE_ELEMENT ||
        g_strcmp0(g_type_name(spec->owner_type), "GstBaseTransform") == 0 ||
        g_strcmp0(g_type_name(spec->owner_type), "GstBaseSrc") == 0)
      continue;
    tables[when(spec->flags)] += "| `" + child + spec->name + "` | " + cell(values_of(spec)) +
                                 " | " + cell(g_param_spec_get_blurb(spec)) + " |\n";
    if (G_IS_PARAM_SPEC_ENUM(spec)) {
      choices << "\n`" << child << spec->name << "`:\n";
      auto* values = G_PARAM_SPEC_ENUM(spec)->enum_class;
      for (guint k = 0; k < values->n_values; ++k)
        choices << "- `" << values->values[k].value_nick << "`: " << values->values[k].value_name
                << "\n";
    }
  }
  g_free(specs);
}

void write_tables(GstElementFactory* factory, std::ostream& page) {
  page << "\n## Pads\n\n";
  // The order of templates in the registry is arbitrary: sort by direction, then by name.
  std::vector<GstStaticPadTemplate*> pads;
  for (const GList* item = gst_element_factory_get_static_pad_templates(factory); item;
       item = item->next)
    pads.push_back(static_cast<GstStaticPadTemplate*>(item->data));
  std::sort(pads.begin(), pads.end(), [](const auto* a, const auto* b) {
    return a->direction != b->direction ? a->direction == GST_PAD_SINK
                                        : std::string(a->name_template) < b->name_template;
  });
  std::set<std::multiset<std::string>> listed;
  std::vector<std::pair<std::string, std::string>> entries;  // names, what they have in common
  for (GstStaticPadTemplate* pad : pads) {
    static const char* kPresence[] = {"always", "sometimes", "on request"};
    std::ostringstream text;
    text << " (" << (pad->direction == GST_PAD_SRC ? "out" : "in") << ", "
         << kPresence[pad->presence] << ")\n";
    GstCaps* caps = gst_static_caps_get(&pad->static_caps);
    for (guint i = 0; i < gst_caps_get_size(caps); ++i) {
      gchar* features = gst_caps_features_to_string(gst_caps_get_features(caps, i));
      const GstStructure* structure = gst_caps_get_structure(caps, i);
      const std::string formats = formats_of(structure);
      const bool known =
          formats.find(',') != std::string::npos && !listed.insert(sorted_words(formats)).second;
      text << "  - `" << gst_structure_get_name(structure) << "(" << features
           << ")`: " << (known ? "the same formats" : formats) << "\n";
      g_free(features);
    }
    gst_caps_unref(caps);
    const std::string name = "`" + std::string(pad->name_template) + "`";
    if (!entries.empty() && entries.back().second == text.str())
      entries.back().first += ", " + name;
    else
      entries.emplace_back(name, text.str());
  }
  for (const auto& [names, text] : entries) page << "- " << names << text;
  GstElement* element = gst_element_factory_create(factory, nullptr);
  page << "\n## Properties\n";
  std::map<std::string, std::string> tables;
  std::ostringstream choices;
  add_properties(G_OBJECT(element), "", tables, choices);
  if (GST_IS_CHILD_PROXY(element) && !GST_IS_BIN(element))
    for (guint i = 0; i < gst_child_proxy_get_children_count(GST_CHILD_PROXY(element)); ++i) {
      GObject* child = gst_child_proxy_get_child_by_index(GST_CHILD_PROXY(element), i);
      add_properties(child, std::string(GST_OBJECT_NAME(child)) + "::", tables, choices);
      g_object_unref(child);
    }
  for (const auto& [title, rows] : tables)
    page << "\n"
         << title << ":\n\n| property | values (default) | meaning |\n|---|---|---|\n"
         << rows;
  page << choices.str();
  if (const char* tuning = gst_element_factory_get_metadata(factory, "Tuning")) {
    page << "\nNames of `tuning`:\n\n| name | values (default) | meaning |\n|---|---|---|\n";
    // "name: values (default): meaning"
    const std::regex entry("([^:]+): (.*\\)|text): (.*)");
    std::istringstream lines(tuning);
    std::smatch parts;
    for (std::string line; std::getline(lines, line);)
      if (std::regex_match(line, parts, entry))
        page << "| `" << parts[1].str() << "` | " << cell(parts[2].str()) << " | "
             << cell(parts[3].str()) << " |\n";
  }
  gst_object_unref(element);
}

/// The plugins of this project in the folders of GST_PLUGIN_PATH.
std::vector<std::filesystem::path> plugin_files() {
  std::vector<std::filesystem::path> files;
  std::istringstream folders(g_getenv("GST_PLUGIN_PATH") ? g_getenv("GST_PLUGIN_PATH") : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    std::error_code no_folder;
    for (const auto& file : std::filesystem::directory_iterator(folder, no_folder))
      if (file.path().filename().string().starts_with("libgstinverse") &&
          file.path().extension() == ".so")
        files.push_back(file.path());
  }
  return files;
}

/// Writes an element's page with its tables; returns what went wrong, or nothing.
std::string write_page(GstElementFactory* factory, const std::filesystem::path& pages,
                       const std::filesystem::path& output) {
  const std::string name = GST_OBJECT_NAME(factory), file = name + ".md";
  std::ifstream input(pages / file);
  if (!input) return "no " + (pages / file).string();
  std::stringstream text;
  text << input.rdbuf();
  if (!text.str().starts_with("# " + name + "\n"))
    return (pages / file).string() + " does not begin with \"# " + name + "\"";
  std::ofstream page(output / file);
  page << text.str();
  write_tables(factory, page);
  page.close();
  return page ? "" : "cannot write " + (output / file).string();
}

}  // namespace

int main(int count, char** arguments) {
  gst_init(&count, &arguments);
  if (count != 3) {
    std::cerr << "usage: element-pages OUTPUT_FOLDER PAGES_FOLDER\n";
    return 2;
  }
  const std::filesystem::path output = arguments[1], pages = arguments[2];
  std::filesystem::create_directories(output);
  size_t written = 0, failed = 0;
  for (const std::filesystem::path& file : plugin_files()) {
    GError* error = nullptr;
    GstPlugin* plugin = gst_plugin_load_file(file.c_str(), &error);
    if (!plugin) {
      std::cerr << file << ": " << error->message << "\n";
      g_clear_error(&error);
      ++failed;
      continue;
    }
    GList* features =
        gst_registry_get_feature_list_by_plugin(gst_registry_get(), gst_plugin_get_name(plugin));
    for (GList* item = features; item; item = item->next) {
      if (!GST_IS_ELEMENT_FACTORY(item->data)) continue;
      GstPluginFeature* factory = gst_plugin_feature_load(GST_PLUGIN_FEATURE(item->data));
      const std::string wrong = write_page(GST_ELEMENT_FACTORY(factory), pages, output);
      gst_object_unref(factory);
      if (wrong.empty()) {
        ++written;
        continue;
      }
      std::cerr << wrong << "\n";
      ++failed;
    }
    gst_plugin_feature_list_free(features);
    gst_object_unref(plugin);
  }
  if (written == 0) std::cerr << "GST_PLUGIN_PATH has no element of ours\n";
  return written == 0 || failed > 0;
}
