// SPDX-License-Identifier: LGPL-2.1-or-later
// GstPreset: what is shipped, and what is saved.
#include <cstdlib>
#include <filesystem>
#include <set>

#include "tests/elements/edit/edit_fixture.hpp"

namespace inverse::testing {
namespace {

namespace fs = std::filesystem;

using Element = std::unique_ptr<GstElement, void (*)(gpointer)>;

Element make(const char* factory) {
  GstElement* element = gst_element_factory_make(factory, nullptr);
  return {element ? GST_ELEMENT(gst_object_ref_sink(element)) : nullptr, gst_object_unref};
}

std::set<std::string> take_names(gchar** names) {
  std::set<std::string> result;
  for (gchar** name = names; name && *name; ++name) result.insert(*name);
  g_strfreev(names);
  return result;
}

std::set<std::string> presets_of(const Element& element) {
  return take_names(gst_preset_get_preset_names(GST_PRESET(element.get())));
}

/// A property's value as a launch line takes it.
std::string value_of(GstElement* element, const std::string& name) {
  GParamSpec* spec = g_object_class_find_property(G_OBJECT_GET_CLASS(element), name.c_str());
  if (!spec) return "no such property";
  GValue value = G_VALUE_INIT;
  g_value_init(&value, spec->value_type);
  g_object_get_property(G_OBJECT(element), name.c_str(), &value);
  gchar* text = gst_value_serialize(&value);
  const std::string result = text ? text : "";
  g_free(text);
  g_value_unset(&value);
  return result;
}

struct Shipped {
  const char* factory;
  std::set<std::string> names;
};
const std::vector<Shipped> kShipped{
    {"intrinsictone", {"velvet", "shiny", "metal", "matte", "even-light", "film-noir"}},
    {"intrinsicstylize", {"cartoon", "ink", "pencil", "poster"}},
    {"intrinsicdespill", {"green-screen", "blue-screen"}},
    {"intrinsickey", {"green-screen", "blue-screen"}},
};

}  // namespace

TEST(Presets, EveryFilterHasTheInterfaceAndSavesItsParametersAlone) {
  for (const char* factory :
       {"intrinsicdecomp", "globalintrinsic", "intrinsicrecolor", "intrinsickey",
        "intrinsicdespill", "intrinsictone", "intrinsicstylize", "intrinsicrelight",
        "intrinsiccompose", "limematerial"}) {
    const Element element = make(factory);
    ASSERT_TRUE(element && GST_IS_PRESET(element.get())) << factory;
    const auto names = take_names(gst_preset_get_property_names(GST_PRESET(element.get())));
    EXPECT_FALSE(names.empty()) << factory;
    for (const char* other : {"name", "parent", "qos", "device", "stats"})
      EXPECT_FALSE(names.contains(other)) << factory << " " << other;
    guint count = 0;
    GParamSpec** specs = g_object_class_list_properties(G_OBJECT_GET_CLASS(element.get()), &count);
    for (guint i = 0; i < count; ++i) {
      const bool own = specs[i]->owner_type == G_OBJECT_TYPE(element.get()) &&
                       (specs[i]->flags & G_PARAM_WRITABLE) &&
                       specs[i]->name != std::string("device");
      EXPECT_EQ(names.contains(specs[i]->name), own) << factory << " " << specs[i]->name;
    }
    g_free(specs);
  }
}

TEST(Presets, ShippedOnesAreFoundAndSetWhatTheySay) {
  const char* folder = std::getenv("GST_PRESET_PATH");
  ASSERT_NE(folder, nullptr) << "set it to gst/edit/presets";
  for (const auto& [factory, expected] : kShipped) {
    const Element element = make(factory);
    ASSERT_TRUE(element);
    const auto names = presets_of(element);
    for (const std::string& name : expected) {
      ASSERT_TRUE(names.contains(name)) << factory << " " << name;
      gchar* comment = nullptr;
      EXPECT_TRUE(gst_preset_get_meta(GST_PRESET(element.get()), name.c_str(), "comment", &comment))
          << factory << " " << name;
      g_free(comment);
    }
    // The file, read by other means.
    const fs::path file =
        fs::path(folder) / (std::string(G_OBJECT_TYPE_NAME(element.get())) + ".prs");
    GKeyFile* keys = g_key_file_new();
    ASSERT_TRUE(g_key_file_load_from_file(keys, file.c_str(), G_KEY_FILE_NONE, nullptr)) << file;
    gchar** groups = g_key_file_get_groups(keys, nullptr);
    for (gchar** group = groups; *group; ++group) {
      if (std::string(*group) == "_presets_") continue;
      EXPECT_TRUE(expected.contains(*group)) << *group << " is not listed here";
      ASSERT_TRUE(gst_preset_load_preset(GST_PRESET(element.get()), *group)) << *group;
      gchar** entries = g_key_file_get_keys(keys, *group, nullptr, nullptr);
      for (gchar** entry = entries; *entry; ++entry) {
        if (std::string(*entry).starts_with("_meta/")) continue;
        gchar* text = g_key_file_get_value(keys, *group, *entry, nullptr);
        const Element wanted = make(factory);
        gst_util_set_object_arg(G_OBJECT(wanted.get()), *entry, text);
        EXPECT_EQ(value_of(element.get(), *entry), value_of(wanted.get(), *entry))
            << factory << " " << *group << " " << *entry << "=" << text;
        g_free(text);
      }
      g_strfreev(entries);
    }
    g_strfreev(groups);
    g_key_file_unref(keys);
  }
}

TEST(Presets, ALaunchLineTakesThem) {
  const std::string source =
      "videotestsrc num-buffers=2 pattern=ball ! video/x-raw,format=RGBA,width=64,height=48 ! "
      "intrinsicdecomp ! ";
  const std::string sink = " ! intrinsiccompose ! appsink name=out";
  const auto preset = run_line(source + "intrinsictone @preset=metal" + sink);
  const auto set = run_line(source + "intrinsictone look=metal" + sink);
  const auto plain = run_line(source + "intrinsictone" + sink);
  ASSERT_TRUE(preset.eos && set.eos && plain.eos) << preset.first_error();
  EXPECT_EQ(preset.frames, set.frames);
  EXPECT_NE(preset.frames, plain.frames);
  const auto unknown = run_line(source + "intrinsictone @preset=nosuch" + sink);
  expect_contains(unknown.first_error(), "could not set preset");
}

TEST(Presets, ALoadedPresetActsWhilePlaying) {
  const std::string caps = VideoHarness::caps("RGBA", 96, 64);
  const auto frame = lit_paints(96, 64);
  VideoHarness harness("intrinsicdecomp ! intrinsictone ! intrinsiccompose", caps, caps);
  EXPECT_LE(largest_difference(harness.process(frame), frame), 1);
  ASSERT_TRUE(gst_preset_load_preset(GST_PRESET(harness.find("intrinsictone")), "film-noir"));
  EXPECT_GT(largest_difference(harness.process(frame), frame), 20);
  EXPECT_FALSE(gst_preset_load_preset(GST_PRESET(harness.find("intrinsictone")), "no such"));
  EXPECT_TRUE(harness.warnings().empty());
}

TEST(Presets, AUsersPresetIsSavedAndLoaded) {
  // Its texts must be free of what GStreamer 1.22 escapes twice: commas, spaces, quotes.
  const Element element = make("intrinsictone");
  const std::string name = "a test of gst-inverse";
  g_object_set(element.get(), "curve", "-3:-2/0:1/2:2.5", "strength", .25F, "use-mask", FALSE,
               nullptr);
  ASSERT_TRUE(gst_preset_save_preset(GST_PRESET(element.get()), name.c_str()));
  const Element other = make("intrinsictone");
  EXPECT_TRUE(gst_preset_load_preset(GST_PRESET(other.get()), name.c_str()));
  EXPECT_TRUE(gst_preset_delete_preset(GST_PRESET(element.get()), name.c_str()));
  for (const char* property : {"curve", "strength", "use-mask", "look", "middle"})
    EXPECT_EQ(value_of(other.get(), property), value_of(element.get(), property)) << property;
}

TEST(Presets, PropertiesOfChildrenAreSavedAndLoaded) {
  const Element element = make("intrinsicdecomp"), other = make("intrinsicdecomp");
  const std::string name = "another test of gst-inverse";
  set_text(element.get(), "strokes::radius", "31");
  set_text(element.get(), "strokes::mode", "erase");
  ASSERT_TRUE(gst_preset_save_preset(GST_PRESET(element.get()), name.c_str()));
  EXPECT_TRUE(gst_preset_load_preset(GST_PRESET(other.get()), name.c_str()));
  EXPECT_TRUE(gst_preset_delete_preset(GST_PRESET(element.get()), name.c_str()));
  EXPECT_EQ(property<float>(other.get(), "strokes::radius"), 31);
  EXPECT_EQ(property<int>(other.get(), "strokes::mode"),
            property<int>(element.get(), "strokes::mode"));
}

}  // namespace inverse::testing
