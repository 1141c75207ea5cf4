// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <string>

#include "kernels/lightstage/program/light_program.hpp"

namespace inverse {

/// How to reach the lights of a stage.
struct LightDriverSettings {
  enum class Backend : uint8_t {
    none,    ///< not driven: the rig already has the program and its own trigger steps it
    sacn,    ///< E1.31 over UDP, packets at every step
    ola,     ///< the same levels through olad on this machine; needs a build with OLA's client
    serial,  ///< the program is uploaded once and stepped (docs/reference/light-stage-serial.md)
  };
  Backend backend = Backend::none;

  struct Dmx {                // of sacn and ola
    uint32_t universe = 1;    ///< universe of channel 1; 1 to 63999
    uint32_t priority = 100;  ///< 0 to 200
  } dmx;

  struct Sacn {
    /// "host" or "host:port" of one receiver; empty: multicast to 239.255.U.U of each universe.
    std::string destination;
    /// IPv4 address of the network interface for multicast; empty: the system's choice.
    std::string interface_address;
    /// Universe whose synchronization packets make all receivers change at once; 0: none.
    uint32_t sync_universe = 0;
    std::string source_name = "gst-inverse";
    std::array<uint8_t, 16> cid{};  ///< UUID of the sender; all zero: random
    bool preview = false;           ///< marks the packets as not meant for live output
    /// Sends Stream_Terminated packets at the end, so that receivers need not wait for a timeout.
    bool terminate = true;
  } sacn;

  struct Ola {
    uint32_t port = 9010;  ///< of olad on this machine
  } ola;

  struct Serial {
    std::string port;  ///< a tty, such as /dev/ttyUSB0
    uint32_t baud = 115200;
    /// True: pulses of the host step the program; false: the rig's own trigger does.
    bool pulses = true;
    double timeout = 2;  ///< of a reply, seconds
  } serial;
};

/// Drives the lights of a stage through a program.
///
/// Every method throws Error: `connection` if a controller cannot be reached, does not answer or
/// reports an error; `unsupported` if it cannot do what the settings or the program require. Only
/// `cancel` is thread-safe.
class LightDriver {
 public:
  virtual ~LightDriver() = default;
  LightDriver(const LightDriver&) = delete;
  LightDriver& operator=(const LightDriver&) = delete;

  /// Prepares a program: opens the connection and uploads what the rig needs before the start.
  /// Lights are black afterwards (`none`: unchanged). Serial controllers may take minutes; each
  /// reply has to come within `timeout`. Call it again for another program or another start; a
  /// serial controller that still has the program does not receive it again.
  virtual void upload(const LightProgram& program) = 0;
  /// Shows the lights of this trigger, counted from 0 as in LightProgram::at. Call it when the
  /// cameras are triggered, or the guard time before. Does not wait for replies: a later call
  /// throws the controller's error.
  virtual void show(uint64_t trigger) = 0;
  /// Turns all lights off and ends what `upload` started.
  virtual void black() = 0;
  /// From another thread: makes a waiting `upload` or `black` throw Error(connection) soon.
  virtual void cancel() {}

 protected:
  LightDriver() = default;
};

/// Throws Error(unsupported) for settings out of range and for backends missing in this build.
/// Opens nothing before `upload`.
std::unique_ptr<LightDriver> make_light_driver(const LightDriverSettings& settings);

}  // namespace inverse
