// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <filesystem>
#include <set>
#include <string>

namespace inverse::bundle {

/// Symbols that a shared library defines for others, as NAME@VERSION, or NAME if it has no version.
/// Empty if the file cannot be read, or is no 64-bit little-endian ELF library with a symbol table.
std::set<std::string, std::less<>> defined_symbols(const std::filesystem::path& path);

}  // namespace inverse::bundle
