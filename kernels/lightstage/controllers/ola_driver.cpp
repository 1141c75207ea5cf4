// SPDX-License-Identifier: LGPL-2.1-or-later
// Light programs through olad, the daemon of the Open Lighting Architecture, which drives many
// kinds of hardware. Its client library is LGPL; the build links it if present.
#include <ola/DmxBuffer.h>
#include <ola/client/StreamingClient.h>

#include "common/error.hpp"
#include "light_drivers.hpp"
#include "repeating_driver.hpp"

namespace inverse {
namespace {

class OlaDriver final : public RepeatingDriver {
 public:
  explicit OlaDriver(const LightDriverSettings& settings)
      : RepeatingDriver(settings.dmx.universe), settings_(settings) {
    if (settings.dmx.priority > ola::dmx::SOURCE_PRIORITY_MAX)
      throw Error(ErrorKind::unsupported, "OLA priorities go from 0 to 200, not to " +
                                              std::to_string(settings.dmx.priority));
  }
  ~OlaDriver() override {
    try {
      black();
    } catch (const Error&) {
      // A destructor cannot throw; call black() first to receive errors.
    }
  }

 private:
  void open() override {
    ola::client::StreamingClient::Options options;
    options.auto_start = false;
    options.server_port = static_cast<uint16_t>(settings_.ola.port);
    client_ = std::make_unique<ola::client::StreamingClient>(options);
    if (!client_->Setup()) lost("does not answer");
  }

  void send(const Levels& levels) override {
    ola::client::StreamingClient::SendArgs args;
    args.priority = static_cast<uint8_t>(settings_.dmx.priority);
    for (const auto& [universe, slots] : levels)
      if (!client_->SendDMX(universe, ola::DmxBuffer(slots.data(), slots.size()), args))
        lost("has closed the connection");
  }

  void end(const Levels& /*black*/) override { client_.reset(); }

  [[noreturn]] void lost(const std::string& what) const {
    throw Error(ErrorKind::connection,
                "olad on port " + std::to_string(settings_.ola.port) + " of this machine " + what +
                    "; start it (olad), and give it the universes of the program");
  }

  const LightDriverSettings settings_;
  std::unique_ptr<ola::client::StreamingClient> client_;
};

}  // namespace

std::unique_ptr<LightDriver> make_ola_driver(const LightDriverSettings& settings) {
  return std::make_unique<OlaDriver>(settings);
}

}  // namespace inverse
