// SPDX-License-Identifier: LGPL-2.1-or-later
// memory:VulkanImage: whole lines with GStreamer's own Vulkan elements, on one device.
#include <gst/app/gstappsrc.h>

#include <memory>

#include "tests/elements/element_test.hpp"
#include "tests/has_element.hpp"
#include "tests/material/kernels/lime_models.hpp"
#include "tests/pipeline.hpp"
#include "vulkan_listener.hpp"

namespace inverse::testing {
namespace {

/// Runs a line; under INVERSE_VALIDATION=1 the validation layer must have nothing to say of it.
LineResult run(const std::string& line, std::function<void(GstElement*)> prepare = {}) {
  LineResult result = run_line(line, 120, [&](GstElement* pipeline) {
    if (Listener::is_wanted()) Listener::get().attach(pipeline);
    if (prepare) prepare(pipeline);
  });
  if (Listener::is_wanted()) Listener::get().report();
  return result;
}

std::string source(const std::string& caps, const std::string& pattern = "smpte", int frames = 3) {
  return "videotestsrc num-buffers=" + std::to_string(frames) + " pattern=" + pattern + " ! " +
         caps + " ! ";
}

/// Both lines give the same frames, within one code value.
void expect_same(const std::string& system, const std::string& images) {
  const LineResult a = run(system), b = run(images);
  ASSERT_TRUE(a.errors.empty()) << a.first_error() << "\n" << system;
  ASSERT_TRUE(b.errors.empty()) << b.first_error() << "\n" << images;
  ASSERT_EQ(a.frames.size(), b.frames.size()) << images;
  ASSERT_FALSE(a.frames.empty()) << images;
  for (size_t i = 0; i < a.frames.size(); ++i)
    EXPECT_LE(largest_difference(visible(a.info, a.frames[i]), visible(a.info, b.frames[i])), 1)
        << images << ", frame " << i;
}

/// What stands at a pad as the context `type`; null if nothing does. Borrowed.
template <typename T>
T* shared(GstElement* pipeline, const char* element, const char* pad, const char* type) {
  GstPad* at = gst_element_get_static_pad(find_element(pipeline, element), pad);
  GstQuery* query = gst_query_new_context(type);
  T* object = nullptr;
  if (gst_pad_query(at, query)) {
    GstContext* context = nullptr;
    gst_query_parse_context(query, &context);
    const GValue* value = gst_structure_get_value(gst_context_get_structure(context), type);
    object = value ? static_cast<T*>(g_value_get_object(value)) : nullptr;
  }
  gst_query_unref(query);
  gst_object_unref(at);
  return object;
}

/// The listener's end, which comes after the pipeline's.
struct Report {
  ~Report() {
    if (Listener::is_wanted()) Listener::get().report();
  }
};

struct WatchedPipeline : Report, Pipeline {
  explicit WatchedPipeline(const std::string& line) : Pipeline(line) {
    if (Listener::is_wanted()) Listener::get().attach(get());
  }
};

class VulkanMemory : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!has_element("vulkanupload")) GTEST_SKIP() << "GStreamer's Vulkan plugin is not installed";
  }
};

constexpr const char* kFormats[] = {"RGBA", "BGRA"};
constexpr std::pair<int, int> kSizes[] = {{15, 10}, {349, 287}, {64, 48}, {1, 1}};

}  // namespace

TEST_F(VulkanMemory, InAndOutGiveTheSameFramesAsSystemMemory) {
  bool input = false;
  for (const char* format : kFormats) {
    for (const auto& [width, height] : kSizes) {
      const std::string caps = VideoHarness::caps(format, width, height);
      const std::string element =
          std::string("intrinsicdecomp show=") + (input ? "input" : "reflectance");
      input = !input;
      expect_same(
          source(caps) + element + " ! " + caps + " ! appsink name=out",
          source(caps) + "vulkanupload ! " + element + " ! vulkandownload ! appsink name=out");
    }
    input = !input;  // each size shows both
  }
}

TEST_F(VulkanMemory, AlphaAndTransferCurveCarryOver) {
  // GStreamer makes SRGB images of what is not sRGB, and UNORM ones of what is.
  for (const char* format : kFormats)
    for (const char* colorimetry : {"sRGB", "1:1:5:1"}) {
      const std::string caps =
          VideoHarness::caps(format, 33, 21, std::string("colorimetry=(string)") + colorimetry);
      const std::string pattern = "solid-color foreground-color=0x4012a0f3";
      expect_same(source(caps, pattern) + "appsink name=out",
                  source(caps, pattern) +
                      "vulkanupload ! intrinsicdecomp show=input ! vulkandownload ! " + caps +
                      " ! appsink name=out");
    }
}

TEST_F(VulkanMemory, MaterialsAndClonesAreTheSame) {
  if (!has_element("materialclone")) GTEST_SKIP() << "built without Assimp or OpenEXR";
  const HandMadeLime networks;
  const std::string red = source(VideoHarness::caps("RGBA", 64, 48), "red", 16),
                    lime = "limematerial estimate-light=true models=" + networks.folder(),
                    clone = "materialclone size=0.5";
  const auto last = [&](const std::string& line) {
    const LineResult result = run(red + line + " ! appsink name=out");
    EXPECT_TRUE(result.errors.empty()) << result.first_error() << "\n" << line;
    EXPECT_EQ(result.frames.size(), 16u) << line;
    return result.frames.empty() ? std::vector<uint8_t>{} : result.frames.back();
  };
  const std::string out = " ! " + VideoHarness::caps("RGBA", 64, 48);
  const auto expected = last(lime + " ! " + clone + out);
  EXPECT_NE(expected, last(lime + out)) << "the clone is seen";
  // Results follow some frames later here: those of the last are there in any case.
  EXPECT_LE(largest_difference(last("vulkanupload ! " + lime + " ! " + clone + " ! vulkandownload"),
                               expected),
            1);
  EXPECT_LE(largest_difference(last("vulkanupload ! " + lime + " ! " + clone + out), expected), 1);
  EXPECT_LE(largest_difference(last(lime + " ! " + clone + " ! vulkandownload"), expected), 1);
}

TEST_F(VulkanMemory, InputAndOutputAreIndependent) {
  const std::string rgba = VideoHarness::caps("RGBA", 61, 43);
  const std::string i420 = VideoHarness::caps("I420", 61, 43);
  const std::string element = "intrinsicdecomp show=input ! ";
  expect_same(source(rgba) + element + i420 + " ! appsink name=out",
              source(rgba) + "vulkanupload ! " + element + i420 + " ! appsink name=out");
  expect_same(source(i420) + element + rgba + " ! appsink name=out",
              source(i420) + element + "vulkandownload ! " + rgba + " ! appsink name=out");
}

TEST_F(VulkanMemory, SystemMemoryIsChosenUnlessImagesAreRequested) {
  const std::string caps = VideoHarness::caps("RGBA", 32, 32);
  WatchedPipeline pipeline(source(caps) + "vulkanupload ! intrinsicdecomp ! appsink name=out");
  ASSERT_TRUE(pipeline.reaches(GST_STATE_PLAYING));
  GstSample* sample = pipeline.sample("out");
  ASSERT_NE(sample, nullptr);
  EXPECT_TRUE(gst_caps_features_is_equal(gst_caps_get_features(gst_sample_get_caps(sample), 0),
                                         GST_CAPS_FEATURES_MEMORY_SYSTEM_MEMORY));
  gst_sample_unref(sample);
}

TEST_F(VulkanMemory, ElementsInARowShareOneDeviceAndQueue) {
  const std::string caps = VideoHarness::caps("BGRA", 61, 43);
  // Layers between the first two, an image between the last two.
  const std::string row =
      "intrinsicdecomp name=first ! intrinsiccompose name=second ! %s"
      "intrinsicdecomp name=third show=input ! ";
  const auto with = [&](const std::string& between) {
    std::string text = row;
    return text.replace(text.find("%s"), 2, between);
  };
  const std::string images = source(caps) + "vulkanupload name=up ! " +
                             with("video/x-raw(memory:VulkanImage) ! ") +
                             "vulkandownload name=down ! " + caps + " ! appsink name=out";
  expect_same(source(caps) + with("") + caps + " ! appsink name=out", images);

  WatchedPipeline pipeline(images);
  ASSERT_TRUE(pipeline.reaches(GST_STATE_PAUSED));
  for (const char* type : {GST_VULKAN_DEVICE_CONTEXT_TYPE_STR, GST_VULKAN_QUEUE_CONTEXT_TYPE_STR}) {
    auto* theirs = shared<GObject>(pipeline.get(), "down", "sink", type);
    ASSERT_NE(theirs, nullptr) << type;
    for (const char* name : {"first", "second", "third"})
      EXPECT_EQ(shared<GObject>(pipeline.get(), name, "sink", type), theirs) << name << type;
    EXPECT_EQ(shared<GObject>(pipeline.get(), "up", "src", type), theirs) << type;
  }
}

TEST_F(VulkanMemory, BranchesOfATeeReadTheSameImage) {
  const std::string caps = VideoHarness::caps("RGBA", 61, 43);
  // A queue right behind vulkanupload would let it overwrite frames that are not copied yet (1.22).
  const std::string branch = " ! intrinsicdecomp show=input ! queue ! vulkandownload ! appsink ";
  const LineResult plain = run(source(caps, "ball", 8) + "appsink name=out");
  const LineResult teed =
      run(source(caps, "ball", 8) + "vulkanupload ! tee name=t t." + branch +
          "name=out t. ! intrinsicdecomp show=shading ! queue ! fakesink sync=false");
  ASSERT_TRUE(teed.errors.empty()) << teed.first_error();
  ASSERT_EQ(teed.frames.size(), plain.frames.size());
  for (size_t i = 0; i < plain.frames.size(); ++i)
    EXPECT_LE(largest_difference(plain.frames[i], teed.frames[i]), 1);
}

TEST_F(VulkanMemory, ImagesAreMadeForAnyUseAndOfTheSizeInTheCaps) {
  const std::string images = "video/x-raw(memory:VulkanImage), format=BGRA";
  VideoHarness harness("intrinsicdecomp show=input", VideoHarness::caps("NV12", 32, 20), images);
  for (const auto& [width, height] : {std::pair{32, 20}, {15, 10}, {46, 22}}) {
    const std::string caps = VideoHarness::caps("NV12", width, height);
    harness.set_src_caps(caps);
    for (int frame = 0; frame < 5; ++frame) {  // more than are in flight
      ASSERT_EQ(harness.push(flat_frame(caps, 128)), GST_FLOW_OK)
          << (harness.errors().empty() ? "" : harness.errors().front());
      GstBuffer* buffer = gst_harness_pull(harness.harness());
      GstMemory* memory = gst_buffer_peek_memory(buffer, 0);
      ASSERT_TRUE(gst_is_vulkan_image_memory(memory));
      const auto* image = reinterpret_cast<GstVulkanImageMemory*>(memory);
      EXPECT_EQ(image->create_info.extent.width, static_cast<uint32_t>(width));
      EXPECT_EQ(image->create_info.extent.height, static_cast<uint32_t>(height));
      EXPECT_EQ(image->barrier.image_layout, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
      EXPECT_EQ(image->barrier.parent.access_flags, VkAccessFlags{VK_ACCESS_TRANSFER_WRITE_BIT});
      const VkImageUsageFlags all = VK_IMAGE_USAGE_TRANSFER_SRC_BIT |
                                    VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_SAMPLED_BIT;
      EXPECT_EQ(image->create_info.usage & all, all);
      VkFormatProperties can;
      vkGetPhysicalDeviceFormatProperties(gst_vulkan_device_get_physical_device(image->device),
                                          image->create_info.format, &can);
      EXPECT_EQ((image->create_info.usage & VK_IMAGE_USAGE_STORAGE_BIT) != 0,
                (can.optimalTilingFeatures & VK_FORMAT_FEATURE_STORAGE_IMAGE_BIT) != 0);
      gst_buffer_unref(buffer);
    }
  }
}

TEST_F(VulkanMemory, AnImageThatIsNotWhatItsCapsSayIsRefused) {
  // vulkanupload goes on making images of the first size after the caps have changed (1.22).
  VideoHarness harness("vulkanupload ! intrinsicdecomp show=input",
                       VideoHarness::caps("RGBA", 32, 20), VideoHarness::caps("RGBA", 32, 20));
  const auto frame = random_frame(VideoHarness::caps("RGBA", 32, 20), 1);
  EXPECT_LE(largest_difference(frame, harness.process(frame)), 1);
  const std::string caps = VideoHarness::caps("RGBA", 15, 10);
  gst_harness_set_sink_caps_str(harness.harness(), caps.c_str());
  harness.set_src_caps(caps);
  const auto smaller = random_frame(caps, 2);
  if (harness.push(smaller) == GST_FLOW_OK) {
    EXPECT_LE(largest_difference(smaller, harness.pull()), 1);
  } else {
    const auto errors = harness.errors();
    ASSERT_FALSE(errors.empty());
    expect_contains(errors.front(), "intrinsicdecomp: a Vulkan image of 32x20");
  }
}

TEST_F(VulkanMemory, RepeatedPicturesAreOutputAsImagesButNotDetectedInThem) {
  const std::string caps = VideoHarness::caps("RGBA", 64, 48);
  const auto picture = random_frame(caps, 1), other = random_frame(caps, 2);
  const auto reused = [](VideoHarness& harness) {
    return stat<guint64>(harness.find("intrinsicdecompthesis"), "frames-reused");
  };
  VideoHarness out("intrinsicdecompthesis show=input ! vulkandownload", caps, caps);
  for (int i = 0; i < 8; ++i) EXPECT_LE(largest_difference(out.process(picture), picture), 1) << i;
  EXPECT_GT(reused(out), 0u);
  for (int i = 0; i < 3; ++i) EXPECT_LE(largest_difference(out.process(other), other), 1) << i;
  VideoHarness in("vulkanupload ! intrinsicdecompthesis show=input", caps, caps);
  for (int i = 0; i < 8; ++i) EXPECT_LE(largest_difference(in.process(picture), picture), 1) << i;
  EXPECT_EQ(reused(in), 0u);
}

TEST_F(VulkanMemory, StatesCycleAndNothingLeaks) {
  const std::string caps = VideoHarness::caps("RGBA", 61, 43);
  int alive = 0;
  for (const GstState rest : {GST_STATE_NULL, GST_STATE_READY}) {
    // Each cycle to its end: where it is stopped in the middle of a frame, what videotestsrc and
    // vulkanupload share is freed while the device copies it (1.22).
    WatchedPipeline pipeline(
        source(caps, "gradient", 5) +
        "vulkanupload ! intrinsicdecomp show=input ! intrinsiccompose ! "
        "vulkandownload name=down ! appsink name=out sync=false wait-on-eos=false");
    std::vector<uint8_t> first;
    for (int cycle = 0; cycle < 10; ++cycle) {
      ASSERT_TRUE(pipeline.reaches(GST_STATE_PLAYING)) << cycle;
      GstSample* sample = pipeline.sample("out");
      ASSERT_NE(sample, nullptr) << cycle;
      const auto bytes = bytes_of(gst_sample_get_buffer(sample));
      gst_sample_unref(sample);
      if (cycle == 0) first = bytes;
      EXPECT_LE(largest_difference(first, bytes), 1) << cycle;
      auto* device =
          shared<GObject>(pipeline.get(), "down", "sink", GST_VULKAN_DEVICE_CONTEXT_TYPE_STR);
      ASSERT_NE(device, nullptr);
      if (!g_object_get_data(device, "watched")) {
        ++alive;
        g_object_set_data(device, "watched", &alive);
        g_object_weak_ref(
            device, [](gpointer count, GObject*) { --*static_cast<int*>(count); }, &alive);
      }
      ASSERT_TRUE(pipeline.ends()) << cycle;
      ASSERT_TRUE(pipeline.reaches(rest)) << cycle;
      EXPECT_EQ(alive, 1) << "neighbors that keep pools must get their device again, " << cycle;
    }
  }
  EXPECT_EQ(alive, 0) << "devices that outlive their pipeline";
}

TEST_F(VulkanMemory, ADeviceOfTheApplicationIsKept) {
  // The application takes the device of one pipeline …
  GstContext* demanded = nullptr;
  WatchedPipeline other("videotestsrc ! intrinsicdecomp ! fakesink");
  ASSERT_TRUE(other.reaches(GST_STATE_READY));
  GstMessage* message =
      gst_bus_timed_pop_filtered(other.bus(), GST_SECOND, GST_MESSAGE_HAVE_CONTEXT);
  ASSERT_NE(message, nullptr);
  gst_message_parse_have_context(message, &demanded);
  gst_message_unref(message);
  ASSERT_STREQ(gst_context_get_context_type(demanded), "gst.inverse.device");
  const auto demand = [&](GstElement* pipeline) { gst_element_set_context(pipeline, demanded); };

  // … and demands it of another: that is fine in system memory,
  const std::string caps = VideoHarness::caps("RGBA", 32, 32);
  const LineResult plain =
      run(source(caps) + "intrinsicdecomp ! " + caps + " ! appsink name=out", demand);
  EXPECT_TRUE(plain.errors.empty()) << plain.first_error();
  EXPECT_EQ(plain.frames.size(), 3u);
  // and cannot be done where images go in or out, at once or behind editors.
  for (const char* rest :
       {"vulkanupload ! intrinsicdecomp ! fakesink", "intrinsicdecomp ! vulkandownload ! fakesink",
        "intrinsicdecomp ! intrinsiccompose ! vulkandownload ! fakesink"}) {
    const LineResult images = run(source(caps) + rest, demand);
    EXPECT_FALSE(images.eos) << rest;
    expect_contains(images.first_error(), "needs two Vulkan devices");
    EXPECT_EQ(images.first_error().find("intrinsic"), 0u) << images.first_error();
  }
  // The demand may be made of the element alone, and outlives a trip to NULL.
  WatchedPipeline again("videotestsrc ! intrinsicdecomp name=d ! vulkandownload ! fakesink");
  gst_element_set_context(again.find("d"), demanded);
  for (int start = 0; start < 3; ++start) {
    again.set(GST_STATE_PLAYING);
    expect_contains(again.error(), "needs two Vulkan devices");
    again.set(GST_STATE_NULL);
  }
  gst_context_unref(demanded);
}

TEST_F(VulkanMemory, ImagesFromOneDeviceDoNotGoOutOnAnother) {
  const std::string caps = VideoHarness::caps("RGBA", 32, 32);
  WatchedPipeline from(
      source(caps, "smpte", -1) +
      "vulkanupload ! video/x-raw(memory:VulkanImage) ! appsink name=out max-buffers=1 "
      "sync=false");
  ASSERT_TRUE(from.reaches(GST_STATE_PLAYING));
  GstSample* sample = from.sample("out");
  ASSERT_NE(sample, nullptr);
  const auto feed = [&](GstElement* pipeline) {
    GstElement* source = find_element(pipeline, "in");
    gst_app_src_push_sample(GST_APP_SRC(source), sample);
    gst_app_src_end_of_stream(GST_APP_SRC(source));
  };
  // Into system memory it goes: the element works where the frame lies.
  const LineResult plain = run(
      "appsrc name=in format=time ! intrinsicdecomp show=input ! " + caps + " ! appsink name=out",
      feed);
  EXPECT_TRUE(plain.errors.empty()) << plain.first_error();
  EXPECT_EQ(plain.frames.size(), 1u);
  // With a neighbor that opened a device of its own there are two.
  const LineResult both =
      run("appsrc name=in format=time ! intrinsicdecomp ! vulkandownload ! fakesink", feed);
  EXPECT_FALSE(both.eos);
  expect_contains(both.first_error(), "intrinsicdecomp: this pipeline needs two Vulkan devices");
  gst_sample_unref(sample);
}

TEST_F(VulkanMemory, ImagesWithoutAnyVulkanNeighborStillGoOut) {
  const std::string caps = VideoHarness::caps("RGBA", 32, 32);
  for (const char* element : {"intrinsicdecomp", "intrinsicdecomp ! intrinsiccompose"}) {
    const LineResult result =
        run(source(caps) + element + " ! video/x-raw(memory:VulkanImage) ! fakesink");
    EXPECT_TRUE(result.eos) << element;
    EXPECT_TRUE(result.errors.empty()) << result.first_error();
  }
}

namespace {

/// A running pipeline to which a branch with vulkandownload is added, linked before or after it is
/// started.
void join_later(WatchedPipeline& pipeline, bool link_first) {
  ASSERT_TRUE(pipeline.reaches(GST_STATE_PLAYING));
  gst_sample_unref(pipeline.sample("early"));
  GstElement* branch = gst_parse_bin_from_description(
      "queue ! intrinsiccompose show=input ! vulkandownload ! "
      "appsink name=late sync=false max-buffers=1 drop=true async=false",
      TRUE, nullptr);
  ASSERT_TRUE(gst_bin_add(GST_BIN(pipeline.get()), branch));
  if (!link_first) {
    ASSERT_TRUE(gst_element_sync_state_with_parent(branch));
  }
  GstPad* to = gst_element_request_pad_simple(pipeline.find("t"), "src_%u");
  GstPad* at = gst_element_get_static_pad(branch, "sink");
  // No frame until it runs.
  const gulong block = gst_pad_add_probe(
      to, GST_PAD_PROBE_TYPE_BLOCK_DOWNSTREAM,
      [](GstPad*, GstPadProbeInfo*, gpointer) { return GST_PAD_PROBE_OK; }, nullptr, nullptr);
  ASSERT_EQ(gst_pad_link(to, at), GST_PAD_LINK_OK);
  if (link_first) {
    ASSERT_TRUE(gst_element_sync_state_with_parent(branch));
  }
  gst_pad_remove_probe(to, block);
  gst_object_unref(at);
  gst_object_unref(to);
}

constexpr const char* kTee =
    "videotestsrc ! video/x-raw, format=RGBA, width=32, height=32 ! intrinsicdecomp ! tee name=t ! "
    "queue ! intrinsiccompose show=input ! video/x-raw, format=RGBA ! "
    "appsink name=early sync=false max-buffers=1 drop=true";

}  // namespace

// A line that began without images runs on a device of our own, and what is on its way when
// somebody asks for images stays there.
TEST_F(VulkanMemory, ADownloaderThatJoinsALineOfSystemMemoryIsRefused) {
  for (const bool link_first : {true, false}) {
    WatchedPipeline pipeline(kTee);
    join_later(pipeline, link_first);
    expect_contains(pipeline.error(), "needs two Vulkan devices");
  }
}

}  // namespace inverse::testing
