// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "graph.hpp"

namespace inverse::network {

/// The flat file format of a graph (extension .net), loaded without a parser of a foreign format.
/// Little-endian:
///
///     8 bytes  "INVERSEN"
///     u32      version, 1
///     u32      0
///     u64      bytes that follow this header
///     u64      FNV-1a of them
///     then     inputs, nodes, outputs, weights: a u32 count before each list (weights: u64), text
///              as u32 length and bytes, all else as u32 or f32 (Node::weights: u64)
std::vector<std::byte> to_file(const Graph& graph);

/// Reads such a file and validates it. Messages call it `name`. Throws Error(file) if it is
/// truncated, corrupted, of another version, or does not hold a valid graph.
Graph from_file(std::span<const std::byte> bytes, const std::string& name);

/// The same from disk; also throws if the file cannot be read.
Graph load(const std::string& path);

}  // namespace inverse::network
