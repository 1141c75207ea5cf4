// SPDX-License-Identifier: LGPL-2.1-or-later
// Pads on request that come and go while other threads ask them and flush them: what is called must
// live as long as the pad. Built with a sanitizer it tells; without one such a fault crashes in
// some of the runs.
#include <atomic>
#include <thread>

#include "tests/elements/element_test.hpp"

namespace inverse::testing {
namespace {

/// The other end of a pad on request, which threads share.
class Peer {
 public:
  void set(GstPad* pad) {
    const std::lock_guard lock(mutex_);
    if (pad_) gst_object_unref(pad_);
    pad_ = pad;
  }
  /// A reference, or null.
  GstPad* get() {
    const std::lock_guard lock(mutex_);
    return pad_ ? GST_PAD(gst_object_ref(pad_)) : nullptr;
  }

 private:
  std::mutex mutex_;
  GstPad* pad_ = nullptr;
};

void ask(GstElement* element, Peer& peer) {
  if (GstPad* pad = peer.get()) {
    if (GstCaps* caps = gst_pad_peer_query_caps(pad, nullptr)) gst_caps_unref(caps);
    gst_object_unref(pad);
  }
  GstQuery* latency = gst_query_new_latency();
  if (GstPad* source = gst_element_get_static_pad(element, "src")) {
    gst_pad_query(source, latency);
    gst_object_unref(source);
  } else {
    gst_element_query(element, latency);
  }
  gst_query_unref(latency);
}

void flush(Peer& peer) {
  GstPad* pad = peer.get();
  if (!pad) return;
  if (GST_PAD_IS_SRC(pad)) {
    gst_pad_push_event(pad, gst_event_new_flush_start());
    gst_pad_push_event(pad, gst_event_new_flush_stop(TRUE));
  } else {
    gst_pad_push_event(pad, gst_event_new_reconfigure());
  }
  gst_object_unref(pad);
}

/// Requests a pad, links it, and gives it back.
void come_and_go(GstElement* element, GstPadTemplate* request, Peer& peer) {
  GstPad* pad = gst_element_request_pad(element, request, nullptr, nullptr);
  if (!pad) return;
  const bool sink = GST_PAD_IS_SINK(pad);
  GstPad* other = gst_pad_new(nullptr, sink ? GST_PAD_SRC : GST_PAD_SINK);
  gst_object_ref_sink(other);
  gst_pad_set_active(other, TRUE);
  EXPECT_EQ(sink ? gst_pad_link(other, pad) : gst_pad_link(pad, other), GST_PAD_LINK_OK);
  peer.set(GST_PAD(gst_object_ref(other)));
  std::this_thread::yield();
  gst_element_release_request_pad(element, pad);
  gst_object_unref(pad);
  gst_pad_set_active(other, FALSE);
  gst_object_unref(other);
}

struct Case {
  std::string factory, pad;
};

std::vector<Case> cases() {
  std::vector<Case> found;
  gst_init(nullptr, nullptr);
  for (const char* plugin : {"inverse", "inversestage", "inversetexture", "inversemesh"}) {
    GList* features = gst_registry_get_feature_list_by_plugin(gst_registry_get(), plugin);
    for (GList* item = features; item; item = item->next) {
      if (!GST_IS_ELEMENT_FACTORY(item->data)) continue;
      auto* factory = GST_ELEMENT_FACTORY(item->data);
      for (const GList* t = gst_element_factory_get_static_pad_templates(factory); t; t = t->next) {
        const auto* pad = static_cast<const GstStaticPadTemplate*>(t->data);
        if (pad->presence == GST_PAD_REQUEST)
          found.push_back({GST_OBJECT_NAME(factory), pad->name_template});
      }
    }
    gst_plugin_feature_list_free(features);
  }
  return found;
}

class RequestPads : public ::testing::TestWithParam<Case> {
 protected:
  static void come_and_go_while_asked(const Case& of, int rounds);
};

void RequestPads::come_and_go_while_asked(const Case& of, int rounds) {
  GstElement* element = gst_element_factory_make(of.factory.c_str(), nullptr);
  ASSERT_NE(element, nullptr);
  gst_object_ref_sink(element);
  gst_element_set_state(element, GST_STATE_PAUSED);
  GstPadTemplate* request = gst_element_get_pad_template(element, of.pad.c_str());
  ASSERT_NE(request, nullptr);
  Peer peer;
  std::atomic<bool> over{false};
  std::vector<std::thread> threads;
  for (int i = 0; i < 2; ++i)
    threads.emplace_back([&] {
      while (!over) ask(element, peer);
    });
  threads.emplace_back([&] {
    while (!over) flush(peer);
  });
  for (int i = 0; i < rounds; ++i) come_and_go(element, request, peer);
  over = true;
  for (std::thread& thread : threads) thread.join();
  peer.set(nullptr);
  gst_element_set_state(element, GST_STATE_NULL);
  gst_object_unref(element);
}

TEST_P(RequestPads, LiveWhileTheyAreAsked) { come_and_go_while_asked(GetParam(), 100); }
// More than 10 000 of all pads together.
TEST_P(RequestPads, LiveThroughHundredsOfRequests) { come_and_go_while_asked(GetParam(), 500); }

INSTANTIATE_TEST_SUITE_P(All, RequestPads, ::testing::ValuesIn(cases()), [](const auto& info) {
  std::string name = info.param.factory + "_" + info.param.pad;
  std::ranges::replace_if(
      name, [](char c) { return !std::isalnum(c); }, '_');
  return name;
});

}  // namespace
}  // namespace inverse::testing
