// SPDX-License-Identifier: LGPL-2.1-or-later
#include "input.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <iterator>
#include <stdexcept>

namespace inverse::run {
namespace {

constexpr const char* kLists[] = {
    "application/x-hls", "application/dash+xml", "application/vnd.ms-sstr+xml",
    "application/sdp",   "text/uri-list",        "application/xges",
    "text/x-xptv"};

/// From then on no element that plays lists is chosen. In Python:
/// inverse_common.media.allow_lists.
void play_no_lists() {
  GList* demuxers =
      gst_element_factory_list_get_elements(GST_ELEMENT_FACTORY_TYPE_DEMUXER, GST_RANK_NONE);
  for (const char* name : kLists) {
    GstCaps* caps = gst_caps_new_empty_simple(name);
    GList* found = gst_element_factory_list_filter(demuxers, caps, GST_PAD_SINK, FALSE);
    for (GList* item = found; item; item = item->next)
      gst_plugin_feature_set_rank(GST_PLUGIN_FEATURE(item->data), GST_RANK_NONE);
    gst_plugin_feature_list_free(found);
    gst_caps_unref(caps);
  }
  gst_plugin_feature_list_free(demuxers);
}

/// Has decodebin take libav's decoder for JPEG: jpegdec of GStreamer 1.22 makes blotches of color
/// that is not 4:2:0. In Python: inverse_common.media.prefer_decoders.
void prefer_decoders() {
  GstRegistry* registry = gst_registry_get();
  GstPluginFeature* parser = gst_registry_lookup_feature(registry, "jpegparse");
  GstPluginFeature* decoder = gst_registry_lookup_feature(registry, "avdec_mjpeg");
  for (GstPluginFeature* feature : {parser, decoder}) {
    if (parser && decoder) gst_plugin_feature_set_rank(feature, GST_RANK_PRIMARY + 1);
  }
  gst_clear_object(&parser);
  gst_clear_object(&decoder);
}

Input camera(const std::string& device) {
  if (access(device.c_str(), F_OK) != 0) {
    std::string text = "there is no camera " + device;
    text += access("/dev/video0", F_OK) == 0
                ? "; `ls /dev/video*` lists those that are there"
                : ", nor /dev/video0: is a camera plugged in, and its driver loaded?";
    throw std::runtime_error(text);
  }
  if (access(device.c_str(), R_OK | W_OK) != 0)
    throw std::runtime_error("no permission to open " + device +
                             "; join the group video: sudo adduser $USER video, then log in again");
  return {true, device, device};
}

Input uri(const std::string& text) {
  gchar* protocol = gst_uri_get_protocol(text.c_str());
  const std::string name = protocol ? protocol : "";
  g_free(protocol);
  if (!gst_uri_protocol_is_supported(GST_URI_SRC, name.c_str()))
    throw std::runtime_error("nothing installed here opens \"" + name + "://\" (" + text +
                             "); file://, and with gstreamer1.0-plugins-good http://, https:// "
                             "and rtsp:// are known");
  if (name == "file") {
    gchar* path = g_filename_from_uri(text.c_str(), nullptr, nullptr);
    const bool there = path && access(path, R_OK) == 0;
    g_free(path);
    if (!there) throw std::runtime_error("cannot read " + text);
    play_no_lists();
  }
  return {false, text, text};
}

Input file(const std::string& path) {
  struct stat status;
  if (stat(path.c_str(), &status) != 0) throw std::runtime_error("there is no file " + path);
  if (S_ISDIR(status.st_mode))
    throw std::runtime_error(path + " is a folder; inverse-transcode takes folders");
  if (access(path.c_str(), R_OK) != 0) throw std::runtime_error("no permission to read " + path);
  if (S_ISREG(status.st_mode) && status.st_size == 0) throw std::runtime_error(path + " is empty");
  GError* error = nullptr;
  gchar* location = gst_filename_to_uri(path.c_str(), &error);
  if (!location) {
    const std::string reason = error ? error->message : "";
    g_clear_error(&error);
    throw std::runtime_error("cannot open " + path + ": " + reason);
  }
  play_no_lists();
  Input input{false, location, path};
  g_free(location);
  return input;
}

}  // namespace

bool is_list(const GstCaps* caps) {
  const char* name = gst_structure_get_name(gst_caps_get_structure(caps, 0));
  return std::find(std::begin(kLists), std::end(kLists), std::string(name)) != std::end(kLists);
}

Input parse_input(const std::string& text) {
  prefer_decoders();
  if (text.rfind("/dev/video", 0) == 0) return camera(text);
  if (gst_uri_is_valid(text.c_str())) return uri(text);
  return file(text);
}

}  // namespace inverse::run
