#pragma once
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include "sim/error.h"

namespace traces {

/// Appends numbers to a byte string: single bytes, and varints of 7 bits per byte, lowest first, with the top bit set
/// in all but the last byte.
class ByteWriter {
 public:
  explicit ByteWriter(std::string& out) : out_(out) {}

  void byte(std::uint32_t value) { out_.push_back(static_cast<char>(value)); }
  void number(std::uint64_t value) {
    for (; value >= 0x80; value >>= 7) byte(static_cast<std::uint32_t>(value & 0x7f) | 0x80U);
    byte(static_cast<std::uint32_t>(value));
  }
  /// Writes 0, -1, 1, -2, 2, ... as 0, 1, 2, 3, 4, ...
  void difference(std::int64_t value) {
    number((static_cast<std::uint64_t>(value) << 1) ^ static_cast<std::uint64_t>(value >> 63));
  }

 private:
  std::string& out_;
};

/// Reads the numbers written by ByteWriter. Throws InputError, without a file name, if the bytes end early or a number
/// is out of range.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : at_(bytes.data()), end_(bytes.data() + bytes.size()) {}

  std::uint32_t byte() {
    if (at_ == end_) ends_early();
    return static_cast<unsigned char>(*at_++);
  }
  std::uint64_t number() {
    const std::uint32_t first = byte();
    return first < 0x80 ? first : long_number(first & 0x7f);
  }
  /// Reads a number of at most `most`; `what` names it in the error.
  std::uint64_t number(std::uint64_t most, const char* what) {
    const std::uint64_t value = number();
    if (value > most) out_of_range(what);
    return value;
  }
  std::uint32_t number32(std::uint64_t most, const char* what) {
    return static_cast<std::uint32_t>(number(most, what));
  }
  /// Reads a difference and returns its sum with `base`, at most `most`.
  std::uint32_t moved(std::uint32_t base, std::uint64_t most, const char* what) {
    const std::uint64_t coded = number();
    const std::uint64_t value = base + ((coded >> 1) ^ (~(coded & 1) + 1));
    if (value > most) out_of_range(what);
    return static_cast<std::uint32_t>(value);
  }
  std::string_view bytes(std::uint64_t count) {
    if (count > left()) ends_early();
    const std::string_view all(at_, count);
    at_ += count;
    return all;
  }
  std::uint64_t left() const { return static_cast<std::uint64_t>(end_ - at_); }

  [[noreturn]] static void out_of_range(const char* what) {
    throw sim::InputError(std::string(what) + " is out of range");
  }

 private:
  [[noreturn]] static void ends_early() { throw sim::InputError("ends early"); }
  std::uint64_t long_number(std::uint64_t value) {
    for (unsigned shift = 7; shift < 64; shift += 7) {
      const std::uint64_t next = byte();
      value |= (next & 0x7f) << shift;
      if (next < 0x80) return value;
    }
    out_of_range("a number");
  }

  const char* at_;
  const char* end_;
};

/// Loads a little-endian value from an unaligned address.
template <class T>
T load(const char* at) {
  T value;
  std::memcpy(&value, at, sizeof value);
  return value;
}

}  // namespace traces
