// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sacn_receiver.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>

#include "common/error.hpp"
#include "udp.hpp"

namespace inverse::sacn {
namespace {

constexpr int kMaxDatagramsPerPoll = 4096;  // so that a flood cannot block poll()

double now_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

uint16_t port_of(const sockaddr_storage& address) {
  if (address.ss_family == AF_INET)
    return ntohs(reinterpret_cast<const sockaddr_in&>(address).sin_port);
  return ntohs(reinterpret_cast<const sockaddr_in6&>(address).sin6_port);
}

/// Whether a socket bound to this address receives packets to multicast groups.
bool receives_multicast(const sockaddr_storage& address) {
  if (address.ss_family != AF_INET) return false;
  const uint32_t host = ntohl(reinterpret_cast<const sockaddr_in&>(address).sin_addr.s_addr);
  return host == INADDR_ANY || IN_MULTICAST(host);
}

void join(int socket, uint32_t universe) {
  ip_mreq request{};
  request.imr_multiaddr.s_addr = htonl(multicast_group(static_cast<uint16_t>(universe)));
  if (setsockopt(socket, IPPROTO_IP, IP_ADD_MEMBERSHIP, &request, sizeof request) != 0 &&
      errno != EADDRINUSE && errno != ENODEV)  // ENODEV: no network; unicast still works
    throw Error(ErrorKind::connection, "cannot join the multicast group of sACN universe " +
                                           std::to_string(universe) + ": " + strerror(errno));
}

bool expired(double last, double now) { return now - last > kDataLossTimeout; }

}  // namespace

Universes::Universes(std::span<const uint32_t> universes, AllowedSources allowed)
    : allowed_(std::move(allowed)) {
  for (const uint32_t universe : universes) universes_[universe];
}

void Universes::take(std::span<const uint8_t> datagram, const Host& from, double now) {
  const Parsed parsed = parse(datagram);
  const Cid* cid = parsed.data ? &parsed.data->cid : parsed.sync ? &parsed.sync->cid : nullptr;
  if (!cid)
    ++stats_.malformed;
  else if (!allowed_.contains(*cid, from))
    ++stats_.other;
  else if (parsed.data)
    take(*parsed.data, {*cid, from}, now);
  else
    take(*parsed.sync, {*cid, from}, now);
}

void Universes::take(const DataPacket& packet, const Key& key, double now) {
  const auto universe = universes_.find(packet.universe);
  if (universe == universes_.end() || packet.preview || packet.start_code != 0) {
    ++stats_.other;
    return;
  }
  Sources& sources = universe->second;
  std::erase_if(sources, [&](const auto& s) { return expired(s.second.last_packet, now); });
  const auto known = sources.find(key);
  if (known != sources.end() && !in_order(known->second.sequence, packet.sequence)) {
    ++stats_.late;
    return;
  }
  if (packet.terminated) {
    if (known != sources.end()) sources.erase(known);
    ++stats_.packets;
    return;
  }
  if (known == sources.end() && !make_room(sources, packet.priority)) {
    ++stats_.other;
    return;
  }
  Source& source = sources[key];
  if (known == sources.end()) source.since = stats_.packets;
  if (source.sync_address != packet.sync_address) source.last_sync.reset();
  source.priority = packet.priority;
  source.sequence = packet.sequence;
  source.last_packet = now;
  source.sync_address = packet.sync_address;
  DmxUniverse levels{};
  std::copy(packet.slots.begin(), packet.slots.end(), levels.begin());
  // Without recent synchronization packets, data takes effect at once.
  source.waits = packet.sync_address && source.last_sync && !expired(source.last_sync->time, now);
  (source.waits ? source.waiting : source.levels) = levels;
  ++stats_.packets;
}

/// For a new source of this priority; false if there is none.
bool Universes::make_room(Sources& sources, uint8_t priority) {
  if (sources.size() < kMaxSources) return true;
  const auto last = std::ranges::min_element(sources, [](const auto& a, const auto& b) {
    return a.second.priority != b.second.priority ? a.second.priority < b.second.priority
                                                  : a.second.since > b.second.since;
  });
  if (last->second.priority >= priority) return false;
  sources.erase(last);
  return true;
}

void Universes::take(const SyncPacket& packet, const Key& key, double now) {
  bool known = false, late = false;
  for (auto& [universe, sources] : universes_) {
    const auto found = sources.find(key);
    if (found == sources.end() || found->second.sync_address != packet.address) continue;
    known = true;
    Source& source = found->second;
    if (source.last_sync && !in_order(source.last_sync->sequence, packet.sequence) &&
        !expired(source.last_sync->time, now)) {
      late = true;
      continue;
    }
    source.last_sync = {packet.sequence, now};
    if (source.waits) source.levels = source.waiting;
    source.waits = false;
  }
  ++(late ? stats_.late : known ? stats_.packets : stats_.other);
}

std::map<uint32_t, DmxUniverse> Universes::levels(double now) {
  std::map<uint32_t, DmxUniverse> result;
  for (auto& [universe, sources] : universes_) {
    std::erase_if(sources, [&](const auto& s) { return expired(s.second.last_packet, now); });
    const Source* best = nullptr;
    for (const auto& [key, source] : sources)
      if (!best || source.priority > best->priority ||
          (source.priority == best->priority && source.since < best->since))
        best = &source;
    result[universe] = best ? best->levels : DmxUniverse{};
  }
  return result;
}

Receiver::Receiver(const std::string& listen, std::span<const uint32_t> universes,
                   uint32_t sync_universe, AllowedSources allowed)
    : universes_(universes, std::move(allowed)) {
  const udp::Address address = udp::resolve(listen, kPort);
  Descriptor socket = udp::open(address.family());
  // No port sharing: unicast packets would reach only one of the programs.
  if (bind(socket.get(), reinterpret_cast<const sockaddr*>(&address.storage), address.size) != 0)
    throw Error(ErrorKind::connection,
                "cannot listen for sACN on \"" + listen + "\": " + strerror(errno) +
                    (errno == EADDRINUSE
                         ? "; another program listens on this port: end it, or name another port"
                         : "; give an address of this machine, or only a port as in :5568"));
  if (receives_multicast(address.storage)) {
    // Only the groups that are joined here, not those of other programs on this machine.
    const int all = 0;
    setsockopt(socket.get(), IPPROTO_IP, IP_MULTICAST_ALL, &all, sizeof all);
    for (const uint32_t universe : universes) join(socket.get(), universe);
    if (sync_universe) join(socket.get(), sync_universe);
  }
  sockaddr_storage bound{};
  socklen_t size = sizeof bound;
  getsockname(socket.get(), reinterpret_cast<sockaddr*>(&bound), &size);
  port_ = port_of(bound);
  socket_ = std::move(socket);
}

void Receiver::poll() {
  std::array<uint8_t, 2048> datagram;
  for (int i = 0; i < kMaxDatagramsPerPoll; ++i) {
    sockaddr_storage from{};
    socklen_t length = sizeof from;
    const ssize_t size = recvfrom(socket_.get(), datagram.data(), datagram.size(), 0,
                                  reinterpret_cast<sockaddr*>(&from), &length);
    if (size < 0 && errno != EINTR) break;
    if (size >= 0)
      universes_.take(std::span(datagram).first(static_cast<size_t>(size)), host_of(from),
                      now_seconds());
  }
}

std::map<uint32_t, DmxUniverse> Receiver::levels() { return universes_.levels(now_seconds()); }

}  // namespace inverse::sacn
