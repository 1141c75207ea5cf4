// SPDX-License-Identifier: LGPL-2.1-or-later
// Untrusted datagrams, one after another, each after a byte with its length (in fours) and a byte
// with its time.
#include <cstdlib>

#include "stage/controllers/sacn_receiver.hpp"

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
  sacn::Universes universes;
  double now = 0;
  uint64_t count = 0;
  while (rest.size() >= 2) {
    const size_t length = std::min<size_t>(4 * size_t{rest[0]}, rest.size() - 2);
    now += rest[1] / 50.0;
    check(rest.subspan(2, length));
    universes.take(rest.subspan(2, length), now);
    ++count;
    rest = rest.subspan(2 + length);
  }
  const auto& stats = universes.stats();
  if (stats.packets + stats.malformed + stats.late + stats.other != count) abort();
  universes.levels(now);
  return 0;
}
