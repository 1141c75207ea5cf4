// SPDX-License-Identifier: LGPL-2.1-or-later
// Packets against the field tables of ANSI E1.31-2018, field by field: octets, and what they hold.
#include "kernels/lightstage/controllers/sacn_packet.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

namespace inverse::sacn {
namespace {

using Bytes = std::vector<uint8_t>;

/// A row of a field table: first and last octet, and their value, big-endian.
struct Field {
  size_t first, last;
  const char* name;
  Bytes value;
};

Bytes number(uint64_t value, size_t size) {
  Bytes bytes(size);
  for (size_t i = size; i-- > 0; value >>= 8) bytes[i] = static_cast<uint8_t>(value);
  return bytes;
}
Bytes text(const std::string& value, size_t size) {
  Bytes bytes(value.begin(), value.end());
  bytes.resize(size);
  return bytes;
}

void expect_fields(const Bytes& packet, const std::vector<Field>& fields) {
  size_t next = 0;
  for (const Field& field : fields) {
    ASSERT_EQ(field.first, next) << field.name;  // no octet is missing
    next = field.last + 1;
    ASSERT_EQ(field.value.size(), next - field.first) << field.name;
    ASSERT_LE(next, packet.size()) << field.name;
    const auto at = packet.begin() + static_cast<std::ptrdiff_t>(field.first);
    EXPECT_TRUE(std::equal(field.value.begin(), field.value.end(), at)) << field.name;
  }
  EXPECT_EQ(packet.size(), next);
}

Cid some_cid() {
  Cid cid;
  std::iota(cid.begin(), cid.end(), uint8_t{0x10});
  return cid;
}

DataPacket some_data(size_t slots) {
  DataPacket packet;
  packet.cid = some_cid();
  packet.source_name = "a stage";
  packet.priority = 123;
  packet.sync_address = 7962;
  packet.sequence = 154;
  packet.preview = packet.force_synchronization = true;
  packet.universe = 0xf9ff;  // 63999
  packet.slots.resize(slots);
  std::iota(packet.slots.begin(), packet.slots.end(), uint8_t{3});
  return packet;
}

SyncPacket some_sync() { return {some_cid(), 367 % 256, 7962}; }

TEST(SacnPacket, DataIsAsTable4_1) {
  for (const size_t slots : {512U, 24U, 1U, 0U}) {
    const DataPacket packet = some_data(slots);
    const size_t size = 126 + slots;
    std::vector<Field> fields = {
        // Root layer
        {0, 1, "preamble size", {0x00, 0x10}},
        {2, 3, "post-amble size", {0x00, 0x00}},
        {4,
         15,
         "ACN packet identifier",
         {0x41, 0x53, 0x43, 0x2d, 0x45, 0x31, 0x2e, 0x31, 0x37, 0x00, 0x00, 0x00}},
        {16, 17, "flags and length", number(0x7000 + size - 16, 2)},
        {18, 21, "vector", number(0x00000004, 4)},  // VECTOR_ROOT_E131_DATA
        {22, 37, "CID", Bytes(packet.cid.begin(), packet.cid.end())},
        // E1.31 framing layer
        {38, 39, "flags and length", number(0x7000 + size - 38, 2)},
        {40, 43, "vector", number(0x00000002, 4)},  // VECTOR_E131_DATA_PACKET
        {44, 107, "source name", text("a stage", 64)},
        {108, 108, "priority", {123}},
        {109, 110, "synchronization address", number(7962, 2)},
        {111, 111, "sequence number", {154}},
        {112, 112, "options", {0xa0}},  // preview, force synchronization
        {113, 114, "universe", number(63999, 2)},
        // DMP layer
        {115, 116, "flags and length", number(0x7000 + size - 115, 2)},
        {117, 117, "vector", {0x02}},  // VECTOR_DMP_SET_PROPERTY
        {118, 118, "address and data type", {0xa1}},
        {119, 120, "first property address", {0x00, 0x00}},
        {121, 122, "address increment", {0x00, 0x01}},
        {123, 124, "property value count", number(slots + 1, 2)},
        {125, 125, "start code", {0}},
    };
    if (slots) fields.push_back({126, 125 + slots, "property values", packet.slots});
    expect_fields(write(packet), fields);
  }
}

TEST(SacnPacket, OptionsHaveTheirBits) {
  DataPacket packet = some_data(1);
  packet.preview = packet.force_synchronization = false;
  EXPECT_EQ(write(packet)[112], 0);
  packet.terminated = true;
  EXPECT_EQ(write(packet)[112], 0x40);
  packet.preview = true;
  EXPECT_EQ(write(packet)[112], 0xc0);
}

TEST(SacnPacket, LongNamesEndWithAZero) {
  DataPacket packet = some_data(1);
  packet.source_name = std::string(80, 'x');
  const Bytes bytes = write(packet);
  EXPECT_EQ(bytes[106], 'x');
  EXPECT_EQ(bytes[107], 0);
  EXPECT_EQ(bytes[108], 123);
}

TEST(SacnPacket, SynchronizationIsAsTable4_2) {
  const SyncPacket packet = some_sync();
  expect_fields(
      write(packet),
      {
          {0, 1, "preamble size", {0x00, 0x10}},
          {2, 3, "post-amble size", {0x00, 0x00}},
          {4, 15, "ACN packet identifier", text("ASC-E1.17", 12)},
          {16, 17, "flags and length", number(0x7000 + 33, 2)},
          {18, 21, "vector", number(0x00000008, 4)},  // VECTOR_ROOT_E131_EXTENDED
          {22, 37, "CID", Bytes(packet.cid.begin(), packet.cid.end())},
          {38, 39, "flags and length", number(0x7000 + 11, 2)},
          {40, 43, "vector", number(0x00000001, 4)},  // VECTOR_E131_EXTENDED_SYNCHRONIZATION
          {44, 44, "sequence number", {367 % 256}},
          {45, 46, "synchronization address", number(7962, 2)},
          {47, 48, "reserved", {0, 0}},
      });
}

TEST(SacnPacket, ReadsWhatItWrites) {
  for (const size_t slots : {512U, 24U, 0U}) {
    const DataPacket packet = some_data(slots);
    const Parsed parsed = parse(write(packet));
    ASSERT_TRUE(parsed.data);
    EXPECT_FALSE(parsed.sync);
    EXPECT_EQ(parsed.data->cid, packet.cid);
    EXPECT_EQ(parsed.data->source_name, "a stage");
    EXPECT_EQ(parsed.data->priority, 123);
    EXPECT_EQ(parsed.data->sync_address, 7962);
    EXPECT_EQ(parsed.data->sequence, 154);
    EXPECT_TRUE(parsed.data->preview);
    EXPECT_FALSE(parsed.data->terminated);
    EXPECT_TRUE(parsed.data->force_synchronization);
    EXPECT_EQ(parsed.data->universe, 63999);
    EXPECT_EQ(parsed.data->slots, packet.slots);
  }
  const Parsed parsed = parse(write(some_sync()));
  ASSERT_TRUE(parsed.sync);
  EXPECT_EQ(parsed.sync->address, 7962);
  EXPECT_EQ(parsed.sync->sequence, 367 % 256);
  EXPECT_EQ(parsed.sync->cid, some_cid());
}

bool taken(const Bytes& bytes) {
  const Parsed parsed = parse(bytes);
  return parsed.data || parsed.sync;
}

TEST(SacnPacket, TruncatedOrLongerOnesAreIgnored) {
  for (const Bytes& whole : {write(some_data(512)), write(some_data(0)), write(some_sync())}) {
    for (size_t size = 0; size < whole.size(); ++size)
      ASSERT_FALSE(taken(Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size))))
          << size;
    Bytes longer = whole;
    longer.push_back(0);
    EXPECT_FALSE(taken(longer));
  }
}

TEST(SacnPacket, FixedFieldsHaveToBeRight) {
  const Bytes whole = write(some_data(512));
  std::vector<size_t> fixed;
  for (size_t i = 0; i < 22; ++i) fixed.push_back(i);
  for (size_t i = 38; i < 44; ++i) fixed.push_back(i);
  for (size_t i = 115; i < 125; ++i) fixed.push_back(i);
  for (const size_t at : fixed)
    for (const int change : {1, 0x80}) {
      Bytes damaged = whole;
      damaged[at] = static_cast<uint8_t>(damaged[at] ^ change);
      EXPECT_FALSE(taken(damaged)) << at;
    }
  const auto with = [&](size_t at, Bytes value) {
    Bytes damaged = whole;
    std::copy(value.begin(), value.end(), damaged.begin() + static_cast<std::ptrdiff_t>(at));
    return damaged;
  };
  EXPECT_FALSE(taken(with(108, {201})));
  EXPECT_TRUE(taken(with(108, {200})));
  EXPECT_FALSE(taken(with(113, {0, 0})));
  EXPECT_FALSE(taken(with(113, {0xfa, 0x00})));  // 64000
  EXPECT_FALSE(taken(with(109, {0xfa, 0x00})));
  Bytes sync = write(some_sync());
  sync[45] = sync[46] = 0;
  EXPECT_FALSE(taken(sync));
}

TEST(SacnPacket, NoiseIsIgnored) {
  std::mt19937 random(5);
  const Bytes whole = write(some_data(30));
  for (int i = 0; i < 20000; ++i) {
    Bytes bytes = whole;
    for (int k = random() % 8; k >= 0; --k)
      bytes[random() % bytes.size()] = static_cast<uint8_t>(random());
    bytes.resize(random() % (bytes.size() + 1));
    const Parsed parsed = parse(bytes);  // neither crashes nor makes impossible packets
    if (parsed.data) {
      EXPECT_LE(parsed.data->slots.size(), 512U);
      EXPECT_LE(parsed.data->priority, kMaxPriority);
    }
  }
}

TEST(SacnPacket, SequencesAre6_7_2) {
  // In order unless the signed difference is in (-20, 0].
  for (int last = 0; last < 256; ++last)
    for (int difference = -128; difference < 128; ++difference)
      EXPECT_EQ(in_order(static_cast<uint8_t>(last), static_cast<uint8_t>(last + difference)),
                !(difference <= 0 && difference > -20));
}

TEST(SacnPacket, GroupsAre9_3_1) {
  EXPECT_EQ(multicast_group(1), 0xefff0001U);      // 239.255.0.1
  EXPECT_EQ(multicast_group(63999), 0xeffff9ffU);  // 239.255.249.255
}

}  // namespace
}  // namespace inverse::sacn
