// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <Iex.h>
#include <ImfIO.h>

#include <cstdint>
#include <memory>
#include <string>

#include "common/new_file.hpp"
#include "common/open_file.hpp"

namespace inverse {

/// An open file as OpenEXR reads it.
class ExrReader final : public Imf::IStream {
 public:
  ExrReader(std::shared_ptr<const OpenFile> file, const std::string& name)
      : IStream(name.c_str()), file_(std::move(file)) {}
  bool read(char bytes[], int count) override {
    const auto wanted = static_cast<size_t>(count);
    if (file_->read(at_, bytes, wanted) != wanted) throw Iex::InputExc("unexpected end of file");
    at_ += wanted;
    return at_ < file_->size();
  }
  uint64_t tellg() override { return at_; }
  void seekg(uint64_t at) override { at_ = at; }

 private:
  std::shared_ptr<const OpenFile> file_;
  uint64_t at_ = 0;
};

/// A new file as OpenEXR writes it.
class ExrWriter final : public Imf::OStream {
 public:
  explicit ExrWriter(NewFile& file) : OStream(file.path().c_str()), file_(file) {}
  void write(const char bytes[], int count) override {
    file_.write(at_, bytes, static_cast<size_t>(count));
    at_ += static_cast<uint64_t>(count);
  }
  uint64_t tellp() override { return at_; }
  void seekp(uint64_t at) override { at_ = at; }

 private:
  NewFile& file_;
  uint64_t at_ = 0;
};

}  // namespace inverse
