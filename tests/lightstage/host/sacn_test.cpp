// SPDX-License-Identifier: LGPL-2.1-or-later
// The sACN backend and the receiver, on loopback.
#include <gtest/gtest.h>
#include <poll.h>

#include <chrono>
#include <thread>

#include "common/error.hpp"
#include "kernels/lightstage/controllers/light_driver.hpp"
#include "kernels/lightstage/controllers/sacn_receiver.hpp"
#include "kernels/lightstage/controllers/udp.hpp"
#include "two_lights.hpp"

namespace inverse::testing {
namespace {

using sacn::DataPacket;
using sacn::SyncPacket;
using sacn::Universes;

/// A port that stores every datagram.
class Port {
 public:
  Port() : socket_(udp::open(AF_INET)) {
    const auto address = udp::ipv4(INADDR_LOOPBACK, 0);
    EXPECT_EQ(
        bind(socket_.get(), reinterpret_cast<const sockaddr*>(&address.storage), address.size), 0);
    sockaddr_in bound{};
    socklen_t size = sizeof bound;
    getsockname(socket_.get(), reinterpret_cast<sockaddr*>(&bound), &size);
    port_ = ntohs(bound.sin_port);
  }
  std::string address() const { return "127.0.0.1:" + std::to_string(port_); }
  /// The next datagram; empty if there is none.
  std::vector<uint8_t> next() {
    pollfd wanted{socket_.get(), POLLIN, 0};
    poll(&wanted, 1, 200);
    std::vector<uint8_t> bytes(2048);
    const ssize_t size = recv(socket_.get(), bytes.data(), bytes.size(), 0);
    bytes.resize(size > 0 ? static_cast<size_t>(size) : 0);
    return bytes;
  }

 private:
  Descriptor socket_;
  uint16_t port_ = 0;
};

LightDriverSettings settings_for(const std::string& destination) {
  LightDriverSettings settings;
  settings.backend = LightDriverSettings::Backend::sacn;
  settings.sacn.destination = destination;
  settings.dmx.universe = 40;
  return settings;
}

TEST(SacnDriver, RepeatsWhatLasts) {
  Port port;
  const LightProgram program = two_lights();
  const auto driver = make_light_driver(settings_for(port.address()));
  driver->upload(program);
  driver->show(4);
  std::vector<DataPacket> packets;
  const auto start = std::chrono::steady_clock::now();
  while (std::chrono::steady_clock::now() - start < std::chrono::milliseconds(1900))
    if (const auto packet = sacn::parse(port.next()).data; packet && packet->universe == 40)
      packets.push_back(*packet);
  // Black, the step, two quick repeats, then slow ones within the receivers' timeout.
  ASSERT_GE(packets.size(), 6U);
  for (size_t i = 2; i < packets.size(); ++i) {
    EXPECT_EQ(packets[i].slots, packets[1].slots);
    EXPECT_EQ(packets[i].sequence, i);
  }
  driver->black();
  while (!port.next().empty()) {
  }
  std::this_thread::sleep_for(std::chrono::seconds(1));
  EXPECT_TRUE(port.next().empty()) << "what is black and gone is not repeated";
}

TEST(SacnDriver, SendsEveryUniverseAtEveryStep) {
  Port port;
  auto settings = settings_for(port.address());
  settings.sacn.sync_universe = 99;
  settings.dmx.priority = 150;
  settings.sacn.source_name = "my stage";
  const LightProgram program = two_lights();
  const auto driver = make_light_driver(settings);
  driver->upload(program);
  const uint64_t count = program.triggers().value() + 1;  // and behind its end
  for (uint64_t t = 0; t < count; ++t) driver->show(t);
  driver->black();
  const DmxPatch patch(program, 40);
  sacn::Cid cid{};
  for (uint64_t i = 0; i < count + 2; ++i) {  // black before and after
    const auto colors =
        i == 0 || i > count ? std::vector<LightColor>(2) : program.colors(program.at(i - 1));
    for (const auto& [universe, levels] : patch.levels(colors)) {
      const auto packet = sacn::parse(port.next()).data;
      ASSERT_TRUE(packet);
      EXPECT_EQ(packet->universe, universe);
      EXPECT_EQ(packet->priority, 150);
      EXPECT_EQ(packet->source_name, "my stage");
      EXPECT_EQ(packet->sync_address, 99);
      EXPECT_EQ(packet->sequence, i % 256);
      EXPECT_FALSE(packet->terminated || packet->preview || packet->force_synchronization);
      EXPECT_EQ(packet->slots, std::vector(levels.begin(), levels.end())) << i;
      if (i == 0) cid = packet->cid;
      EXPECT_EQ(packet->cid, cid);
    }
    const auto sync = sacn::parse(port.next()).sync;
    ASSERT_TRUE(sync) << i;
    EXPECT_EQ(sync->address, 99);
    EXPECT_EQ(sync->sequence, i % 256);
    EXPECT_EQ(sync->cid, cid);
  }
  EXPECT_EQ(cid[6] >> 4, 4);  // a random UUID
  for (int i = 0; i < 6; ++i) {
    const auto packet = sacn::parse(port.next()).data;
    ASSERT_TRUE(packet);
    EXPECT_TRUE(packet->terminated);
    EXPECT_EQ(packet->sync_address, 0);
  }
  EXPECT_TRUE(port.next().empty());
  driver->black();  // nothing any more
  EXPECT_TRUE(port.next().empty());
}

TEST(SacnDriver, LeavesTheStreamOpenOnRequest) {
  Port port;
  auto settings = settings_for(port.address());
  settings.sacn.terminate = false;
  settings.sacn.preview = true;
  auto driver = make_light_driver(settings);
  driver->upload(two_lights());
  driver.reset();  // black, too
  for (int i = 0; i < 4; ++i) {
    const auto packet = sacn::parse(port.next()).data;
    ASSERT_TRUE(packet);
    EXPECT_FALSE(packet->terminated);
    EXPECT_TRUE(packet->preview);
    EXPECT_EQ(packet->slots, std::vector<uint8_t>(512));
  }
  EXPECT_TRUE(port.next().empty());
}

TEST(SacnDriver, InvalidSettingsAreErrors) {
  const auto upload = [](const std::string& destination) {
    return error_of([&] { make_light_driver(settings_for(destination))->upload(two_lights()); });
  };
  expect_contains(upload("no-such-host.invalid"), "cannot find the host");
  expect_contains(upload("127.0.0.1:99999"), "the port is a number");
  expect_contains(upload("127.0.0.1:0"), "cannot send sACN packets");
  // A broadcast address is none that we send to.
  expect_contains(upload("255.255.255.255"), "cannot send sACN packets to 255.255.255.255");
  auto settings = settings_for("");
  settings.sacn.interface_address = "203.0.113.77";
  const auto multicast = [&] {
    return error_of([&] { make_light_driver(settings)->upload(two_lights()); });
  };
  expect_contains(multicast(), "no network interface has the address 203.0.113.77");
  settings.sacn.interface_address = "eth0";
  expect_contains(multicast(), "is no IPv4 address");
  settings = settings_for("");
  settings.dmx.universe = 64000;
  expect_contains(error_of([&] { make_light_driver(settings); }), "1 to 63999");
  settings.dmx.universe = 0;
  expect_contains(error_of([&] { make_light_driver(settings); }), "1 to 63999");
  settings = settings_for("");
  settings.dmx.priority = 201;
  expect_contains(error_of([&] { make_light_driver(settings); }), "0 to 200");
  LightProgram deaf = two_lights();
  for (auto& light : deaf.lights) light.channels.clear();
  Port port;
  const auto driver = make_light_driver(settings_for(port.address()));
  expect_contains(error_of([&] { driver->upload(deaf); }), "has no channels");
  expect_contains(error_of([&] { driver->show(0); }), "before a program");
}

/// Several packets in sequence, as from several senders.
class Heard : public ::testing::Test {
 protected:
  DataPacket from(uint8_t who, uint8_t sequence, uint8_t level, uint8_t priority = 100) {
    DataPacket packet;
    packet.cid[0] = who;
    packet.sequence = sequence;
    packet.priority = priority;
    packet.universe = 5;
    packet.slots = {level};
    return packet;
  }
  /// From a console, which is at this address.
  template <typename Packet>
  void take(const Packet& packet, double now) {
    take(packet, now, kConsole);
  }
  template <typename Packet>
  void take(const Packet& packet, double now, const sacn::Host& host) {
    universes.take(sacn::write(packet), host, now);
  }
  int level(double now) { return universes.levels(now).at(5)[0]; }

  static constexpr sacn::Host kConsole{1}, kStranger{2};
  static constexpr std::array<uint32_t, 2> kPatch{5, 6};
  Universes universes{kPatch};
};

TEST_F(Heard, LateOnesAreIgnored) {
  EXPECT_EQ(level(0), 0);
  take(from(1, 250, 10), 0);
  take(from(1, 251, 11), 0);
  take(from(1, 250, 10), 0);
  take(from(1, 251, 12), 0);
  EXPECT_EQ(level(0), 11);
  take(from(1, 3, 13), 0);  // across the wrap
  EXPECT_EQ(level(0), 13);
  take(from(1, 200, 14), 0);  // so far behind that it has started again
  EXPECT_EQ(level(0), 14);
  EXPECT_EQ(universes.stats().late, 2U);
  EXPECT_EQ(universes.stats().packets, 4U);
}

TEST_F(Heard, HighestPriorityThenTheFirst) {
  take(from(1, 0, 10), 0);
  take(from(2, 0, 20), 0);
  EXPECT_EQ(level(0), 10);
  take(from(2, 1, 21, 101), 0);
  EXPECT_EQ(level(0), 21);
  take(from(2, 2, 22, 0), 0);
  EXPECT_EQ(level(0), 10);
}

TEST_F(Heard, EndsWithTheStreamOrInSilence) {
  take(from(1, 0, 10), 0);
  take(from(2, 0, 20, 50), 0);
  DataPacket end = from(1, 1, 0);
  end.terminated = true;
  take(end, 0);
  EXPECT_EQ(level(0), 20);
  EXPECT_EQ(level(2.4), 20);
  EXPECT_EQ(level(2.6), 0);
}

TEST_F(Heard, PreviewsAndOtherStartCodesAreNoLevels) {
  DataPacket packet = from(1, 0, 10);
  packet.preview = true;
  take(packet, 0);
  packet = from(1, 1, 10);
  packet.start_code = 0xdd;
  take(packet, 0);
  EXPECT_EQ(level(0), 0);
  EXPECT_EQ(universes.stats().other, 2U);
  const std::vector<uint8_t> rubbish(638, 7);
  universes.take(rubbish, kConsole, 0);
  universes.take(std::vector<uint8_t>{}, kConsole, 0);
  EXPECT_EQ(universes.stats().malformed, 2U);
}

TEST_F(Heard, SynchronizedDataWaits) {
  const auto synced = [&](uint8_t sequence, uint8_t level) {
    DataPacket packet = from(1, sequence, level);
    packet.sync_address = 9;
    return packet;
  };
  const sacn::Cid cid = from(1, 0, 0).cid;
  take(synced(0, 10), 0);
  EXPECT_EQ(level(0), 10);  // not synchronized so far
  take(SyncPacket{cid, 0, 9}, 0);
  take(synced(1, 11), .1);
  EXPECT_EQ(level(.1), 10);
  take(SyncPacket{cid, 0, 9}, .1);  // a late one
  EXPECT_EQ(level(.1), 10);
  sacn::Cid stranger{};
  stranger[0] = 8;
  take(SyncPacket{stranger, 0, 9}, .1);
  EXPECT_EQ(level(.1), 10);
  take(SyncPacket{cid, 1, 8}, .1);  // another address
  EXPECT_EQ(level(.1), 10);
  take(SyncPacket{cid, 1, 9}, .1);
  EXPECT_EQ(level(.1), 11);
  take(synced(2, 12), 2.4);
  EXPECT_EQ(level(2.4), 11);
  take(synced(3, 13), 3);  // synchronization was lost
  EXPECT_EQ(level(3), 13);
}

TEST_F(Heard, FloodsOfSendersAndUniversesAreBounded) {
  for (int i = 0; i < 100000; ++i) {
    DataPacket packet = from(static_cast<uint8_t>(i), 0, 1);
    packet.cid[1] = static_cast<uint8_t>(i >> 8);
    packet.universe = static_cast<uint16_t>(1 + i % 5000);
    take(packet, 0);
  }
  EXPECT_EQ(universes.levels(0).size(), 2U);
  EXPECT_EQ(universes.stats().packets, 2 * Universes::kMaxSources);
  EXPECT_EQ(universes.stats().other, 100000 - 2 * Universes::kMaxSources);
}

TEST_F(Heard, OnlyUniversesOfThePatch) {
  DataPacket packet = from(1, 0, 10);
  packet.universe = 7;
  take(packet, 0);
  EXPECT_EQ(universes.stats().other, 1U);
  packet.universe = 6;
  take(packet, 0);
  const auto levels = universes.levels(0);
  EXPECT_EQ(levels.size(), 2U);
  EXPECT_EQ(levels.at(5)[0], 0);
  EXPECT_EQ(levels.at(6)[0], 10);
}

TEST_F(Heard, StrangersOfLowerPriorityLeaveRoom) {
  for (uint8_t i = 0; i < 2 * Universes::kMaxSources; ++i)
    take(from(static_cast<uint8_t>(10 + i), 0, 7, 99), 0, kStranger);
  take(from(1, 0, 200), 0);
  EXPECT_EQ(level(0), 200);
  // Nor does one of the same priority take the place of who was first.
  for (uint8_t i = 0; i < 2 * Universes::kMaxSources; ++i)
    take(from(static_cast<uint8_t>(50 + i), 0, 7, 100), 0, kStranger);
  take(from(1, 1, 201), 0);
  EXPECT_EQ(level(0), 201);
}

TEST_F(Heard, AStrangerOfTheHighestPriorityIsForgottenInSilence) {
  take(from(1, 0, 10), 0);
  for (uint8_t i = 0; i < 2 * Universes::kMaxSources; ++i)
    take(from(static_cast<uint8_t>(10 + i), 0, 99, sacn::kMaxPriority), 0, kStranger);
  EXPECT_EQ(level(0), 99);
  take(from(1, 1, 11), 2);
  EXPECT_EQ(level(2), 99);
  take(from(1, 2, 12), 2.6);
  EXPECT_EQ(level(2.6), 12);
  EXPECT_EQ(level(5.2), 0);
}

TEST_F(Heard, AStrangerWithTheConsolesCidNeitherEndsNorDelaysIt) {
  take(from(1, 0, 10), 0);
  DataPacket end = from(1, 1, 0);
  end.terminated = true;
  take(end, 0, kStranger);
  EXPECT_EQ(level(0), 10);
  take(from(1, 15, 99), 0, kStranger);
  take(from(1, 1, 11), 0);
  EXPECT_EQ(level(0), 11);
  // Synchronization, too, is the console's own.
  DataPacket synced = from(1, 2, 12);
  synced.sync_address = 9;
  take(synced, 0);
  take(SyncPacket{synced.cid, 0, 9}, 0);
  synced.sequence = 3;
  synced.slots = {13};
  take(synced, 0);
  take(SyncPacket{synced.cid, 10, 9}, 0, kStranger);
  EXPECT_EQ(level(0), 12);
  take(SyncPacket{synced.cid, 1, 9}, 0);
  EXPECT_EQ(level(0), 13);
}

TEST_F(Heard, SynchronizationWithoutDataIsNotRemembered) {
  take(SyncPacket{from(1, 0, 0).cid, 0, 9}, 0);
  EXPECT_EQ(universes.stats().other, 1U);
  DataPacket synced = from(1, 0, 10);
  synced.sync_address = 9;
  take(synced, 0);
  EXPECT_EQ(level(0), 10);
}

TEST_F(Heard, OnlySourcesThatAreAllowed) {
  const auto heard = [&](const std::string& allowed) {
    universes = Universes(kPatch, sacn::AllowedSources(allowed));
    const auto address = [](uint32_t host) { return sacn::host_of(udp::ipv4(host, 5568).storage); };
    take(from(1, 0, 10), 0, address(0x0a000001));
    take(from(2, 0, 20, sacn::kMaxPriority), 0, address(0x0a000002));
    return level(0);
  };
  EXPECT_EQ(heard(""), 20);
  EXPECT_EQ(heard("10.0.0.1"), 10);
  EXPECT_EQ(heard("10.0.0.1, ::ffff:10.0.0.2"), 20);
  EXPECT_EQ(heard("10.0.0.3"), 0);
  EXPECT_EQ(heard("01000000-0000-0000-0000-000000000000"), 10);
  EXPECT_EQ(heard("0100000000000000000000000000000f,02000000000000000000000000000000"), 20);
  EXPECT_EQ(universes.stats().other, 1U);
  expect_contains(error_of([&] { heard("10.0.0.1,,10.0.0.2"); }), "no list of sACN sources");
  expect_contains(error_of([&] { heard("0100000-0000"); }), "cannot find the host");
}

TEST(SacnReceiver, ReceivesFromTheDriver) {
  const LightProgram program = two_lights();
  const std::array<uint32_t, 2> universes{40, 41};
  sacn::Receiver receiver("127.0.0.1:0", universes);
  auto settings = settings_for("127.0.0.1:" + std::to_string(receiver.port()));
  settings.sacn.sync_universe = 99;
  const auto driver = make_light_driver(settings);
  driver->upload(program);
  const DmxPatch patch(program, 40);
  for (uint64_t t = 0; t < program.triggers(); ++t) {
    driver->show(t);
    receiver.poll();
    EXPECT_EQ(receiver.levels(), patch.levels(program.colors(program.at(t)))) << t;
  }
  driver->black();
  receiver.poll();
  EXPECT_EQ(receiver.stats().malformed + receiver.stats().late + receiver.stats().other, 0U);
}

TEST(SacnReceiver, ReceivesMulticast) {
  const std::array<uint32_t, 2> universes{40, 41};
  // The groups' port is the standard's; where something else has it there is nothing to test.
  std::unique_ptr<sacn::Receiver> receiver;
  try {
    receiver = std::make_unique<sacn::Receiver>("", universes);
  } catch (const Error& error) {
    GTEST_SKIP() << error.what();
  }
  auto settings = settings_for("");
  const auto driver = make_light_driver(settings);
  try {
    driver->upload(two_lights());
  } catch (const Error& error) {
    GTEST_SKIP() << error.what();
  }
  driver->show(1);
  receiver->poll();
  if (receiver->stats().packets == 0) {
    GTEST_SKIP() << "this machine has no network that carries multicast";
  }
  EXPECT_EQ(receiver->levels().at(41)[2], 255);
}

TEST(SacnReceiver, PortsInUseAndInvalidAddressesAreErrors) {
  const std::vector<uint32_t> none;
  sacn::Receiver first("127.0.0.1:0", none);
  const std::string taken = "127.0.0.1:" + std::to_string(first.port());
  expect_contains(error_of([&] { sacn::Receiver(taken, none); }), "another program listens");
  expect_contains(error_of([&] { sacn::Receiver("203.0.113.200:0", none); }), "of this machine");
  expect_contains(error_of([&] { sacn::Receiver("localhost:x", none); }), "the port is a number");
}

}  // namespace
}  // namespace inverse::testing
