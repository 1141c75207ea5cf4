// SPDX-License-Identifier: LGPL-2.1-or-later
// Frames in memory that the host and the device share: no copy, and the same pictures.
#include "tests/elements/element_test.hpp"
#include "tests/elements/layer_of.hpp"
#include "tests/pipeline.hpp"

namespace inverse::testing {
namespace {

using Bytes = std::vector<uint8_t>;
constexpr const char* kMapped = "InverseMapped";
/// Keeps the source from the memory of the element behind.
const std::string kBarrier = " ! identity drop-allocation=true";

struct Work {
  guint64 uploaded = 0, downloaded = 0;
};

/// The frames of a source behind some elements, and the bytes that `d` copied for the last one.
struct Pictures {
  std::vector<Bytes> frames;
  Work last;
};

bool is_mapped(GstBuffer* buffer) {
  return gst_memory_is_type(gst_buffer_peek_memory(buffer, 0), kMapped);
}

std::string source(const std::string& caps, int frames = 4) {
  return "videotestsrc pattern=ball motion=wavy num-buffers=" + std::to_string(frames) + " ! " +
         caps;
}

/// The pool of an element that has its reasons.
GType special_pool() {
  static const GType type = g_type_register_static_simple(
      GST_TYPE_BUFFER_POOL, "InverseTestPool", sizeof(GstBufferPoolClass), nullptr,
      sizeof(GstBufferPool), nullptr, static_cast<GTypeFlags>(0));
  return type;
}

GstPadProbeReturn propose_special(GstPad*, GstPadProbeInfo* probe, gpointer) {
  GstQuery* query = GST_PAD_PROBE_INFO_QUERY(probe);
  if (GST_QUERY_TYPE(query) != GST_QUERY_ALLOCATION) return GST_PAD_PROBE_OK;
  GstCaps* caps = nullptr;
  gst_query_parse_allocation(query, &caps, nullptr);
  GstVideoInfo info;
  gst_video_info_from_caps(&info, caps);
  auto* pool = GST_BUFFER_POOL(g_object_new(special_pool(), nullptr));
  gst_query_add_allocation_pool(query, pool, static_cast<guint>(info.size), 0, 0);
  gst_object_unref(pool);
  return GST_PAD_PROBE_HANDLED;
}

void probe(Pipeline& pipeline, const char* element, const char* pad_name, GstPadProbeType type,
           GstPadProbeCallback callback) {
  GstPad* pad = gst_element_get_static_pad(pipeline.find(element), pad_name);
  gst_pad_add_probe(pad, type, callback, nullptr, nullptr);
  gst_object_unref(pad);
}

/// What goes out is copied if a pool of another kind is proposed.
Pictures run(const std::string& caps, const std::string& line, bool special = false) {
  Pictures result;
  Pipeline pipeline(line + " ! appsink name=out sync=false");
  if (special) probe(pipeline, "out", "sink", GST_PAD_PROBE_TYPE_QUERY_DOWNSTREAM, propose_special);
  EXPECT_NE(pipeline.set(GST_STATE_PLAYING), GST_STATE_CHANGE_FAILURE) << line;
  while (GstSample* sample = pipeline.sample("out")) {
    result.frames.push_back(visible(caps, bytes_of(gst_sample_get_buffer(sample))));
    gst_sample_unref(sample);
  }
  EXPECT_EQ(pipeline.error(0), "") << line;
  if (GstElement* d = pipeline.find("d"))
    result.last = {stat<guint64>(d, "bytes-uploaded"), stat<guint64>(d, "bytes-downloaded")};
  return result;
}

/// Without our memory on either side of `elements`.
Pictures run_copied(const std::string& caps, int frames, const std::string& elements) {
  return run(caps, source(caps, frames) + kBarrier + elements, true);
}

/// Overwrites a picture in place, as a filter downstream may.
GstPadProbeReturn spoil(GstPad*, GstPadProbeInfo* probe, gpointer) {
  auto* buffer = gst_buffer_make_writable(GST_PAD_PROBE_INFO_BUFFER(probe));
  gst_buffer_memset(buffer, 0, 77, gst_buffer_get_size(buffer));
  GST_PAD_PROBE_INFO_DATA(probe) = buffer;
  return GST_PAD_PROBE_OK;
}

}  // namespace

class MappedMemory : public ::testing::TestWithParam<std::tuple<const char*, int, int>> {
 protected:
  static std::string caps() {
    const auto& [format, width, height] = GetParam();
    return VideoHarness::caps(format, width, height);
  }
};
INSTANTIATE_TEST_SUITE_P(All, MappedMemory,
                         ::testing::Combine(::testing::Values("RGBA", "RGB", "I420", "NV12", "YUY2",
                                                              "GRAY8", "v210"),
                                            ::testing::Values(64, 63), ::testing::Values(48, 37)),
                         [](const auto& info) {
                           return std::string(std::get<0>(info.param)) + "_" +
                                  std::to_string(std::get<1>(info.param)) + "x" +
                                  std::to_string(std::get<2>(info.param));
                         });
// GStreamer's rows of this format have no room for odd widths.
INSTANTIATE_TEST_SUITE_P(Deep, MappedMemory,
                         ::testing::Values(std::tuple{"P010_10LE", 62, 37},
                                           std::tuple{"RGBA", 1921, 1081},
                                           std::tuple{"I420", 1921, 1081}));

TEST_P(MappedMemory, IsNotCopiedAndThePicturesAreTheSame) {
  const std::string element = " ! intrinsicdecomp name=d adaptive=false ! " + caps();
  const Pictures copied = run_copied(caps(), 4, element);
  const Pictures mapped = run(caps(), source(caps()) + element);
  ASSERT_EQ(mapped.frames.size(), 4u);
  EXPECT_EQ(mapped.frames, copied.frames);
  EXPECT_GE(copied.last.downloaded, copied.frames[0].size());
  EXPECT_EQ(mapped.last.downloaded, 0u);
  EXPECT_EQ(mapped.last.uploaded + copied.last.downloaded, copied.last.uploaded);
}

TEST_P(MappedMemory, StaysAsItIsUntilTheDeviceHasReadIt) {
  // The source draws frames while the device works on earlier ones.
  const std::string element = " ! intrinsicdecomp ! queue ! intrinsiccompose name=d ! " + caps();
  const Pictures copied = run_copied(caps(), 12, element);
  const Pictures mapped = run(caps(), source(caps(), 12) + element);
  ASSERT_EQ(mapped.frames.size(), 12u);
  EXPECT_EQ(mapped.frames, copied.frames);
  EXPECT_EQ(mapped.last.downloaded, 0u) << "the editor's device is known with the first frame";
  EXPECT_GT(copied.last.downloaded, 0u);
}

TEST(MappedFrames, ArriveInAPoolThatIsProposed) {
  const std::string caps = VideoHarness::caps("I420", 63, 37);
  const GstVideoInfo info = info_of(caps);
  VideoHarness harness("intrinsicdecomp", caps, kLayers);
  GstCaps* parsed = gst_caps_from_string(caps.c_str());
  GstQuery* query = gst_query_new_allocation(parsed, TRUE);
  ASSERT_TRUE(gst_pad_peer_query(harness.harness()->srcpad, query));
  GstBufferPool* pool = nullptr;
  guint size = 0, min = 0, max = 1;
  ASSERT_EQ(gst_query_get_n_allocation_pools(query), 1u);
  gst_query_parse_nth_allocation_pool(query, 0, &pool, &size, &min, &max);
  EXPECT_EQ(size, info.size);
  EXPECT_EQ(min, 3u) << "so many frames are in flight";
  EXPECT_EQ(max, 0u);
  GstAllocator* allocator = nullptr;
  gst_query_parse_nth_allocation_param(query, 0, &allocator, nullptr);
  ASSERT_NE(allocator, nullptr);
  EXPECT_STREQ(allocator->mem_type, kMapped);
  ASSERT_TRUE(gst_buffer_pool_set_active(pool, TRUE));
  GstBuffer* buffer = nullptr;
  ASSERT_EQ(gst_buffer_pool_acquire_buffer(pool, &buffer, nullptr), GST_FLOW_OK);
  EXPECT_TRUE(is_mapped(buffer));
  EXPECT_EQ(gst_buffer_get_size(buffer), info.size);
  gst_buffer_unref(buffer);
  gst_buffer_pool_set_active(pool, FALSE);
  gst_object_unref(pool);
  gst_object_unref(allocator);
  gst_query_unref(query);
  gst_caps_unref(parsed);
}

TEST(MappedFrames, AreMemoryLikeOthers) {
  VideoHarness harness("intrinsicdecomp", VideoHarness::caps("RGBA", 64, 48), kLayers);
  GstCaps* caps = gst_caps_from_string(VideoHarness::caps("RGBA", 64, 48).c_str());
  GstQuery* query = gst_query_new_allocation(caps, FALSE);
  ASSERT_TRUE(gst_pad_peer_query(harness.harness()->srcpad, query));
  GstAllocator* allocator = nullptr;
  gst_query_parse_nth_allocation_param(query, 0, &allocator, nullptr);
  for (const gsize align : {0u, 63u, 4095u}) {
    GstAllocationParams params;
    gst_allocation_params_init(&params);
    params.align = align;
    params.prefix = 5;
    params.padding = 9;
    GstBuffer* buffer = gst_buffer_new_allocate(allocator, 1001, &params);
    ASSERT_NE(buffer, nullptr);
    GstMapInfo map;
    ASSERT_TRUE(gst_buffer_map(buffer, &map, GST_MAP_READWRITE));
    EXPECT_EQ(map.size, 1001u);
    EXPECT_EQ(reinterpret_cast<guintptr>(map.data) & align, 0u);
    for (size_t i = 0; i < map.size; ++i) map.data[i] = static_cast<uint8_t>(i);
    gst_buffer_unmap(buffer, &map);
    const Bytes all = bytes_of(buffer);
    GstBuffer* part = gst_buffer_copy_region(buffer, GST_BUFFER_COPY_MEMORY, 100, 200);
    GstBuffer* copy = gst_buffer_copy_deep(buffer);
    gst_buffer_unref(buffer);
    EXPECT_TRUE(is_mapped(part));
    EXPECT_EQ(bytes_of(part), Bytes(all.begin() + 100, all.begin() + 300));
    EXPECT_EQ(bytes_of(copy), all);
    gst_buffer_unref(part);
    gst_buffer_unref(copy);
  }
  gst_object_unref(allocator);
  gst_query_unref(query);
  gst_caps_unref(caps);
}

TEST(MappedFrames, StayReadableAfterTheElementIsGone) {
  const std::string caps = VideoHarness::caps("RGBA", 320, 240);
  const NewDevice none;  // else holds the device
  GstSample* sample = nullptr;
  Bytes bytes;
  {
    Pipeline pipeline(source(caps) + " ! intrinsicdecomp ! " + caps + " ! appsink name=out");
    ASSERT_NE(pipeline.set(GST_STATE_PLAYING), GST_STATE_CHANGE_FAILURE);
    sample = pipeline.sample("out");
    ASSERT_NE(sample, nullptr);
    bytes = bytes_of(gst_sample_get_buffer(sample));
  }
  ASSERT_TRUE(is_mapped(gst_sample_get_buffer(sample)));
  EXPECT_EQ(bytes_of(gst_sample_get_buffer(sample)), bytes);
  gst_sample_unref(sample);
}

TEST(MappedFrames, FeedTwoDecomposersBehindATee) {
  const std::string caps = VideoHarness::caps("NV12", 63, 37);
  const std::string element = " ! intrinsicdecomp name=d adaptive=false ! " + caps;
  const Pictures alone = run_copied(caps, 6, element);
  Pipeline pipeline(source(caps, 6) + " ! tee name=t ! queue ! intrinsicdecomp adaptive=false ! " +
                    caps + " ! appsink name=a t. ! queue ! intrinsicdecomp adaptive=false ! " +
                    caps + " ! appsink name=b");
  ASSERT_NE(pipeline.set(GST_STATE_PLAYING), GST_STATE_CHANGE_FAILURE);
  for (const Bytes& frame : alone.frames)
    for (const char* sink : {"a", "b"}) {
      GstSample* sample = pipeline.sample(sink);
      ASSERT_NE(sample, nullptr);
      EXPECT_EQ(visible(caps, bytes_of(gst_sample_get_buffer(sample))), frame) << sink;
      gst_sample_unref(sample);
    }
}

TEST(MappedFrames, FollowChangesOfCaps) {
  Pipeline pipeline(
      "videotestsrc pattern=smpte75 ! capsfilter name=c caps-change-mode=delayed ! intrinsicdecomp "
      "show=input ! appsink "
      "name=out");
  const auto set = [&](const std::string& caps) {
    GstCaps* parsed = gst_caps_from_string(caps.c_str());
    g_object_set(pipeline.find("c"), "caps", parsed, nullptr);
    gst_caps_unref(parsed);
  };
  set(VideoHarness::caps("RGBA", 64, 48));
  ASSERT_NE(pipeline.set(GST_STATE_PLAYING), GST_STATE_CHANGE_FAILURE);
  for (const auto& [width, height] : {std::pair{64, 48}, {31, 37}, {320, 240}, {64, 48}}) {
    const std::string caps = VideoHarness::caps("RGBA", width, height);
    set(caps);
    const Pictures want = run(caps, "videotestsrc pattern=smpte75 num-buffers=1 ! " + caps);
    GstSample* sample = nullptr;
    for (int i = 0; i < 100; ++i) {
      if (sample) gst_sample_unref(sample);
      sample = pipeline.sample("out");
      ASSERT_NE(sample, nullptr) << pipeline.error(0);
      if (gst_buffer_get_size(gst_sample_get_buffer(sample)) == info_of(caps).size) break;
    }
    EXPECT_LE(largest_difference(visible(caps, bytes_of(gst_sample_get_buffer(sample))),
                                 want.frames.at(0)),
              1)
        << caps;
    EXPECT_TRUE(is_mapped(gst_sample_get_buffer(sample)));
    gst_sample_unref(sample);
  }
}

TEST(MappedFrames, MayBeOverwrittenDownstream) {
  const std::string caps = VideoHarness::caps("RGBA", 64, 48);
  const std::string still = "videotestsrc pattern=smpte75 num-buffers=40 ! " + caps;
  Pipeline pipeline(still +
                    " ! intrinsicdecomp ! tee name=t ! queue ! identity name=i ! fakesink t. "
                    "! queue ! appsink name=out");
  // Of what goes out, one branch of two is changed: the other's bytes stay.
  probe(pipeline, "i", "sink", GST_PAD_PROBE_TYPE_BUFFER, spoil);
  const Pictures want = run(caps, still + kBarrier + " ! intrinsicdecomp ! " + caps, true);
  ASSERT_NE(pipeline.set(GST_STATE_PLAYING), GST_STATE_CHANGE_FAILURE);
  for (const Bytes& frame : want.frames) {
    GstSample* sample = pipeline.sample("out");
    ASSERT_NE(sample, nullptr);
    EXPECT_EQ(visible(caps, bytes_of(gst_sample_get_buffer(sample))), frame);
    gst_sample_unref(sample);
  }
  // And alone: what is drawn in parts or again does not start from what downstream left.
  Pipeline spoiled(still + " ! intrinsicdecomp name=d ! identity name=i ! fakesink sync=false");
  static std::vector<Bytes> seen;
  seen.clear();
  probe(spoiled, "d", "src", GST_PAD_PROBE_TYPE_BUFFER,
        [](GstPad*, GstPadProbeInfo* probe, gpointer) {
          seen.push_back(bytes_of(GST_PAD_PROBE_INFO_BUFFER(probe)));
          return GST_PAD_PROBE_OK;
        });
  probe(spoiled, "i", "sink", GST_PAD_PROBE_TYPE_BUFFER, spoil);
  ASSERT_NE(spoiled.set(GST_STATE_PLAYING), GST_STATE_CHANGE_FAILURE);
  ASSERT_TRUE(spoiled.ends());
  EXPECT_EQ(seen, want.frames);
}

TEST(MappedFrames, LeaveSpecialPoolsAlone) {
  const std::string caps = VideoHarness::caps("RGBA", 64, 48);
  Pipeline pipeline(source(caps) + " ! intrinsicdecomp name=d ! " + caps + " ! appsink name=out");
  probe(pipeline, "out", "sink", GST_PAD_PROBE_TYPE_QUERY_DOWNSTREAM, propose_special);
  ASSERT_NE(pipeline.set(GST_STATE_PLAYING), GST_STATE_CHANGE_FAILURE);
  GstSample* sample = pipeline.sample("out");
  ASSERT_NE(sample, nullptr);
  GstBuffer* buffer = gst_sample_get_buffer(sample);
  ASSERT_NE(buffer->pool, nullptr);
  EXPECT_EQ(G_OBJECT_TYPE(buffer->pool), special_pool());
  EXPECT_FALSE(is_mapped(buffer));
  gst_sample_unref(sample);
}

}  // namespace inverse::testing
