#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "descriptor.hpp"
#include "dmx_levels.hpp"
#include "sacn_packet.hpp"

namespace inverse::sacn {

/// What universes say: E1.31 packets in, levels out. Of several sources of a universe the one of
/// the highest priority counts, of equals the one that was there first; one that ends, or is silent
/// for kDataLossTimeout, counts no more. Data that is to be synchronized waits for its
/// synchronization packet (11.1.1), unless none comes for as long.
class Universes {
 public:
  struct Stats {
    uint64_t packets = 0;    ///< taken
    uint64_t malformed = 0;  ///< ignored: damaged, or no packets of E1.31
    uint64_t late = 0;       ///< ignored: behind another one of their universe
    uint64_t other = 0;      ///< ignored: previews, other start codes, sources of lower priority
  };

  /// Takes a datagram that arrived at `now`, in seconds of a steady clock. Never throws.
  void take(std::span<const uint8_t> datagram, double now);
  /// The levels at `now`, of every universe that was ever heard; 0 where its sources are gone.
  std::map<uint32_t, DmxUniverse> levels(double now);
  const Stats& stats() const { return stats_; }

 private:
  struct Source {
    uint8_t priority = 0, sequence = 0;
    uint16_t sync_address = 0;  ///< where data waits for it
    double heard = 0;
    uint64_t since = 0;  ///< the packet that it began with
    bool waits = false;
    DmxUniverse levels{}, waiting{};
  };
  using Sources = std::map<Cid, Source>;
  void take(const DataPacket& packet, double now);
  void take(const SyncPacket& packet, double now);
  void forget_silent(double now);

  std::map<uint32_t, Sources> universes_;
  std::map<std::pair<Cid, uint16_t>, std::pair<uint8_t, double>> syncs_;  // sequence, when
  double swept_ = 0;
  Stats stats_;
};

/// Universes that are heard on a UDP port of this machine.
class Receiver {
 public:
  /// `listen`: "host:port" as udp::resolve takes it; the multicast groups of `universes` (and the
  /// one that synchronizes, where not 0) are joined where `listen` has no host or is a multicast
  /// address. Throws Error(connection) where the port is in use or the address is not of this
  /// machine.
  Receiver(const std::string& listen, std::span<const uint32_t> universes,
           uint32_t sync_universe = 0);

  /// Takes what has arrived; does not wait.
  void poll();
  /// After `poll`.
  std::map<uint32_t, DmxUniverse> levels();
  const Universes::Stats& stats() const { return universes_.stats(); }
  /// The port that it listens on, which the system chose where `listen` says 0.
  uint16_t port() const { return port_; }

 private:
  Descriptor socket_;
  uint16_t port_ = 0;
  Universes universes_;
};

}  // namespace inverse::sacn
