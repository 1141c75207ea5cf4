// SPDX-License-Identifier: LGPL-2.1-or-later
// Light programs over streaming ACN.
#include <algorithm>
#include <cerrno>
#include <cstring>
#include <map>
#include <optional>
#include <random>

#include "common/error.hpp"
#include "light_drivers.hpp"
#include "repeating_driver.hpp"
#include "sacn_packet.hpp"
#include "udp.hpp"

namespace inverse {
namespace {

constexpr int kTerminations = 3;  // packets with Stream_Terminated (6.2.6)

sacn::Cid random_cid() {
  std::random_device random;
  sacn::Cid cid;
  for (uint8_t& byte : cid) byte = static_cast<uint8_t>(random());
  cid[6] = static_cast<uint8_t>((cid[6] & 0x0f) | 0x40);  // UUID of version 4 (RFC 4122)
  cid[8] = static_cast<uint8_t>((cid[8] & 0x3f) | 0x80);
  return cid;
}

void check(const LightDriverSettings::Dmx& dmx, const LightDriverSettings::Sacn& s) {
  const auto refuse = [](const std::string& text) { throw Error(ErrorKind::unsupported, text); };
  if (dmx.universe < sacn::kFirstUniverse || dmx.universe > sacn::kLastUniverse)
    refuse("there is no sACN universe " + std::to_string(dmx.universe) +
           "; they go from 1 to 63999");
  if (s.sync_universe > sacn::kLastUniverse)
    refuse("there is no sACN universe " + std::to_string(s.sync_universe) +
           " for synchronization; they go from 1 to 63999, 0 is without");
  if (dmx.priority > sacn::kMaxPriority)
    refuse("sACN priorities go from 0 to 200, not to " + std::to_string(dmx.priority));
}

class SacnDriver final : public RepeatingDriver {
 public:
  explicit SacnDriver(const LightDriverSettings& settings)
      : RepeatingDriver(settings.dmx.universe),
        priority_(settings.dmx.priority),
        settings_(settings.sacn) {
    check(settings.dmx, settings_);
    if (settings_.cid == sacn::Cid{}) settings_.cid = random_cid();
  }
  ~SacnDriver() override {
    try {
      black();
    } catch (const Error&) {
      // A destructor cannot throw; call black() first to receive errors.
    }
  }

 private:
  void open() override {
    if (socket_) return;
    std::optional<udp::Address> receiver;
    if (!settings_.destination.empty()) receiver = udp::resolve(settings_.destination, sacn::kPort);
    Descriptor socket = udp::open(receiver ? receiver->family() : AF_INET);
    if (!settings_.interface_address.empty()) {
      const in_addr address = udp::interface_of(settings_.interface_address);
      if (setsockopt(socket.get(), IPPROTO_IP, IP_MULTICAST_IF, &address, sizeof address) != 0)
        throw Error(ErrorKind::connection, "no network interface has the address " +
                                               settings_.interface_address + ": " +
                                               strerror(errno));
    }
    receiver_ = receiver;
    socket_ = std::move(socket);
  }

  void send(const Levels& levels) override { send(levels, false); }
  void end(const Levels& black) override {
    if (settings_.terminate)
      for (int i = 0; i < kTerminations; ++i) send(black, true);
  }

  void send(const Levels& levels, bool last) {
    sacn::DataPacket packet;
    packet.cid = settings_.cid;
    packet.source_name = settings_.source_name;
    packet.priority = static_cast<uint8_t>(priority_);
    // Receivers apply the termination at once, synchronized or not (6.2.4.1).
    packet.sync_address = last ? 0 : static_cast<uint16_t>(settings_.sync_universe);
    packet.preview = settings_.preview;
    packet.terminated = last;
    for (const auto& [universe, slots] : levels) {
      packet.universe = static_cast<uint16_t>(universe);
      packet.sequence = sequence_[packet.universe]++;
      packet.slots.assign(slots.begin(), slots.end());
      send(sacn::write(packet), packet.universe);
    }
    if (packet.sync_address)
      send(sacn::write(sacn::SyncPacket{settings_.cid, sync_sequence_++, packet.sync_address}),
           packet.sync_address);
  }

  void send(const std::vector<uint8_t>& bytes, uint16_t universe) {
    const udp::Address to =
        receiver_ ? *receiver_ : udp::ipv4(sacn::multicast_group(universe), sacn::kPort);
    for (int attempt = 0; attempt < 2; ++attempt) {
      const auto* address = reinterpret_cast<const sockaddr*>(&to.storage);
      if (sendto(socket_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL, address, to.size) >= 0)
        return;
      // The first failure may report an error of an earlier packet.
      if (errno != ECONNREFUSED && errno != EINTR) break;
    }
    throw Error(ErrorKind::connection,
                "cannot send sACN packets to " +
                    (receiver_ ? settings_.destination
                               : "the multicast group of universe " + std::to_string(universe)) +
                    ": " + strerror(errno) +
                    "; check the network, or name another receiver or interface");
  }

  const uint32_t priority_;
  LightDriverSettings::Sacn settings_;
  Descriptor socket_;
  std::optional<udp::Address> receiver_;
  std::map<uint16_t, uint8_t> sequence_;  // of every universe, across programs
  uint8_t sync_sequence_ = 0;
};

}  // namespace

std::unique_ptr<LightDriver> make_sacn_driver(const LightDriverSettings& settings) {
  return std::make_unique<SacnDriver>(settings);
}

}  // namespace inverse
