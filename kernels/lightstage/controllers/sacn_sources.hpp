// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "sacn_packet.hpp"

struct sockaddr_storage;

namespace inverse::sacn {

/// The address that packets came from, as IPv6; IPv4 is ::ffff:a.b.c.d.
using Host = std::array<uint8_t, 16>;
Host host_of(const sockaddr_storage& address);

/// The sources that a receiver accepts: E1.31 has no proof of who sends, and whoever sends at a
/// higher priority wins. If none is listed, all.
class AllowedSources {
 public:
  AllowedSources() = default;
  /// `text`: addresses or names of hosts, and CIDs (UUIDs, with hyphens or without), with commas
  /// between. Throws Error(unsupported) if it is malformed, Error(connection) for unknown names.
  explicit AllowedSources(const std::string& text);

  bool contains(const Cid& cid, const Host& host) const;

 private:
  std::vector<Cid> cids_;
  std::vector<Host> hosts_;
};

}  // namespace inverse::sacn
