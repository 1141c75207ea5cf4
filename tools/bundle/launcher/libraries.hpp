// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace inverse::bundle {

/// A library, or the parts of the C library, that the bundle shares with the host's Vulkan driver.
struct Shared {
  std::string name;
  std::filesystem::path host;  ///< of its first file; empty if the host has none
  std::string lacks;           ///< a symbol that the host's has not and the bundle needs
  bool from_host() const { return !host.empty() && lacks.empty(); }
};

struct Libraries {
  std::filesystem::path loader;  ///< the dynamic loader that goes with the C library in use
  std::string path;              ///< where it looks first, as in LD_LIBRARY_PATH
  std::vector<Shared> shared;
};

/// Chooses between the host's libraries and those in `folder`/lib: the host's, which its Vulkan
/// driver was built for, unless they lack what the bundle needs.
Libraries choose_libraries(const std::filesystem::path& folder);

}  // namespace inverse::bundle
