#pragma once
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include "sim/error.h"

namespace traces {

/// Appends numbers to a byte string: single bytes, and varints. A varint has 7 bits per byte, lowest first, and the top
/// bit set in all bytes except the last.
class ByteWriter {
 public:
  explicit ByteWriter(std::string& out) : out_(out) {}

  void write_byte(std::uint32_t value) { out_.push_back(static_cast<char>(value)); }
  void write_number(std::uint64_t value) {
    for (; value >= 0x80; value >>= 7) write_byte(static_cast<std::uint32_t>(value & 0x7f) | 0x80U);
    write_byte(static_cast<std::uint32_t>(value));
  }
  /// Writes a signed number as a varint: 0, -1, 1, -2, 2, ... become 0, 1, 2, 3, 4, ...
  void write_difference(std::int64_t value) {
    write_number((static_cast<std::uint64_t>(value) << 1) ^ static_cast<std::uint64_t>(value >> 63));
  }

 private:
  std::string& out_;
};

/// Reads the numbers that ByteWriter has written. Throws InputError, without a file name, if the bytes end early or a
/// number is out of range.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : at_(bytes.data()), end_(bytes.data() + bytes.size()) {}

  std::uint32_t read_byte() {
    if (at_ == end_) throw_early_end();
    return static_cast<unsigned char>(*at_++);
  }
  std::uint64_t read_number() {
    const std::uint32_t first = read_byte();
    return first < 0x80 ? first : long_number(first & 0x7f);
  }
  /// Reads a varint. Throws InputError if it is above `most`; `what` names the number in the message.
  std::uint64_t read_number(std::uint64_t most, const char* what) {
    const std::uint64_t value = read_number();
    if (value > most) throw_out_of_range(what);
    return value;
  }
  std::uint32_t read_number32(std::uint64_t most, const char* what) {
    return static_cast<std::uint32_t>(read_number(most, what));
  }
  /// Reads a difference and returns its sum with `base`. Throws InputError if the sum is above `most`; `what` names the
  /// number in the message.
  std::uint32_t read_difference_from(std::uint32_t base, std::uint64_t most, const char* what) {
    const std::uint64_t coded = read_number();
    const std::uint64_t value = base + ((coded >> 1) ^ (~(coded & 1) + 1));
    if (value > most) throw_out_of_range(what);
    return static_cast<std::uint32_t>(value);
  }
  std::string_view read_bytes(std::uint64_t count) {
    if (count > bytes_left()) throw_early_end();
    const std::string_view all(at_, count);
    at_ += count;
    return all;
  }
  std::uint64_t bytes_left() const { return static_cast<std::uint64_t>(end_ - at_); }

  [[noreturn]] static void throw_out_of_range(const char* what) {
    throw sim::InputError(std::string(what) + " is out of range");
  }

 private:
  [[noreturn]] static void throw_early_end() { throw sim::InputError("ends early"); }
  std::uint64_t long_number(std::uint64_t value) {
    for (unsigned shift = 7; shift < 64; shift += 7) {
      const std::uint64_t next = read_byte();
      value |= (next & 0x7f) << shift;
      if (next < 0x80) return value;
    }
    throw_out_of_range("a number");
  }

  const char* at_;
  const char* end_;
};

/// Loads a little-endian value from an unaligned address.
template <class T>
T load_unaligned(const char* at) {
  T value;
  std::memcpy(&value, at, sizeof value);
  return value;
}

}  // namespace traces
