// SPDX-License-Identifier: LGPL-2.1-or-later
#include "variables.hpp"

#include <charconv>
#include <cstdlib>
#include <cstring>
#include <string>

#include "common/error.hpp"

namespace inverse::gpu {

uint32_t environment_number(const char* name, uint32_t fallback, uint32_t max) {
  const char* text = std::getenv(name);
  if (!text || !*text) return fallback;
  uint32_t number = 0;
  const char* end = text + std::strlen(text);
  if (const auto [last, error] = std::from_chars(text, end, number);
      error != std::errc() || last != end || number > max)
    throw Error(ErrorKind::unsupported, std::string("the environment variable ") + name + " is \"" +
                                            text + "\"; set a whole number from 0 to " +
                                            std::to_string(max) + ", or unset it");
  return number;
}

}  // namespace inverse::gpu
