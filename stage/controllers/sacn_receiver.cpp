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

constexpr size_t kMaxSources = 16;  // per universe; bounds memory under a flood of forged senders
constexpr size_t kMaxUniverses = 1024;
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

}  // namespace

void Universes::take(std::span<const uint8_t> datagram, double now) {
  const Parsed parsed = parse(datagram);
  if (parsed.data)
    take(*parsed.data, now);
  else if (parsed.sync)
    take(*parsed.sync, now);
  else
    ++stats_.malformed;
}

void Universes::take(const DataPacket& packet, double now) {
  // Not for every packet: there may be many.
  if (now - last_expiry_ > kDataLossTimeout) drop_expired(now);
  if (packet.preview || packet.start_code != 0 ||
      (!universes_.contains(packet.universe) && universes_.size() >= kMaxUniverses)) {
    ++stats_.other;
    return;
  }
  Sources& sources = universes_[packet.universe];
  auto known = sources.find(packet.cid);
  if (known != sources.end() && now - known->second.last_packet > kDataLossTimeout) {
    sources.erase(known);
    known = sources.end();
  }
  if (known != sources.end() && !in_order(known->second.sequence, packet.sequence)) {
    ++stats_.late;
    return;
  }
  if (packet.terminated) {
    if (known != sources.end()) sources.erase(known);
    ++stats_.packets;
    return;
  }
  if (known == sources.end() && sources.size() >= kMaxSources) {
    ++stats_.other;
    return;
  }
  Source& source = sources[packet.cid];
  if (known == sources.end()) source.since = stats_.packets;
  source.priority = packet.priority;
  source.sequence = packet.sequence;
  source.last_packet = now;
  source.sync_address = packet.sync_address;
  DmxUniverse levels{};
  std::copy(packet.slots.begin(), packet.slots.end(), levels.begin());
  // Without recent synchronization packets, data takes effect at once.
  const auto sync = syncs_.find({packet.cid, packet.sync_address});
  source.waits =
      packet.sync_address && sync != syncs_.end() && now - sync->second.second <= kDataLossTimeout;
  (source.waits ? source.waiting : source.levels) = levels;
  ++stats_.packets;
}

void Universes::take(const SyncPacket& packet, double now) {
  const auto key = std::pair(packet.cid, packet.address);
  const auto known = syncs_.find(key);
  if (known != syncs_.end() && !in_order(known->second.first, packet.sequence) &&
      now - known->second.second <= kDataLossTimeout) {
    ++stats_.late;
    return;
  }
  if (known == syncs_.end() && syncs_.size() >= kMaxUniverses) {
    ++stats_.other;
    return;
  }
  syncs_[key] = {packet.sequence, now};
  ++stats_.packets;
  for (auto& [universe, sources] : universes_) {
    const auto source = sources.find(packet.cid);
    if (source == sources.end() || !source->second.waits ||
        source->second.sync_address != packet.address)
      continue;
    source->second.levels = source->second.waiting;
    source->second.waits = false;
  }
}

void Universes::drop_expired(double now) {
  last_expiry_ = now;
  for (auto& [universe, sources] : universes_)
    std::erase_if(sources,
                  [&](const auto& s) { return now - s.second.last_packet > kDataLossTimeout; });
  std::erase_if(syncs_, [&](const auto& s) { return now - s.second.second > kDataLossTimeout; });
}

std::map<uint32_t, DmxUniverse> Universes::levels(double now) {
  drop_expired(now);
  std::map<uint32_t, DmxUniverse> result;
  for (const auto& [universe, sources] : universes_) {
    const Source* best = nullptr;
    for (const auto& [cid, source] : sources)
      if (!best || source.priority > best->priority ||
          (source.priority == best->priority && source.since < best->since))
        best = &source;
    result[universe] = best ? best->levels : DmxUniverse{};
  }
  return result;
}

Receiver::Receiver(const std::string& listen, std::span<const uint32_t> universes,
                   uint32_t sync_universe) {
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
    const ssize_t size = recv(socket_.get(), datagram.data(), datagram.size(), 0);
    if (size < 0 && errno != EINTR) break;
    if (size >= 0)
      universes_.take(std::span(datagram).first(static_cast<size_t>(size)), now_seconds());
  }
}

std::map<uint32_t, DmxUniverse> Receiver::levels() { return universes_.levels(now_seconds()); }

}  // namespace inverse::sacn
