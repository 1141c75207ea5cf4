// SPDX-License-Identifier: LGPL-2.1-or-later
#include "olat_stack.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <string>

#include "common/error.hpp"
#include "half.hpp"

namespace inverse {
namespace {

constexpr uint64_t kWordsPerPixel = 2;
constexpr size_t kFewLights = 8;  // up to so many, a sum is faster than a lookup
constexpr size_t kMaxSums = 8;
constexpr uint64_t kMiB = uint64_t{1} << 20;

std::string mib(uint64_t bytes) { return std::to_string((bytes + kMiB - 1) / kMiB) + " MiB"; }

}  // namespace

uint64_t OlatStack::bytes(Extent extent, uint64_t lights) {
  return extent.pixels() * kWordsPerPixel * 4 * lights;
}

OlatStack::OlatStack(std::shared_ptr<gpu::Device> device, Extent extent, uint32_t lights,
                     uint64_t max_bytes)
    : device_(std::move(device)),
      extent_(extent),
      lights_(lights),
      weigh_(device_),
      planes_(device_, extent) {
  const uint64_t all = bytes(extent, lights), one = bytes(extent, 1);
  if (all > max_bytes)
    throw Error(ErrorKind::limit,
                std::to_string(lights) + " images of " + std::to_string(extent.width) + "x" +
                    std::to_string(extent.height) + " under one light each take " + mib(all) +
                    ", the limit is " + mib(max_bytes) +
                    "; use a smaller frame, a program with fewer lights (such as "
                    "program=performance:96), or raise stack-limit");
  const uint64_t bindable =
      std::min(device_->limits().storage_buffer_bytes, 4 * device_->limits().texel_elements);
  if (one > bindable)
    throw Error(ErrorKind::limit, "an image of " + std::to_string(extent.width) + "x" +
                                      std::to_string(extent.height) + " takes " + mib(one) +
                                      ", the device binds " + mib(bindable) +
                                      " at once; use a smaller frame");
  const auto max_count = static_cast<uint32_t>(std::min<uint64_t>(bindable / one, lights));
  for (uint32_t first = 0; first < lights; first += max_count) {
    const uint32_t count = std::min(max_count, lights - first);
    chunks_.push_back({first, count,
                       gpu::Buffer::create(device_, gpu::Element::word,
                                           count * extent.pixels() * kWordsPerPixel)});
  }
}

void OlatStack::load(uint32_t light, std::span<const float> rgb) {
  if (light >= lights_ || rgb.size() != 3 * extent_.pixels())
    throw Error(ErrorKind::internal, "an OLAT image of another stack");
  const uint64_t words = extent_.pixels() * kWordsPerPixel;
  const auto staged = gpu::Buffer::create(device_, gpu::Element::word, words, gpu::Memory::upload);
  auto* to = staged->map_as<uint32_t>();
  for (uint64_t i = 0; i < extent_.pixels(); ++i) {
    const float* p = &rgb[3 * i];
    to[2 * i] = to_half(p[0]) | uint32_t{to_half(p[1])} << 16;
    to[2 * i + 1] = to_half(p[2]);
  }
  const auto chunk = std::find_if(chunks_.begin(), chunks_.end(),
                                  [&](const Chunk& c) { return light < c.first + c.count; });
  gpu::Commands commands(device_);
  commands.begin();
  commands.copy(staged, chunk->images, 4 * words, 0, 4 * words * (light - chunk->first));
  commands.submit();
  commands.wait();
}

PlanePtr OlatStack::record(gpu::Commands& commands, std::span<const LightColor> colors) {
  if (colors.size() != lights_)
    throw Error(ErrorKind::internal, "colors of another number of lights than images");
  // The lights that are on, chunk by chunk.
  std::vector<std::array<float, 4>> list;
  std::vector<uint32_t> counts;
  for (const Chunk& chunk : chunks_) {
    const size_t before = list.size();
    for (uint32_t i = 0; i < chunk.count; ++i) {
      const LightColor& c = colors[chunk.first + i];
      if (c != LightColor{}) list.push_back({c[0], c[1], c[2], static_cast<float>(i)});
    }
    counts.push_back(static_cast<uint32_t>(list.size() - before));
  }
  const bool many = list.size() > kFewLights;
  if (many) {
    const auto known = std::find_if(sums_.begin(), sums_.end(), [&](const Sum& s) {
      return std::equal(s.colors.begin(), s.colors.end(), colors.begin(), colors.end());
    });
    if (known != sums_.end()) {
      sums_.splice(sums_.begin(), sums_, known);
      ++taken_again_;
      return known->plane;
    }
    ++made_;
  }
  PlanePtr plane = planes_.acquire();
  commands.write_table(table_, gpu::Element::vec4, list);
  const auto pixels = static_cast<uint32_t>(extent_.pixels());
  uint32_t first = 0;
  bool add = false;
  for (size_t i = 0; i < chunks_.size(); ++i) {
    if (counts[i] == 0 && (add || i + 1 < chunks_.size())) continue;  // once at least: black
    commands.dispatch(weigh_,
                      {.olats = chunks_[i].images, .colors = table_, .total = plane->buffer},
                      {.pixels = pixels, .first = first, .count = counts[i], .add = add}, {pixels});
    first += counts[i];
    add = true;
  }
  if (many) {
    sums_.push_front({{colors.begin(), colors.end()}, plane});
    if (sums_.size() > kMaxSums) sums_.pop_back();
  }
  return plane;
}

}  // namespace inverse
