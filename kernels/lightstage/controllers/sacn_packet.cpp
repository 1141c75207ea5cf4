// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sacn_packet.hpp"

#include <algorithm>
#include <cstring>

namespace inverse::sacn {
namespace {

constexpr size_t kRoot = 38;   // bytes of the root layer
constexpr size_t kData = 126;  // of a data packet with its start code and no slots
constexpr size_t kSync = 49;   // of a synchronization packet
constexpr size_t kNameSize = 64;
constexpr size_t kSlots = 512;
constexpr uint32_t kRootData = 4, kRootExtended = 8;  // VECTOR_ROOT_E131_…
constexpr uint32_t kFramingData = 2;                  // VECTOR_E131_DATA_PACKET
constexpr uint32_t kFramingSync = 1;                  // VECTOR_E131_EXTENDED_SYNCHRONIZATION
constexpr uint8_t kSetProperty = 2;                   // VECTOR_DMP_SET_PROPERTY
constexpr uint8_t kAddressType = 0xa1;
constexpr uint8_t kPreview = 0x80, kTerminated = 0x40, kForceSync = 0x20;
// Preamble and postamble size, then the identifier (5.1 to 5.3).
constexpr uint8_t kStart[16] = {0,   0x10, 0,   0,   'A', 'S', 'C', '-',
                                'E', '1',  '.', '1', '7', 0,   0,   0};

class Writer {
 public:
  explicit Writer(size_t size) : size_(size) { bytes_.reserve(size); }
  void octet(uint8_t value) { bytes_.push_back(value); }
  void word(uint16_t value) {
    octet(static_cast<uint8_t>(value >> 8));
    octet(static_cast<uint8_t>(value));
  }
  void pack(uint32_t value) {
    word(static_cast<uint16_t>(value >> 16));
    word(static_cast<uint16_t>(value));
  }
  void copy(std::span<const uint8_t> from) {
    bytes_.insert(bytes_.end(), from.begin(), from.end());
  }
  /// Flags 0x7 and the length of the layer that starts here: to the end of the packet.
  void flags_and_length() { word(static_cast<uint16_t>(0x7000 | (size_ - bytes_.size()))); }
  void root(uint32_t vector, const Cid& cid) {
    copy(kStart);
    flags_and_length();
    pack(vector);
    copy(cid);
  }
  std::vector<uint8_t> take() { return std::move(bytes_); }

 private:
  size_t size_;
  std::vector<uint8_t> bytes_;
};

class Reader {
 public:
  explicit Reader(std::span<const uint8_t> bytes) : bytes_(bytes) {}
  uint8_t octet(size_t at) const { return bytes_[at]; }
  uint16_t word(size_t at) const { return static_cast<uint16_t>(octet(at) << 8 | octet(at + 1)); }
  uint32_t pack(size_t at) const { return uint32_t{word(at)} << 16 | word(at + 2); }
  /// Whether the length of the layer at `at` reaches exactly to the end of the packet.
  bool layer(size_t at, size_t end) const { return word(at) == (0x7000 | (end - at)); }

 private:
  std::span<const uint8_t> bytes_;
};

std::optional<DataPacket> parse_data(std::span<const uint8_t> bytes) {
  const Reader read(bytes);
  const size_t size = bytes.size();
  if (size < kData || size > kData + kSlots) return {};
  if (!read.layer(16, size) || !read.layer(38, size) || !read.layer(115, size)) return {};
  if (read.pack(40) != kFramingData) return {};
  if (read.octet(117) != kSetProperty || read.octet(118) != kAddressType) return {};
  if (read.word(119) != 0 || read.word(121) != 1) return {};
  if (read.word(123) != size - 125) return {};  // the start code counts
  DataPacket packet;
  memcpy(packet.cid.data(), &bytes[22], packet.cid.size());
  const auto* name = reinterpret_cast<const char*>(&bytes[44]);
  packet.source_name.assign(name, strnlen(name, kNameSize));
  packet.priority = read.octet(108);
  packet.sync_address = read.word(109);
  packet.sequence = read.octet(111);
  packet.preview = read.octet(112) & kPreview;
  packet.terminated = read.octet(112) & kTerminated;
  packet.force_synchronization = read.octet(112) & kForceSync;
  packet.universe = read.word(113);
  packet.start_code = read.octet(125);
  packet.slots.assign(bytes.begin() + kData, bytes.end());
  if (packet.priority > kMaxPriority || packet.sync_address > kLastUniverse) return {};
  if (packet.universe < kFirstUniverse || packet.universe > kLastUniverse) return {};
  return packet;
}

std::optional<SyncPacket> parse_sync(std::span<const uint8_t> bytes) {
  const Reader read(bytes);
  if (bytes.size() != kSync || !read.layer(16, kSync) || !read.layer(38, kSync)) return {};
  if (read.pack(40) != kFramingSync) return {};
  SyncPacket packet;
  memcpy(packet.cid.data(), &bytes[22], packet.cid.size());
  packet.sequence = read.octet(44);
  packet.address = read.word(45);
  if (packet.address < kFirstUniverse || packet.address > kLastUniverse) return {};
  return packet;
}

}  // namespace

std::vector<uint8_t> write(const DataPacket& packet) {
  const size_t slots = std::min(packet.slots.size(), kSlots);
  Writer out(kData + slots);
  out.root(kRootData, packet.cid);
  out.flags_and_length();  // framing layer
  out.pack(kFramingData);
  uint8_t name[kNameSize] = {};  // ends with a zero
  std::copy_n(packet.source_name.begin(), std::min(packet.source_name.size(), kNameSize - 1), name);
  out.copy(name);
  out.octet(packet.priority);
  out.word(packet.sync_address);
  out.octet(packet.sequence);
  out.octet(static_cast<uint8_t>((packet.preview ? kPreview : 0) |
                                 (packet.terminated ? kTerminated : 0) |
                                 (packet.force_synchronization ? kForceSync : 0)));
  out.word(packet.universe);
  out.flags_and_length();  // DMP layer
  out.octet(kSetProperty);
  out.octet(kAddressType);
  out.word(0);  // first property address
  out.word(1);  // increment
  out.word(static_cast<uint16_t>(slots + 1));
  out.octet(packet.start_code);
  out.copy(std::span(packet.slots).first(slots));
  return out.take();
}

std::vector<uint8_t> write(const SyncPacket& packet) {
  Writer out(kSync);
  out.root(kRootExtended, packet.cid);
  out.flags_and_length();
  out.pack(kFramingSync);
  out.octet(packet.sequence);
  out.word(packet.address);
  out.word(0);  // reserved
  return out.take();
}

Parsed parse(std::span<const uint8_t> datagram) {
  if (datagram.size() < kRoot + 6) return {};
  if (!std::equal(std::begin(kStart), std::end(kStart), datagram.begin())) return {};
  const uint32_t vector = Reader(datagram).pack(18);
  if (vector == kRootData) return {parse_data(datagram), {}};
  if (vector == kRootExtended) return {{}, parse_sync(datagram)};
  return {};
}

}  // namespace inverse::sacn
