// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <bit>
#include <concepts>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "buffer.hpp"
#include "kernel_source.hpp"

// What the headers that the build makes of shaders are written in (embed.py).
namespace inverse::gpu {

/// First member of a struct whose others are given by their names: {.source = a, .target = b}.
struct ByName {
  explicit ByName() = default;
};

/// A buffer that is bound twice on purpose (aliased).
struct Aliased {
  const BufferPtr& buffer;
};
/// Says that a dispatch binds this buffer at another place too and writes it at one of them: it
/// works in place, or does not touch what is bound here. Without that, Commands::dispatch throws.
inline Aliased aliased(const BufferPtr& buffer) { return {buffer}; }

/// A buffer of rows that a dispatch over gpu::Rows writes (by_rows).
struct ByRows {
  const BufferPtr& buffer;
  bool aliased = false;
};
/// Says that the shader writes the rows of this buffer from `first_row` on: an index counts from
/// there, so that Commands can bind one part after the other of what exceeds maxStorageBufferRange.
/// What it only reads through a texel view is bound as a whole.
inline ByRows by_rows(const BufferPtr& buffer) { return {buffer}; }
inline ByRows by_rows(const Aliased& given) { return {given.buffer, true}; }

/// A buffer at a binding. It has no default, so that none is left out.
struct Binding {
  Binding(BufferPtr given) : buffer(std::move(given)) {}
  Binding(const Aliased& given) : buffer(given.buffer), aliased(true) {}
  Binding(const ByRows& given) : buffer(given.buffer), aliased(given.aliased), by_rows(true) {}
  BufferPtr buffer;
  bool aliased = false;
  bool by_rows = false;
};
/// One that the shader reads, writes, or both.
struct In : Binding {
  using Binding::Binding;
};
struct Out : Binding {
  using Binding::Binding;
};
struct InOut : Binding {
  using Binding::Binding;
};

/// A number that has no default. As in braces, what it is made of must fit: by its type, or a
/// constant by its value.
template <typename T>
class Required {
 public:
  template <typename From>
  requires requires(From from) { T{from}; }
  constexpr Required(From value) : value_(value) {}
  template <typename From>
  requires(!requires(From from) { T{from}; } &&
           std::is_arithmetic_v<From>) consteval Required(From value)
      : value_(static_cast<T>(value)) {
    if (static_cast<From>(value_) != value || (value_ < T{}) != (value < From{}))
      throw "the constant does not fit";
  }
  constexpr operator T() const { return value_; }

 private:
  T value_;
};

/// A vector of GLSL, aligned as there; it has no default. `size` is made of anything that has a
/// width and a height.
template <typename T, size_t count>
class alignas(count * sizeof(T)) Vector {
 public:
  constexpr Vector(T x, T y) requires(count == 2) : values_{x, y} {}
  constexpr Vector(T x, T y, T z, T w) requires(count == 4) : values_{x, y, z, w} {}
  constexpr Vector(const std::array<T, count>& values) : values_(values) {}
  template <typename Size>
  requires(count == 2 &&
           requires(Size size) { size.width + size.height; }) constexpr Vector(const Size& size)
      : values_{static_cast<T>(size.width), static_cast<T>(size.height)} {}
  constexpr T operator[](size_t i) const { return values_[i]; }

 private:
  std::array<T, count> values_;
};

/// A specialization constant as Vulkan takes it.
inline uint32_t constant(float value) { return std::bit_cast<uint32_t>(value); }
template <std::integral T>
uint32_t constant(T value) {
  return static_cast<uint32_t>(value);
}

}  // namespace inverse::gpu
