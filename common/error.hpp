#pragma once
#include <stdexcept>
#include <string>

namespace inverse {

/// What went wrong, so that the caller can choose between an error, a warning and a retry.
enum class ErrorKind {
  no_device,      ///< no usable Vulkan device, or none that matches the selection
  device_lost,    ///< the device stopped answering; everything on it is gone
  out_of_memory,  ///< host or device memory ran out
  limit,          ///< the request exceeds a limit of the device (the text names it)
  unsupported,    ///< a format, colorimetry or option that this build cannot handle
  file,           ///< a file that is missing, damaged, or not what it should be
  output,         ///< a file that cannot be written
  connection,     ///< a controller or a port that cannot be reached, or does not answer
  internal,       ///< a broken promise inside this library
};

/// Every failure inside kernels/ is thrown as this type. `what()` says what is wrong and what to do
/// about it.
class Error : public std::runtime_error {
 public:
  Error(ErrorKind kind, const std::string& text) : std::runtime_error(text), kind_(kind) {}
  ErrorKind kind() const { return kind_; }

 private:
  ErrorKind kind_;
};

}  // namespace inverse
