// SPDX-License-Identifier: LGPL-2.1-or-later
#include "udp.hpp"

#include <arpa/inet.h>
#include <netdb.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <memory>

#include "common/error.hpp"

namespace inverse::udp {
namespace {

struct Parts {
  std::string host, port;
};

Parts split(const std::string& text) {
  if (text.starts_with('[')) {
    const size_t end = text.find(']');
    if (end != std::string::npos && (end + 1 == text.size() || text[end + 1] == ':'))
      return {text.substr(1, end - 1), end + 2 <= text.size() ? text.substr(end + 2) : ""};
  }
  const size_t colon = text.find(':');
  if (colon == std::string::npos || text.find(':', colon + 1) != std::string::npos)
    return {text, ""};  // a bare IPv6 address has more than one
  return {text.substr(0, colon), text.substr(colon + 1)};
}

}  // namespace

Address resolve(const std::string& text, uint16_t port) {
  Parts parts = split(text);
  if (parts.port.empty()) parts.port = std::to_string(port);
  uint16_t number = 0;
  const char* end = parts.port.data() + parts.port.size();
  if (const auto read = std::from_chars(parts.port.data(), end, number);
      read.ec != std::errc{} || read.ptr != end)
    throw Error(ErrorKind::unsupported,
                "\"" + text + "\": the port is a number up to 65535, as in 192.168.1.20:5568");
  addrinfo hints{};
  hints.ai_socktype = SOCK_DGRAM;
  hints.ai_flags = AI_NUMERICSERV;  // without a host: this machine alone
  hints.ai_family = parts.host.empty() ? AF_INET : AF_UNSPEC;
  addrinfo* found = nullptr;
  const int status = getaddrinfo(parts.host.empty() ? nullptr : parts.host.c_str(),
                                 parts.port.c_str(), &hints, &found);
  if (status != 0)
    throw Error(ErrorKind::connection, "cannot find the host \"" + parts.host +
                                           "\": " + gai_strerror(status) +
                                           "; give an address such as 192.168.1.20");
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> keep(found, freeaddrinfo);
  Address address;
  memcpy(&address.storage, found->ai_addr, found->ai_addrlen);
  address.size = found->ai_addrlen;
  return address;
}

Address ipv4(uint32_t address, uint16_t port) {
  sockaddr_in in{};
  in.sin_family = AF_INET;
  in.sin_addr.s_addr = htonl(address);
  in.sin_port = htons(port);
  Address result;
  memcpy(&result.storage, &in, sizeof in);
  result.size = sizeof in;
  return result;
}

Descriptor open(int family) {
  Descriptor socket(::socket(family, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (!socket)
    throw Error(ErrorKind::connection, std::string("cannot open a UDP socket: ") + strerror(errno));
  return socket;
}

in_addr interface_of(const std::string& address) {
  in_addr result{};
  if (inet_pton(AF_INET, address.c_str(), &result) != 1)
    throw Error(ErrorKind::unsupported, "\"" + address +
                                            "\" is no IPv4 address of a network interface, such "
                                            "as 192.168.1.2");
  return result;
}

}  // namespace inverse::udp
