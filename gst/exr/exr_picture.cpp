// SPDX-License-Identifier: LGPL-2.1-or-later
#include "exr_picture.hpp"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfTileDescription.h>

#include <algorithm>
#include <array>

#include "common/error.hpp"
#include "exr_stream.hpp"

namespace inverse {
namespace {

/// The channels that are red, green and blue.
std::array<const char*, 3> channels_of(const Imf::Header& header, const std::string& name) {
  const Imf::ChannelList& channels = header.channels();
  if (channels.findChannel("R") && channels.findChannel("G") && channels.findChannel("B"))
    return {"R", "G", "B"};
  if (channels.findChannel("Y") && !channels.findChannel("RY")) return {"Y", "Y", "Y"};
  std::string there;
  for (auto c = channels.begin(); c != channels.end(); ++c)
    there += (there.empty() ? "" : ", ") + std::string(c.name());
  throw Error(ErrorKind::file, name + " has no channels R, G and B but " +
                                   (there.empty() ? "none" : there) +
                                   ": store the picture under these names");
}

/// Runs `act`; what OpenEXR throws becomes an Error.
template <typename Act>
auto read(const std::string& name, Act act) {
  try {
    return act();
  } catch (const Error&) {
    throw;
  } catch (const std::exception& error) {
    throw Error(ErrorKind::file, name + " cannot be read as OpenEXR: " + error.what());
  }
}

}  // namespace

ExrPicture::ExrPicture(const std::string& path, std::string name, int64_t max_side)
    : ExrPicture(std::make_shared<const OpenFile>(path), std::move(name), max_side) {}

ExrPicture::ExrPicture(std::shared_ptr<const OpenFile> file, std::string name, int64_t max_side)
    : name_(std::move(name)) {
  if (!file->fault().empty()) throw Error(ErrorKind::file, name_ + " " + file->fault());
  read(name_, [&] {
    check_header(file, max_side);
    stream_ = std::make_unique<ExrReader>(std::move(file), name_);
    file_ = std::make_unique<Imf::InputFile>(*stream_);
    extent_ = extent_of(file_->header(), max_side);
    channels_of(file_->header(), name_);
  });
}

ExrPicture::~ExrPicture() = default;

/// OpenEXR takes memory for lines and tiles when it opens a file.
void ExrPicture::check_header(const std::shared_ptr<const OpenFile>& file, int64_t max_side) const {
  constexpr uint64_t kVersionAt = 4, kHeaderAt = 8;
  ExrReader stream(file, name_);
  int version = 0;
  if (file->read(kVersionAt, &version, sizeof version) != sizeof version)
    throw Error(ErrorKind::file, name_ + " cannot be read as OpenEXR: it ends too early");
  stream.seekg(kHeaderAt);
  Imf::Header header;
  header.readFrom(stream, version);
  const Extent extent = extent_of(header, max_side);
  if (!header.hasTileDescription()) return;
  constexpr uint32_t kMaxTile = 4096;
  const Imf::TileDescription& tile = header.tileDescription();
  if (tile.xSize > std::max(extent.width, kMaxTile) ||
      tile.ySize > std::max(extent.height, kMaxTile))
    throw Error(ErrorKind::file, name_ + " has tiles of " + std::to_string(tile.xSize) + "x" +
                                     std::to_string(tile.ySize) +
                                     " pixels, more than the picture: store it again");
}

Extent ExrPicture::extent_of(const Imf::Header& header, int64_t max_side) const {
  const Imath::Box2i& window = header.dataWindow();
  const int64_t width = int64_t{window.max.x} - window.min.x + 1;
  const int64_t height = int64_t{window.max.y} - window.min.y + 1;
  if (width < 1 || height < 1 || width > max_side || height > max_side)
    throw Error(ErrorKind::file, name_ + " is " + std::to_string(width) + "x" +
                                     std::to_string(height) + "; pictures have up to " +
                                     std::to_string(max_side) + " pixels along a side");
  return {static_cast<uint32_t>(width), static_cast<uint32_t>(height)};
}

std::vector<float> ExrPicture::rgb() {
  return read(name_, [&] {
    const Imath::Box2i& window = file_->header().dataWindow();
    const size_t width = extent_.width;
    std::vector<float> rgb(3 * extent_.pixels());
    Imf::FrameBuffer target;
    const auto names = channels_of(file_->header(), name_);
    const bool gray = names[0] == names[1];
    constexpr size_t kPixel = 3 * sizeof(float);
    for (size_t c = 0; c < (gray ? 1 : 3); ++c) {
      // Where pixel (0, 0) would be, which need not be in the window.
      const auto start = reinterpret_cast<intptr_t>(&rgb[c]) -
                         (window.min.x + window.min.y * static_cast<intptr_t>(width)) *
                             static_cast<intptr_t>(kPixel);
      target.insert(names[c],
                    Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(start), kPixel, kPixel * width));
    }
    file_->setFrameBuffer(target);
    file_->readPixels(window.min.y, window.max.y);
    if (gray)
      for (size_t i = 0; i < rgb.size(); i += 3) rgb[i + 1] = rgb[i + 2] = rgb[i];
    return rgb;
  });
}

}  // namespace inverse
