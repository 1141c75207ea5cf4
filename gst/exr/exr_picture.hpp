// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <ImfForward.h>

#include <memory>
#include <string>
#include <vector>

#include "common/open_file.hpp"
#include "kernels/image/plane.hpp"

namespace inverse {

class ExrReader;

/// An OpenEXR file that is read: its size first, its pixels when asked for, both from one opening.
/// Single and half floats, flat scan lines or tiles; of several parts the first.
class ExrPicture {
 public:
  /// Opens it. Throws Error(file), which begins with `name`, if the file cannot be read, is
  /// larger than `max_side` pixels along a side, or has neither the channels R, G, B nor Y (those
  /// that it has are named).
  ExrPicture(const std::string& path, std::string name, int64_t max_side);
  ExrPicture(std::shared_ptr<const OpenFile> file, std::string name, int64_t max_side);
  ~ExrPicture();

  Extent extent() const { return extent_; }
  /// RGB, row by row from the top left, as stored: values may be negative, infinite or no number. A
  /// picture of Y alone is gray. Throws as the constructor.
  std::vector<float> rgb();

 private:
  void check_header(const std::shared_ptr<const OpenFile>& file, int64_t max_side) const;
  Extent extent_of(const Imf::Header& header, int64_t max_side) const;

  std::string name_;
  std::unique_ptr<ExrReader> stream_;
  std::unique_ptr<Imf::InputFile> file_;
  Extent extent_;
};

}  // namespace inverse
