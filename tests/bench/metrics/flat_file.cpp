// SPDX-License-Identifier: LGPL-2.1-or-later
#include "flat_file.hpp"

#include <bit>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace inverse::bench {
namespace {

static_assert(std::endian::native == std::endian::little);

[[noreturn]] void fail(const std::string& path, const std::string& what) {
  throw std::runtime_error(path + ": " + what);
}

}  // namespace

FlatFile read_flat(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  std::string line, magic;
  std::getline(stream, line);
  std::istringstream words(line);
  int width = 0, height = 0, channels = 0, frames = 0;
  words >> magic >> width >> height >> channels >> frames;
  if (!words || magic != "F32" || width < 1 || height < 1 || channels < 1 || frames < 0)
    fail(path, "not a flat dump");
  FlatFile file;
  std::getline(words >> std::ws, file.words);
  for (int k = 0; k < frames; ++k) {
    Image image(width, height, channels);
    stream.read(reinterpret_cast<char*>(image.data.data()),
                std::streamsize(image.data.size() * sizeof(float)));
    if (!stream) fail(path, "ends inside a frame");
    file.frames.push_back(std::move(image));
  }
  return file;
}

void write_flat(const std::string& path, const FlatFile& file) {
  if (file.frames.empty()) fail(path, "a flat dump needs a frame");
  const Image& first = file.frames.front();
  std::ofstream stream(path, std::ios::binary);
  stream << "F32 " << first.width << ' ' << first.height << ' ' << first.channels << ' '
         << file.frames.size() << (file.words.empty() ? "" : " ") << file.words << '\n';
  for (const Image& image : file.frames)
    stream.write(reinterpret_cast<const char*>(image.data.data()),
                 std::streamsize(image.data.size() * sizeof(float)));
  if (!stream.flush()) fail(path, "cannot be written");
}

Image channels(const Image& image, int first, int count) {
  Image out(image.width, image.height, count);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      for (int c = 0; c < count; ++c) out.at(x, y, c) = image.at(x, y, first + c);
  return out;
}

Image stacked(const std::vector<const Image*>& images) {
  int total = 0;
  for (const Image* image : images) total += image->channels;
  Image out(images.front()->width, images.front()->height, total);
  int first = 0;
  for (const Image* image : images) {
    for (int y = 0; y < out.height; ++y)
      for (int x = 0; x < out.width; ++x)
        for (int c = 0; c < image->channels; ++c) out.at(x, y, first + c) = image->at(x, y, c);
    first += image->channels;
  }
  return out;
}

}  // namespace inverse::bench
