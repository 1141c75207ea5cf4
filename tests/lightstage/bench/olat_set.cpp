// SPDX-License-Identifier: LGPL-2.1-or-later
#include "olat_set.hpp"

#include <filesystem>
#include <sstream>
#include <stdexcept>

#include "tests/bench/metrics/flat_file.hpp"

namespace inverse::bench {

void write_olat_set(const std::string& path, const OlatSet& set) {
  FlatFile file;
  std::ostringstream words;
  words.precision(9);
  for (const auto& w : set.directions) words << ' ' << w[0] << ' ' << w[1] << ' ' << w[2];
  file.words = words.str().substr(1);
  Image mask(set.mask.width, set.mask.height, 3);
  for (size_t i = 0; i < mask.data.size(); ++i) mask.data[i] = set.mask.data[i / 3];
  file.frames = {set.a, set.b, mask};
  file.frames.insert(file.frames.end(), set.lights.begin(), set.lights.end());
  write_flat(path, file);
}

OlatSet read_olat_set(const std::string& path) {
  FlatFile file = read_flat(path);
  OlatSet set;
  set.name = std::filesystem::path(path).stem().string();
  std::istringstream words(file.words);
  for (std::array<double, 3> w; words >> w[0] >> w[1] >> w[2];) set.directions.push_back(w);
  if (file.frames.size() != set.directions.size() + 3 || file.frames[0].channels != 3 ||
      set.directions.empty())
    throw std::runtime_error(path + " holds no pictures of single lights; import-olat makes such");
  set.a = std::move(file.frames[0]);
  set.b = std::move(file.frames[1]);
  set.mask = channels(file.frames[2], 0, 1);
  set.lights.assign(std::make_move_iterator(file.frames.begin() + 3),
                    std::make_move_iterator(file.frames.end()));
  return set;
}

}  // namespace inverse::bench
