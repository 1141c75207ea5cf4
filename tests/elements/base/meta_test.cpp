// SPDX-License-Identifier: LGPL-2.1-or-later
// Our metas on their way through elements of GStreamer's own.

#include <array>
#include <thread>

#include "gst/base/meta/registered_once.hpp"
#include "gst/inverse/inverse_light_stage_meta.h"
#include "gst/inverse/inverse_material_meta.h"
#include "tests/elements/element_test.hpp"
#include "tests/has_networks.hpp"

namespace inverse::testing {
namespace {

class MetaTest : public ::testing::Test {
 protected:
  /// Metas are registered by the plugins that make them.
  static void SetUpTestSuite() {
    for (const char* plugin : {"inverse", "inversestage"})
      if (GstPlugin* loaded = gst_plugin_load_by_name(plugin)) gst_object_unref(loaded);
  }

  /// What comes of an RGBA frame of 64 x 48 with both metas, behind these elements. The second of
  /// two frames: elements may pass the first on before they look at their properties.
  void send_through(const std::string& elements, const std::string& caps) {
    VideoHarness harness(elements, VideoHarness::caps("RGBA", 64, 48), caps);
    for (int i = 0; i < 2; ++i) {
      ASSERT_EQ(gst_harness_push(harness.harness(), frame(i)), GST_FLOW_OK);
      out_.reset(gst_harness_pull(harness.harness()));
      ASSERT_NE(out_, nullptr) << elements;
    }
  }
  const GstMaterialMeta* material() const { return gst_buffer_get_material_meta(out_.get()); }
  const GstLightStageMeta* light_stage() const {
    return gst_buffer_get_light_stage_meta(out_.get());
  }

  void expect_material(float left, float top, float right, float bottom) {
    const GstMaterialMeta* m = material();
    ASSERT_NE(m, nullptr);
    EXPECT_TRUE(m->found);
    EXPECT_EQ(m->averaged, 7u);
    EXPECT_EQ(m->diffuse[1], .5F);
    EXPECT_EQ(m->shininess, 60);
    EXPECT_EQ(m->bins[4], 1);
    EXPECT_FLOAT_EQ(m->left, left);
    EXPECT_FLOAT_EQ(m->top, top);
    EXPECT_FLOAT_EQ(m->right, right);
    EXPECT_FLOAT_EQ(m->bottom, bottom);
    ASSERT_NE(m->environment, nullptr);
    EXPECT_EQ(g_bytes_get_size(m->environment), 5u);
    EXPECT_EQ(m->environment_width, 64u);
  }

  Buffer out_;

 private:
  static GstBuffer* frame(int number) {
    const auto bytes = random_frame(VideoHarness::caps("RGBA", 64, 48), 1);
    GstBuffer* buffer = gst_buffer_new_memdup(bytes.data(), bytes.size());
    GST_BUFFER_PTS(buffer) = static_cast<GstClockTime>(number) * 40 * GST_MSECOND;
    auto* m = reinterpret_cast<GstMaterialMeta*>(
        gst_buffer_add_meta(buffer, gst_meta_get_info("GstMaterialMeta"), nullptr));
    m->found = TRUE;
    m->averaged = 7;
    m->diffuse[1] = .5F;
    m->shininess = 60;
    m->bins[4] = 1;
    m->left = 10;
    m->top = 12;
    m->right = 30;
    m->bottom = 36;
    m->environment_width = 64;
    m->environment = g_bytes_new("light", 5);
    if (const GstMetaInfo* stage = gst_meta_get_info("GstLightStageMeta"))
      reinterpret_cast<GstLightStageMeta*>(gst_buffer_add_meta(buffer, stage, nullptr))->step = 3;
    return buffer;
  }
};

TEST_F(MetaTest, MaterialsStayWhereFramesAreConverted) {
  send_through("videoconvert", VideoHarness::caps("I420", 64, 48));
  expect_material(10, 12, 30, 36);
}

TEST_F(MetaTest, BoxesAreScaledWithTheFrame) {
  send_through("videoscale", VideoHarness::caps("RGBA", 32, 96));
  expect_material(5, 24, 15, 72);
  send_through("videoconvertscale", VideoHarness::caps("NV12", 128, 96));
  expect_material(20, 24, 60, 72);
}

TEST_F(MetaTest, MaterialsStayBehindOurOwnElements) {
  send_through("intrinsicdecomp", VideoHarness::caps("RGBA", 64, 48));
  expect_material(10, 12, 30, 36);
}

TEST_F(MetaTest, OfSeveralLimematerialsTheLastOneCounts) {
  if (!has_networks()) GTEST_SKIP() << "built without inverse-onnx-import";
  send_through("limematerial show=input", VideoHarness::caps("RGBA", 64, 48));
  ASSERT_NE(material(), nullptr);
  EXPECT_EQ(gst_buffer_get_n_meta(out_.get(), g_type_from_name(GST_MATERIAL_META_API_NAME)), 1u);
  EXPECT_EQ(material()->environment, nullptr) << "not what the frame brought";
  EXPECT_NE(material()->averaged, 7u);
}

TEST_F(MetaTest, CroppingOrTurningFramesDropsTheMaterial) {
  for (const auto& [elements, width, height] : {std::tuple{"videoflip video-direction=180", 64, 48},
                                                {"videoflip video-direction=90r", 48, 64},
                                                {"videoflip video-direction=horiz", 64, 48},
                                                {"videocrop top=10 left=20", 44, 38}}) {
    send_through(elements, VideoHarness::caps("RGBA", width, height));
    EXPECT_EQ(material(), nullptr) << elements;
  }
}

TEST_F(MetaTest, LightStageMetaSurvivesEveryConversion) {
  if (!gst_meta_get_info("GstLightStageMeta")) GTEST_SKIP() << "built without inversestage";
  for (const auto& [elements, format, width, height] :
       {std::tuple{"videoconvert", "I420", 64, 48},
        {"videoscale", "RGBA", 32, 24},
        {"videoflip video-direction=90r", "RGBA", 48, 64},
        {"videocrop top=10 left=20", "RGBA", 44, 38},
        {"intrinsicdecomp", "RGBA", 64, 48}}) {
    send_through(elements, VideoHarness::caps(format, width, height));
    const GstLightStageMeta* meta = light_stage();
    ASSERT_NE(meta, nullptr) << elements;
    EXPECT_EQ(meta->step, 3) << elements;
  }
}

}  // namespace
// Two plugins may register the same type at the same time.
TEST(RegisteredOnce, ThreadsGetTheSameType) {
  for (int round = 0; round < 100; ++round) {
    const std::string name = "InverseTestRegistered" + std::to_string(round);
    std::array<GType, 4> types{};
    std::vector<std::thread> threads;
    for (GType& type : types)
      threads.emplace_back([&name, &type] {
        type = type_registered_once(name.c_str(), [&name] {
          return g_type_register_static_simple(G_TYPE_OBJECT, name.c_str(), sizeof(GObjectClass),
                                               nullptr, sizeof(GObject), nullptr, GTypeFlags{});
        });
      });
    for (std::thread& thread : threads) thread.join();
    for (const GType type : types) ASSERT_EQ(type, g_type_from_name(name.c_str())) << name;
    ASSERT_NE(types[0], 0U);
  }
}

}  // namespace inverse::testing
