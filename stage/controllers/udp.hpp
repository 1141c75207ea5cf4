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

/// "host", "host:port", "[v6]:port": a name or an address; `port` where it has none. An empty host
/// is any address of this machine. Throws Error(unsupported) where it cannot be read, and
/// Error(connection) where the name is not known.
Address resolve(const std::string& text, uint16_t port);
/// An IPv4 address (host byte order) and a port.
Address ipv4(uint32_t address, uint16_t port);

/// A UDP socket; throws Error(connection).
Descriptor open(int family);

/// Takes an interface's IPv4 address; throws Error(unsupported).
in_addr interface_of(const std::string& address);

}  // namespace inverse::udp
