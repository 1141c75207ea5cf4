// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sacn_sources.hpp"

#include <algorithm>
#include <charconv>
#include <cstring>
#include <optional>
#include <sstream>

#include "common/error.hpp"
#include "udp.hpp"

namespace inverse::sacn {
namespace {

/// A CID of 32 hexadecimal digits, with hyphens anywhere.
std::optional<Cid> cid_of(std::string text) {
  std::erase(text, '-');
  Cid cid{};
  if (text.size() != 2 * cid.size()) return {};
  for (size_t i = 0; i < cid.size(); ++i) {
    const char *from = text.data() + 2 * i, *to = from + 2;
    if (std::from_chars(from, to, cid[i], 16).ptr != to) return {};
  }
  return cid;
}

}  // namespace

Host host_of(const sockaddr_storage& address) {
  Host host{};
  if (address.ss_family == AF_INET6) {
    memcpy(host.data(), &reinterpret_cast<const sockaddr_in6&>(address).sin6_addr, host.size());
    return host;
  }
  host[10] = host[11] = 0xff;
  memcpy(&host[12], &reinterpret_cast<const sockaddr_in&>(address).sin_addr, 4);
  return host;
}

AllowedSources::AllowedSources(const std::string& text) {
  std::istringstream parts(text);
  for (std::string part; std::getline(parts, part, ',');) {
    std::erase(part, ' ');
    if (part.empty())
      throw Error(ErrorKind::unsupported,
                  "\"" + text +
                      "\" is no list of sACN sources: give addresses or CIDs with commas between");
    if (const auto cid = cid_of(part))
      cids_.push_back(*cid);
    else
      hosts_.push_back(host_of(udp::resolve(part, kPort).storage));
  }
}

bool AllowedSources::contains(const Cid& cid, const Host& host) const {
  return (cids_.empty() && hosts_.empty()) || std::ranges::count(cids_, cid) ||
         std::ranges::count(hosts_, host);
}

}  // namespace inverse::sacn
