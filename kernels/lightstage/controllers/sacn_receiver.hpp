// SPDX-License-Identifier: LGPL-2.1-or-later
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
#include "sacn_sources.hpp"

namespace inverse::sacn {

/// Turns E1.31 packets into the levels of some universes. If a universe has several sources, the
/// one of the highest priority is used; among equals, the first. A source is dropped when it
/// terminates or sends nothing for kDataLossTimeout. Synchronized data waits for the
/// synchronization packet of its source (11.1.1), unless none has come for kDataLossTimeout.
///
/// A source is a CID at one address: whoever sends another's CID from elsewhere neither ends nor
/// delays it. A universe has at most kMaxSources; beyond, one of higher priority takes the place of
/// the newest of the lowest priority.
class Universes {
 public:
  static constexpr size_t kMaxSources = 16;
  struct Stats {
    uint64_t packets = 0;    ///< accepted
    uint64_t malformed = 0;  ///< ignored: damaged, or not E1.31
    uint64_t late = 0;       ///< ignored: out of order within their universe
    uint64_t other = 0;      ///< ignored: other universes and sources, previews, other start codes,
                             ///< sources beyond kMaxSources
  };

  explicit Universes(std::span<const uint32_t> universes, AllowedSources allowed = {});

  /// Processes a datagram that arrived at `now`, in seconds of a steady clock. Never throws.
  void take(std::span<const uint8_t> datagram, const Host& from, double now);
  /// Levels of every universe at `now`; 0 without a source.
  std::map<uint32_t, DmxUniverse> levels(double now);
  const Stats& stats() const { return stats_; }

 private:
  struct Source {
    uint8_t priority = 0, sequence = 0;
    uint16_t sync_address = 0;  ///< 0: not synchronized
    double last_packet = 0;     ///< seconds
    uint64_t since = 0;         ///< number of its first packet
    struct Sync {
      uint8_t sequence;
      double time;  ///< seconds
    };
    std::optional<Sync> last_sync;
    bool waits = false;
    DmxUniverse levels{}, waiting{};
  };
  using Key = std::pair<Cid, Host>;
  using Sources = std::map<Key, Source>;
  void take(const DataPacket& packet, const Key& key, double now);
  void take(const SyncPacket& packet, const Key& key, double now);
  static bool make_room(Sources& sources, uint8_t priority);

  AllowedSources allowed_;
  std::map<uint32_t, Sources> universes_;
  Stats stats_;
};

/// Receives universes on a UDP port of this machine.
class Receiver {
 public:
  /// `listen`: "host:port" as for udp::resolve. Joins the multicast groups of `universes`, and of
  /// `sync_universe` if not 0, if `listen` has no host or is a multicast address. Throws
  /// Error(connection) if the port is in use or the address is not one of this machine.
  Receiver(const std::string& listen, std::span<const uint32_t> universes,
           uint32_t sync_universe = 0, AllowedSources allowed = {});

  /// Processes the datagrams that have arrived; does not wait.
  void poll();
  /// Levels after the last `poll`.
  std::map<uint32_t, DmxUniverse> levels();
  const Universes::Stats& stats() const { return universes_.stats(); }
  /// The port in use; the system chose it if `listen` has port 0.
  uint16_t port() const { return port_; }

 private:
  Descriptor socket_;
  uint16_t port_ = 0;
  Universes universes_;
};

}  // namespace inverse::sacn
