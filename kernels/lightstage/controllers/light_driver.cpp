// SPDX-License-Identifier: LGPL-2.1-or-later
#include "light_driver.hpp"

#include "common/error.hpp"
#include "light_drivers.hpp"

namespace inverse {
namespace {

class NoDriver final : public LightDriver {
 public:
  void upload(const LightProgram&) override {}
  void show(uint64_t) override {}
  void black() override {}
};

}  // namespace

std::unique_ptr<LightDriver> make_light_driver(const LightDriverSettings& settings) {
  using Backend = LightDriverSettings::Backend;
  switch (settings.backend) {
    case Backend::sacn:
      return make_sacn_driver(settings);
    case Backend::ola:
#if INVERSE_HAVE_OLA
      return make_ola_driver(settings);
#else
      throw Error(ErrorKind::unsupported,
                  "this was built without OLA's client library; build it with libola-dev, or take "
                  "backend=sacn with an input of olad");
#endif
    case Backend::serial:
      return make_serial_driver(settings.serial);
    case Backend::none:
      break;
  }
  return std::make_unique<NoDriver>();
}

}  // namespace inverse
