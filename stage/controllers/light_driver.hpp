#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <string>

#include "stage/program/light_program.hpp"

namespace inverse {

/// How the lights of a stage are reached.
struct LightDriverSettings {
  enum class Backend : uint8_t {
    none,    ///< they are not: the rig has the program already and is stepped by its own trigger
    sacn,    ///< E1.31 over UDP, packets at every step
    ola,     ///< the same levels to olad on this machine, where this was built with its client
    serial,  ///< the program is uploaded once and stepped (docs/reference/light-stage-serial.md)
  };
  Backend backend = Backend::none;

  struct Dmx {                // of sacn and ola
    uint32_t universe = 1;    ///< the one in which channel 1 is; 1 to 63999
    uint32_t priority = 100;  ///< 0 to 200
  } dmx;

  struct Sacn {
    /// "host" or "host:port" of one receiver; empty: multicast, to 239.255.U.U of each universe.
    std::string destination;
    /// Of the network interface that multicast leaves through, an IPv4 address; empty: the
    /// system's choice.
    std::string interface_address;
    /// Universe whose synchronization packets make all receivers change at once; 0: none.
    uint32_t sync_universe = 0;
    std::string source_name = "gst-inverse";
    std::array<uint8_t, 16> cid{};  ///< who sends, a UUID; all zero: made at random
    bool preview = false;           ///< marked as not meant for live output
    /// Says at the end that there will be no more, so that receivers need not wait to find out.
    bool terminate = true;
  } sacn;

  struct Ola {
    uint32_t port = 9010;  ///< where olad answers, on this machine
  } ola;

  struct Serial {
    std::string port;  ///< a tty, such as /dev/ttyUSB0
    uint32_t baud = 115200;
    /// The host's pulses step the program; false: the rig's own trigger does.
    bool pulses = true;
    double patience = 2;  ///< seconds that the controller has for an answer
  } serial;
};

/// The lights of a stage as the clock of a program sees them.
///
/// Everything throws Error: `connection` where a controller cannot be reached, does not answer or
/// says no, `unsupported` where settings or program cannot be carried out. Not thread-safe but for
/// `cancel`.
class LightDriver {
 public:
  virtual ~LightDriver() = default;
  LightDriver(const LightDriver&) = delete;
  LightDriver& operator=(const LightDriver&) = delete;

  /// Makes ready for a program: opens what is to be opened, hands over what the rig needs before
  /// the start. Lights are black afterwards (`none`: as they were). Serial controllers take up to
  /// minutes; each answer is waited for `patience` at most. Again for another program, or for
  /// another start of the same one, which they need not be given again.
  virtual void upload(const LightProgram& program) = 0;
  /// The lights of this trigger, counted from 0 as LightProgram::at does: to be called when the
  /// cameras are triggered (or the guard time before). Does not wait for answers: what the
  /// controller objects to is thrown by a later call.
  virtual void show(uint64_t trigger) = 0;
  /// All lights off, and the end of what `upload` started.
  virtual void black() = 0;
  /// From another thread: what is waiting in `upload` or `black` throws Error(connection) soon.
  virtual void cancel() {}

 protected:
  LightDriver() = default;
};

/// Throws Error(unsupported) for settings out of range, and for backends that this was built
/// without. Nothing is opened before `upload`.
std::unique_ptr<LightDriver> make_light_driver(const LightDriverSettings& settings);

}  // namespace inverse
