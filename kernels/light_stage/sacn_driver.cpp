// Light programs over streaming ACN.
#include <algorithm>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <map>
#include <mutex>
#include <optional>
#include <random>
#include <thread>

#include "../error.hpp"
#include "dmx_levels.hpp"
#include "light_drivers.hpp"
#include "sacn_packet.hpp"
#include "udp.hpp"

namespace inverse {
namespace {

constexpr int kTerminations = 3;  // packets that say so (6.2.6)
// Receivers take a source that is silent for 2.5 s (E131_NETWORK_DATA_LOSS_TIMEOUT) for gone: what
// lasts is repeated.
constexpr std::chrono::milliseconds kRepeat{800};

using Clock = std::chrono::steady_clock;

sacn::Cid random_cid() {
  std::random_device random;
  sacn::Cid cid;
  for (uint8_t& byte : cid) byte = static_cast<uint8_t>(random());
  cid[6] = static_cast<uint8_t>((cid[6] & 0x0f) | 0x40);  // UUID of version 4 (RFC 4122)
  cid[8] = static_cast<uint8_t>((cid[8] & 0x3f) | 0x80);
  return cid;
}

void check(const LightDriverSettings::Sacn& s) {
  const auto refuse = [](const std::string& text) { throw Error(ErrorKind::unsupported, text); };
  if (s.universe < sacn::kFirstUniverse || s.universe > sacn::kLastUniverse)
    refuse("there is no sACN universe " + std::to_string(s.universe) + "; they go from 1 to 63999");
  if (s.sync_universe > sacn::kLastUniverse)
    refuse("there is no sACN universe " + std::to_string(s.sync_universe) +
           " for synchronization; they go from 1 to 63999, 0 is without");
  if (s.priority > sacn::kHighestPriority)
    refuse("sACN priorities go from 0 to 200, not to " + std::to_string(s.priority));
}

class SacnDriver final : public LightDriver {
 public:
  explicit SacnDriver(const LightDriverSettings::Sacn& settings) : settings_(settings) {
    check(settings_);
    if (settings_.cid == sacn::Cid{}) settings_.cid = random_cid();
  }
  ~SacnDriver() override {
    try {
      black();
    } catch (const Error&) {
      // Whoever wants to know calls black().
    }
  }

  void upload(const LightProgram& program) override {
    DmxPatch patch(program, settings_.universe);
    black();  // universes of another program
    open();
    patch_.emplace(std::move(patch));
    program_ = program;
    show_colors({});
    keeper_ = std::thread([this] { keep(); });
  }

  void show(uint64_t trigger) override {
    if (!patch_) throw Error(ErrorKind::internal, "lights are shown before a program is uploaded");
    show_colors(program_.colors(program_.at(trigger)));
  }

  void black() override {
    if (keeper_.joinable()) {
      {
        std::lock_guard lock(mutex_);
        stopping_ = true;
      }
      woken_.notify_all();
      keeper_.join();
      stopping_ = false;
    }
    if (!patch_) return;
    send({});
    if (settings_.terminate)
      for (int i = 0; i < kTerminations; ++i) send({}, true);
    patch_.reset();
  }

 private:
  void show_colors(std::vector<LightColor> colors) {
    std::lock_guard lock(mutex_);
    shown_ = std::move(colors);
    sent_ = Clock::now();
    send(shown_);
  }

  /// The keeper's thread: says again what lasts.
  void keep() {
    std::unique_lock lock(mutex_);
    while (!stopping_) {
      if (woken_.wait_until(lock, sent_ + kRepeat, [this] { return stopping_; })) return;
      if (Clock::now() < sent_ + kRepeat) continue;
      sent_ = Clock::now();
      try {
        send(shown_);
      } catch (const Error&) {
        // The next show() tells.
      }
    }
  }

  void open() {
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

  void send(const std::vector<LightColor>& colors, bool last = false) {
    sacn::DataPacket packet;
    packet.cid = settings_.cid;
    packet.source_name = settings_.source_name;
    packet.priority = static_cast<uint8_t>(settings_.priority);
    // The end is for all that listen, in step or not (6.2.4.1).
    packet.sync_address = last ? 0 : static_cast<uint16_t>(settings_.sync_universe);
    packet.preview = settings_.preview;
    packet.terminated = last;
    for (const auto& [universe, levels] : patch_->levels(colors)) {
      packet.universe = static_cast<uint16_t>(universe);
      packet.sequence = sequence_[packet.universe]++;
      packet.slots.assign(levels.begin(), levels.end());
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
      // The first failure may be news of an earlier packet.
      if (errno != ECONNREFUSED && errno != EINTR) break;
    }
    throw Error(ErrorKind::connection,
                "cannot send sACN packets to " +
                    (receiver_ ? settings_.destination
                               : "the multicast group of universe " + std::to_string(universe)) +
                    ": " + strerror(errno) +
                    "; check the network, or name another receiver or interface");
  }

  LightDriverSettings::Sacn settings_;
  LightProgram program_;
  std::optional<DmxPatch> patch_;
  Descriptor socket_;
  std::optional<udp::Address> receiver_;
  std::map<uint16_t, uint8_t> sequence_;  // of every universe, across programs
  uint8_t sync_sequence_ = 0;

  std::thread keeper_;  // between upload() and black()
  std::mutex mutex_;    // of all that sends
  std::condition_variable woken_;
  std::vector<LightColor> shown_;
  Clock::time_point sent_;
  bool stopping_ = false;
};

}  // namespace

std::unique_ptr<LightDriver> make_sacn_driver(const LightDriverSettings::Sacn& settings) {
  return std::make_unique<SacnDriver>(settings);
}

}  // namespace inverse
