// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <stdexcept>
#include <string>

namespace inverse {

/// Kind of a failure, so that the caller can choose between an error, a warning and a retry.
enum class ErrorKind {
  no_device,      ///< no usable Vulkan device, or none that matches the selection
  device_lost,    ///< the device stopped answering; its contents are lost
  out_of_memory,  ///< host or device memory ran out
  limit,          ///< the request exceeds a limit of the device (the text names it)
  unsupported,    ///< a format, colorimetry or option that this build cannot handle
  file,           ///< a file that is missing, damaged, or of the wrong kind
  output,         ///< a file that cannot be written
  connection,     ///< a controller or a port that cannot be reached, or does not answer
  internal,       ///< a violated precondition inside this library
};

/// Type of all exceptions of kernels/. `what()` states the fault and the remedy.
class Error : public std::runtime_error {
 public:
  Error(ErrorKind kind, const std::string& text) : std::runtime_error(text), kind_(kind) {}
  ErrorKind kind() const { return kind_; }

 private:
  ErrorKind kind_;
};

}  // namespace inverse
