// SPDX-License-Identifier: LGPL-2.1-or-later
// Untrusted light programs: an Error, or a program that can be written and read again, and is of
// bounded length for a serial controller.
#include "kernels/lightstage/program/light_program.hpp"

#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "common/error.hpp"
#include "kernels/lightstage/controllers/serial_protocol.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace inverse;
  LightProgram program;
  try {
    program = LightProgram::parse({reinterpret_cast<const char*>(data), size});
  } catch (const Error&) {
    return 0;
  }
  if (LightProgram::parse(program.json()).id() != program.id()) abort();
  for (const uint64_t trigger : {uint64_t{0}, uint64_t{3}, uint64_t{1000}, ~uint64_t{0}})
    for (const LightColor& color : program.colors(program.at(trigger)))
      for (const float c : color)
        if (!(c >= 0 && c <= 1)) abort();
  program.triggers();
  try {
    size_t bytes = 0;
    for (const std::string& line : serial::program_lines(program)) bytes += line.size();
    if (bytes > serial::kMaxProgramBytes + 1000) abort();
  } catch (const Error&) {
  }
  return 0;
}
