// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <netinet/in.h>
#include <sys/socket.h>

#include <cstdint>
#include <string>

#include "descriptor.hpp"

namespace inverse::udp {

struct Address {
  sockaddr_storage storage{};
  socklen_t size = 0;
  int family() const { return storage.ss_family; }
};

/// Resolves "host", "host:port" or "[v6]:port", a name or an address; `port` is the default. An
/// empty host is any address of this machine. Throws Error(unsupported) if `text` is malformed, and
/// Error(connection) if the name is unknown.
Address resolve(const std::string& text, uint16_t port);
/// An IPv4 address (host byte order) and a port.
Address ipv4(uint32_t address, uint16_t port);

/// A UDP socket; throws Error(connection).
Descriptor open(int family);

/// Parses the IPv4 address of an interface; throws Error(unsupported).
in_addr interface_of(const std::string& address);

}  // namespace inverse::udp
