// SPDX-License-Identifier: LGPL-2.1-or-later
// Untrusted datagrams, one after another, each after a byte with its length (in fours) and a byte
// with its time and sender.
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "kernels/lightstage/controllers/sacn_receiver.hpp"

namespace {

using namespace inverse;

void check(std::span<const uint8_t> datagram) {
  const sacn::Parsed parsed = sacn::parse(datagram);
  if (parsed.data && parsed.sync) abort();
  if (parsed.data) {
    if (parsed.data->slots.size() > 512 || parsed.data->priority > 200) abort();
    const auto again = sacn::parse(sacn::write(*parsed.data)).data;
    if (!again || again->slots != parsed.data->slots || again->universe != parsed.data->universe ||
        again->sequence != parsed.data->sequence || again->cid != parsed.data->cid)
      abort();
  }
  if (parsed.sync && !sacn::parse(sacn::write(*parsed.sync)).sync) abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  std::span<const uint8_t> rest(data, size);
  constexpr std::array<uint32_t, 3> kPatch{1, 5, 40};
  sacn::Universes universes(kPatch);
  double now = 0;
  uint64_t count = 0;
  while (rest.size() >= 2) {
    const size_t length = std::min<size_t>(4 * size_t{rest[0]}, rest.size() - 2);
    now += rest[1] / 50.0;
    check(rest.subspan(2, length));
    sacn::Host from{};
    from[15] = rest[1] % 3;
    universes.take(rest.subspan(2, length), from, now);
    ++count;
    rest = rest.subspan(2 + length);
  }
  const auto& stats = universes.stats();
  if (stats.packets + stats.malformed + stats.late + stats.other != count) abort();
  if (universes.levels(now).size() != kPatch.size()) abort();
  return 0;
}
