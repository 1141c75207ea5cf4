// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>

#include "new_file.hpp"

namespace inverse {

/// Writes a file that takes the place of one of its name once it is whole, with the permissions of
/// that. Throws Error(output).
inline void replace_file(const std::filesystem::path& target, std::string_view bytes) {
  static std::atomic<unsigned> drafts{0};  // others may save to the same file meanwhile
  std::error_code none;
  const bool there = std::filesystem::exists(target, none);
  NewFile draft(target.string() + "." + std::to_string(getpid()) + "-" + std::to_string(drafts++) +
                ".new");
  try {
    draft.write(0, bytes.data(), bytes.size());
    draft.close();
    if (there)
      std::filesystem::permissions(draft.path(),
                                   std::filesystem::status(target, none).permissions(), none);
    if (std::rename(draft.path().c_str(), target.c_str()) != 0)
      throw Error(ErrorKind::output,
                  "cannot write " + target.string() + ": " + std::strerror(errno));
  } catch (const Error&) {
    std::remove(draft.path().c_str());
    throw;
  }
}

}  // namespace inverse
