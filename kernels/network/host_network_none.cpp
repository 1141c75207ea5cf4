// SPDX-License-Identifier: LGPL-2.1-or-later
// In place of host_network.cpp in a build without oneDNN.
#include "common/error.hpp"
#include "host_network.hpp"

namespace inverse::network {

struct HostNetwork::Impl {};

bool HostNetwork::available() { return false; }

HostNetwork::HostNetwork(const Graph&, std::span<const Shape>) {
  throw Error(ErrorKind::internal, "this build has no oneDNN");
}
HostNetwork::HostNetwork(HostNetwork&&) noexcept = default;
HostNetwork::~HostNetwork() = default;
void HostNetwork::run(std::span<const float* const>, std::span<float* const>) {}

}  // namespace inverse::network
