// SPDX-License-Identifier: LGPL-2.1-or-later
// Streams put together from everything that is listed as bad input for an element: seeded, and
// shrunk to the fewest steps that fail. A frame comes out for every frame, or one clear error says
// why not.
#include <optional>

#include "tests/elements/element_test.hpp"

namespace inverse::testing {
namespace {

constexpr const char* kFormats[] = {"RGBA",  "BGRA",      "RGBx",      "BGRx",     "RGB",
                                    "BGR",   "NV12",      "I420",      "YUY2",     "UYVY",
                                    "GRAY8", "P010_10LE", "I420_10LE", "RGBA64_LE"};

enum class Step : uint8_t {
  frame,
  black_frame,
  white_frame,
  caps,
  strange_colorimetry,
  flush,
  property,
  // What may end the stream, with one error:
  short_buffer,
  interlaced,
  unsupported_transfer,
  kinds
};

struct Planned {
  Step step;
  uint32_t draw;  ///< all that is random about it
};

std::string text_of(const std::vector<Planned>& plan) {
  constexpr const char* kNames[] = {
      "frame", "black",    "white", "caps",       "strange colorimetry",
      "flush", "property", "short", "interlaced", "PQ"};
  static_assert(std::size(kNames) == static_cast<size_t>(Step::kinds));
  std::string text;
  for (const Planned& one : plan)
    text += (text.empty() ? "" : ", ") + std::string(kNames[static_cast<size_t>(one.step)]) + ":" +
            std::to_string(one.draw);
  return text;
}

std::vector<Planned> random_plan(uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<Planned> plan;
  for (int i = 0; i < 14; ++i) {
    auto step = static_cast<Step>(random() % static_cast<uint32_t>(Step::kinds));
    if (step >= Step::short_buffer && random() % 3) step = Step::frame;  // most streams go on
    plan.push_back({step, static_cast<uint32_t>(random() % 100000)});
  }
  plan.push_back({Step::frame, 1});
  return plan;
}

/// Sets one of the properties of an element or of its children to a value at or between the ends of
/// its range.
void set_any_property(GstElement* of, uint32_t draw) {
  struct Own {
    GObject* object;
    GParamSpec* spec;
  };
  std::vector<Own> own;
  const auto add = [&own](GObject* object) {
    guint count = 0;
    GParamSpec** specs = g_object_class_list_properties(G_OBJECT_GET_CLASS(object), &count);
    for (guint i = 0; i < count; ++i) {
      const GType type = G_PARAM_SPEC_VALUE_TYPE(specs[i]);
      const bool number = type == G_TYPE_FLOAT || type == G_TYPE_DOUBLE || type == G_TYPE_INT ||
                          type == G_TYPE_UINT || type == G_TYPE_BOOLEAN || G_TYPE_IS_ENUM(type);
      if (number && (specs[i]->flags & G_PARAM_WRITABLE) &&
          specs[i]->owner_type != GST_TYPE_ELEMENT && !(specs[i]->flags & G_PARAM_CONSTRUCT_ONLY))
        own.push_back({object, specs[i]});
    }
    g_free(specs);
  };
  add(G_OBJECT(of));
  if (GST_IS_CHILD_PROXY(of) && !GST_IS_BIN(of))
    for (guint i = 0; i < gst_child_proxy_get_children_count(GST_CHILD_PROXY(of)); ++i) {
      GObject* child = gst_child_proxy_get_child_by_index(GST_CHILD_PROXY(of), i);
      add(child);
      g_object_unref(child);  // the element keeps it
    }
  const auto [element, spec] = own[draw % own.size()];
  const std::string name = spec->name;
  // Absurdly many iterations are only slow.
  const bool work = name.find("iterations") != std::string::npos ||
                    name.find("cycles") != std::string::npos || name == "samples";
  const bool high = draw / 97 % 2;
  const GType type = G_PARAM_SPEC_VALUE_TYPE(spec);
  if (type == G_TYPE_FLOAT) {
    auto* range = G_PARAM_SPEC_FLOAT(spec);
    g_object_set(element, spec->name, static_cast<double>(high ? range->maximum : range->minimum),
                 nullptr);
  } else if (type == G_TYPE_DOUBLE) {
    auto* range = G_PARAM_SPEC_DOUBLE(spec);
    g_object_set(element, spec->name, high ? range->maximum : range->minimum, nullptr);
  } else if (type == G_TYPE_INT) {
    auto* range = G_PARAM_SPEC_INT(spec);
    g_object_set(element, spec->name,
                 high ? (work ? std::min(range->maximum, 12) : range->maximum) : range->minimum,
                 nullptr);
  } else if (type == G_TYPE_UINT) {
    auto* range = G_PARAM_SPEC_UINT(spec);
    g_object_set(element, spec->name,
                 high ? (work ? std::min(range->maximum, 12U) : range->maximum) : range->minimum,
                 nullptr);
  } else if (type == G_TYPE_BOOLEAN) {
    g_object_set(element, spec->name, high, nullptr);
  } else {
    auto* values = G_PARAM_SPEC_ENUM(spec)->enum_class;
    g_object_set(element, spec->name, values->values[draw / 97 % values->n_values].value, nullptr);
  }
}

/// How many bytes the frame that comes out has to have.
size_t expected_size(VideoHarness& harness) {
  GstCaps* caps = gst_pad_get_current_caps(harness.harness()->sinkpad);
  GstVideoInfo info;
  const bool known = caps && gst_video_info_from_caps(&info, caps);
  if (caps) gst_caps_unref(caps);
  return known ? GST_VIDEO_INFO_SIZE(&info) : 0;
}

/// How streams ended, so that a test can say that it saw both ends.
struct Ends {
  unsigned frames = 0, errors = 0;
};

/// What is wrong with how an element takes these steps, or nothing.
std::optional<std::string> wrong(const std::string& factory, const std::vector<Planned>& plan,
                                 Ends& ends) {
  std::string caps = VideoHarness::caps("RGBA", 24, 18);
  VideoHarness harness(factory, caps);
  for (const Planned& planned : plan) {
    std::vector<uint8_t> frame;
    bool may_fail = false;
    const auto next_caps = [&](const std::string& more) {
      const bool gray_or_rgb = !more.empty() && more.find("interlace") == std::string::npos;
      caps = VideoHarness::caps(gray_or_rgb ? "P010_10LE" : kFormats[planned.draw % 14],
                                static_cast<int>(1 + planned.draw / 14 % 37),
                                static_cast<int>(1 + planned.draw / 518 % 29), more);
      harness.set_src_caps(caps);
    };
    switch (planned.step) {
      case Step::frame:
        frame = random_frame(caps, planned.draw);
        break;
      case Step::black_frame:
        frame = flat_frame(caps, 0);
        break;
      case Step::white_frame:
        frame = flat_frame(caps, 255);
        break;
      case Step::caps:
        next_caps("");
        break;
      case Step::strange_colorimetry:
        next_caps(planned.draw % 2 ? "colorimetry=(string)0:0:0:0"
                                   : "colorimetry=(string)2:4:16:3");
        may_fail = true;
        frame = random_frame(caps, planned.draw);
        break;
      case Step::flush:
        harness.flush();
        break;
      case Step::property:
        set_any_property(harness.find(factory), planned.draw);
        break;
      case Step::short_buffer:
        frame = random_frame(caps, planned.draw);
        frame.resize(planned.draw % frame.size());
        if (frame.empty()) frame.resize(1);
        may_fail = true;
        break;
      case Step::interlaced:
        next_caps("interlace-mode=(string)interleaved");
        frame = random_frame(caps, planned.draw);
        may_fail = true;
        break;
      case Step::unsupported_transfer:
        next_caps("colorimetry=(string)bt2100-pq");
        frame = random_frame(caps, planned.draw);
        may_fail = true;
        break;
      case Step::kinds:
        break;
    }
    if (frame.empty()) continue;
    const GstFlowReturn flow = harness.push(frame);
    const auto errors = harness.errors();
    if (flow != GST_FLOW_OK) {
      if (!may_fail)
        return "a good frame ends in " + std::string(gst_flow_get_name(flow)) +
               (errors.empty() ? "" : ": " + errors[0]);
      if (errors.size() != 1) return std::to_string(errors.size()) + " errors for one cause";
      if (errors[0].size() < 40) return "an error that says little: " + errors[0];
      ++ends.errors;
      return {};
    }
    if (!errors.empty()) return "an error, and the stream goes on: " + errors[0];
    const auto shown = harness.pull();
    if (shown.empty()) return "no frame comes out";
    if (shown.size() != expected_size(harness))
      return "a frame of " + std::to_string(shown.size()) + " bytes comes out, not of " +
             std::to_string(expected_size(harness));
    ++ends.frames;
  }
  return {};
}

class StreamMixtures : public ::testing::TestWithParam<const char*> {};

TEST_P(StreamMixtures, GiveAFrameForAFrameOrOneClearError) {
  Ends ends;
  for (uint32_t seed = 1; seed <= 20; ++seed) {
    std::vector<Planned> plan = random_plan(seed);
    auto reason = wrong(GetParam(), plan, ends);
    if (!reason) continue;
    // Remove every step that the failure does not need.
    for (size_t i = plan.size(); i-- > 0;) {
      std::vector<Planned> fewer;
      for (size_t k = 0; k < plan.size(); ++k)
        if (k != i) fewer.push_back(plan[k]);
      if (const auto still = wrong(GetParam(), fewer, ends)) {
        plan = fewer;
        reason = still;
      }
    }
    FAIL() << "seed " << seed << " shrinks to " << text_of(plan) << ": " << *reason;
  }
  EXPECT_GT(ends.frames, 50U);
  EXPECT_GT(ends.errors, 5U);
}

INSTANTIATE_TEST_SUITE_P(All, StreamMixtures,
                         ::testing::Values("intrinsicdecomp", "intrinsicdecompthesis",
                                           "globalintrinsic", "globalintrinsicthesis"),
                         [](const auto& info) { return std::string(info.param); });

}  // namespace
}  // namespace inverse::testing
