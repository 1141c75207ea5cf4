// SPDX-License-Identifier: LGPL-2.1-or-later
#include "clone_light.hpp"

#include <cstring>
#include <utility>
#include <vector>

#include "gst/exr/environment_file.hpp"

namespace inverse {
namespace {

/// The light in a meta.
Environment environment_of(const GstMaterialMeta& meta) {
  const Extent extent{meta.environment_width, meta.environment_height};
  gsize bytes = 0;
  const void* data = g_bytes_get_data(meta.environment, &bytes);
  std::vector<float> rgb(bytes / sizeof(float));
  if (!rgb.empty()) memcpy(rgb.data(), data, rgb.size() * sizeof(float));
  return {extent, std::move(rgb), "the estimated environment map"};
}

}  // namespace

void CloneLight::start(const std::string& file, std::string& warning) {
  warning.clear();
  given_.reset();
  stream_environment_.reset();
  estimated_.reset();
  if (!file.empty()) given_.emplace(load_environment(file, warning));
}

void CloneLight::begin(LitSphere& sphere) {
  light_.reset();
  if (!given_) return choose(sphere);
  sphere.set_light(*given_);
  from_ = "file";
}

bool CloneLight::is_new(const GstMaterialMeta* meta) const {
  // Maps are large to compare, so a map that is the same object counts as unchanged.
  return !given_ && meta && meta->environment && meta->environment != stream_environment_.get();
}

void CloneLight::ignore(const GstMaterialMeta* meta) {
  if (is_new(meta))
    stream_environment_.reset(
        g_bytes_ref(meta->environment));  // a reference, so that no other map gets its address
}

bool CloneLight::take(const GstMaterialMeta* meta, LitSphere& sphere) {
  if (!is_new(meta)) return false;
  ignore(meta);
  estimated_ = environment_of(*meta);
  choose(sphere);
  return true;
}

void CloneLight::choose(LitSphere& sphere) {
  const Environment& now = estimated_ ? *estimated_ : studio_;
  if (light_ && alike(now, *light_)) return;
  sphere.set_light(now);
  light_ = now;
  from_ = estimated_ ? "estimate" : "studio";
}

}  // namespace inverse
