// Writes one Markdown page for each element of the plugin, from what the element says of itself
// (the same tables that gst-inspect-1.0 shows), with the hand-written
// docs/reference/elements/intro/<element>.md on top.
//
// usage: element-pages OUTPUT_FOLDER INTRO_FOLDER
#include <gst/gst.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>
#include <string>
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

struct Kind {
  std::string type, range, value;
};

Kind kind_of(GParamSpec* spec) {
  if (G_IS_PARAM_SPEC_FLOAT(spec)) {
    auto* s = G_PARAM_SPEC_FLOAT(spec);
    return {"float", plain(s->minimum) + " … " + plain(s->maximum), plain(s->default_value)};
  }
  if (G_IS_PARAM_SPEC_DOUBLE(spec)) {
    auto* s = G_PARAM_SPEC_DOUBLE(spec);
    return {"double", plain(s->minimum) + " … " + plain(s->maximum), plain(s->default_value)};
  }
  if (G_IS_PARAM_SPEC_INT(spec)) {
    auto* s = G_PARAM_SPEC_INT(spec);
    return {"int", plain(s->minimum) + " … " + plain(s->maximum), plain(s->default_value)};
  }
  if (G_IS_PARAM_SPEC_UINT(spec)) {
    auto* s = G_PARAM_SPEC_UINT(spec);
    if (std::string(g_param_spec_get_blurb(spec)).find("0xAARRGGBB") != std::string::npos) {
      char text[16];
      g_snprintf(text, sizeof text, "0x%08x", s->default_value);
      return {"color", "0xAARRGGBB", text};
    }
    return {"unsigned", plain(s->minimum) + " … " + plain(s->maximum), plain(s->default_value)};
  }
  if (G_IS_PARAM_SPEC_BOOLEAN(spec))
    return {"boolean", "true, false", G_PARAM_SPEC_BOOLEAN(spec)->default_value ? "true" : "false"};
  if (G_IS_PARAM_SPEC_ENUM(spec)) {
    auto* s = G_PARAM_SPEC_ENUM(spec);
    std::string values;
    for (guint i = 0; i < s->enum_class->n_values; ++i)
      values += (i ? ", " : "") + std::string(s->enum_class->values[i].value_nick);
    return {"one of", values, g_enum_get_value(s->enum_class, s->default_value)->value_nick};
  }
  if (G_IS_PARAM_SPEC_STRING(spec)) {
    const char* value = G_PARAM_SPEC_STRING(spec)->default_value;
    return {"string", "", value && *value ? value : "empty"};
  }
  return {g_type_name(spec->value_type), "", ""};
}

std::string when(GParamFlags flags) {
  if (!(flags & G_PARAM_WRITABLE)) return "read only";
  if (flags & GST_PARAM_MUTABLE_PLAYING) return "any time";
  return "before it starts";
}

void write_page(GstElementFactory* factory, std::ostream& page, const std::string& intro) {
  page << "# " << GST_OBJECT_NAME(factory) << "\n\n"
       << gst_element_factory_get_metadata(factory, GST_ELEMENT_METADATA_DESCRIPTION) << ".\n\n"
       << intro << "\n## Pads\n\n";
  // The registry keeps templates in an order of its own: what comes in first, then by name.
  std::vector<GstStaticPadTemplate*> pads;
  for (const GList* item = gst_element_factory_get_static_pad_templates(factory); item;
       item = item->next)
    pads.push_back(static_cast<GstStaticPadTemplate*>(item->data));
  std::sort(pads.begin(), pads.end(), [](const auto* a, const auto* b) {
    return a->direction != b->direction ? a->direction == GST_PAD_SINK
                                        : std::string(a->name_template) < b->name_template;
  });
  for (GstStaticPadTemplate* pad : pads) {
    static const char* kPresence[] = {"always", "sometimes", "on request"};
    page << "- `" << pad->name_template << "` (" << (pad->direction == GST_PAD_SRC ? "out" : "in")
         << ", " << kPresence[pad->presence] << ")\n";
    GstCaps* caps = gst_static_caps_get(&pad->static_caps);
    for (guint i = 0; i < gst_caps_get_size(caps); ++i) {
      gchar* features = gst_caps_features_to_string(gst_caps_get_features(caps, i));
      const GstStructure* structure = gst_caps_get_structure(caps, i);
      const GValue* format = gst_structure_get_value(structure, "format");
      gchar* formats = format ? gst_value_serialize(format) : g_strdup("any");
      page << "  - `" << gst_structure_get_name(structure) << "(" << features << ")`: " << formats
           << "\n";
      g_free(formats);
      g_free(features);
    }
    gst_caps_unref(caps);
  }
  GstElement* element = gst_element_factory_create(factory, nullptr);
  guint count = 0;
  GParamSpec** specs = g_object_class_list_properties(G_OBJECT_GET_CLASS(element), &count);
  page << "\n## Properties\n\n| property | type | values | default | changes | meaning "
          "|\n|---|---|---|---|---|---|\n";
  std::ostringstream choices;
  for (guint i = 0; i < count; ++i) {
    GParamSpec* spec = specs[i];
    if (spec->owner_type == GST_TYPE_OBJECT || spec->owner_type == GST_TYPE_ELEMENT ||
        g_strcmp0(g_type_name(spec->owner_type), "GstBaseTransform") == 0 ||
        g_strcmp0(g_type_name(spec->owner_type), "GstBaseSrc") == 0)
      continue;
    const Kind kind = kind_of(spec);
    page << "| `" << spec->name << "` | " << kind.type << " | " << cell(kind.range) << " | "
         << cell(kind.value) << " | " << when(spec->flags) << " | "
         << cell(g_param_spec_get_blurb(spec)) << " |\n";
    if (G_IS_PARAM_SPEC_ENUM(spec)) {
      choices << "\n`" << spec->name << "`:\n";
      auto* values = G_PARAM_SPEC_ENUM(spec)->enum_class;
      for (guint k = 0; k < values->n_values; ++k)
        choices << "- `" << values->values[k].value_nick << "`: " << values->values[k].value_name
                << "\n";
    }
  }
  page << choices.str();
  g_free(specs);
  gst_object_unref(element);
}

}  // namespace

int main(int count, char** arguments) {
  gst_init(&count, &arguments);
  if (count != 3) {
    std::cerr << "usage: element-pages OUTPUT_FOLDER INTRO_FOLDER\n";
    return 2;
  }
  const std::filesystem::path output = arguments[1], intros = arguments[2];
  std::filesystem::create_directories(output);
  GList* features = nullptr;
  for (const char* plugin : {"inverse", "inversemesh", "inversestage"}) {
    GList* own = gst_registry_get_feature_list_by_plugin(gst_registry_get(), plugin);
    if (!own) {
      std::cerr << "the plugin " << plugin << " is not on GST_PLUGIN_PATH\n";
      return 1;
    }
    features = g_list_concat(features, own);
  }
  for (GList* item = features; item; item = item->next) {
    auto* factory = GST_ELEMENT_FACTORY(gst_plugin_feature_load(GST_PLUGIN_FEATURE(item->data)));
    const std::string name = GST_OBJECT_NAME(factory);
    std::ifstream intro(intros / (name + ".md"));
    if (!intro) {
      std::cerr << "no " << (intros / (name + ".md")) << "\n";
      return 1;
    }
    std::stringstream text;
    text << intro.rdbuf();
    std::ofstream page(output / (name + ".md"));
    write_page(factory, page, text.str());
    gst_object_unref(factory);
  }
  gst_plugin_feature_list_free(features);
  return 0;
}
