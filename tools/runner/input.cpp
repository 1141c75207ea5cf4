// SPDX-License-Identifier: LGPL-2.1-or-later
#include "input.hpp"

#include <gst/gst.h>
#include <sys/stat.h>
#include <unistd.h>

#include <stdexcept>

namespace inverse::run {
namespace {

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
  Input input{false, location, path};
  g_free(location);
  return input;
}

}  // namespace

Input parse_input(const std::string& text) {
  if (text.rfind("/dev/video", 0) == 0) return camera(text);
  if (gst_uri_is_valid(text.c_str())) return uri(text);
  return file(text);
}

}  // namespace inverse::run
