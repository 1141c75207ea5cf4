// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace inverse::sacn {

/// Streaming ACN, ANSI E1.31-2018: DMX over UDP. Sections and tables below refer to the standard.
inline constexpr uint16_t kPort = 5568;
inline constexpr uint32_t kFirstUniverse = 1, kLastUniverse = 63999;
inline constexpr uint32_t kMaxPriority = 200;
/// A source without packets for this time is lost (Appendix A), seconds.
inline constexpr double kDataLossTimeout = 2.5;

using Cid = std::array<uint8_t, 16>;

/// An E1.31 Data Packet (Table 4-1).
struct DataPacket {
  Cid cid{};                ///< UUID of the sender
  std::string source_name;  ///< UTF-8, at most 63 bytes
  uint8_t priority = 100;   ///< 0 to 200
  uint16_t sync_address = 0;
  uint8_t sequence = 0;
  bool preview = false;
  bool terminated = false;
  bool force_synchronization = false;
  uint16_t universe = 1;
  uint8_t start_code = 0;      ///< 0: levels
  std::vector<uint8_t> slots;  ///< at most 512
};

/// An E1.31 Synchronization Packet (Table 4-2).
struct SyncPacket {
  Cid cid{};
  uint8_t sequence = 0;
  uint16_t address = 0;
};

std::vector<uint8_t> write(const DataPacket& packet);
std::vector<uint8_t> write(const SyncPacket& packet);

/// A parsed datagram. Both are empty if it is another kind of packet or damaged: truncated,
/// inconsistent lengths, values outside the standard.
struct Parsed {
  std::optional<DataPacket> data;
  std::optional<SyncPacket> sync;
};
Parsed parse(std::span<const uint8_t> datagram);

/// Whether to accept a packet with this sequence number after one with number `last` (6.7.2). Late
/// packets are not accepted.
inline bool in_order(uint8_t last, uint8_t sequence) {
  const auto step = static_cast<int8_t>(static_cast<uint8_t>(sequence - last));
  return step > 0 || step <= -20;
}

/// The multicast group of a universe (9.3.1): 239.255.high.low, in host byte order.
inline uint32_t multicast_group(uint16_t universe) { return 0xefff0000U | universe; }

}  // namespace inverse::sacn
