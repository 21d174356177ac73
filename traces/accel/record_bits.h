#pragma once
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <span>

namespace traces {

/// Returns the lowest `bits` bits of a word.
constexpr std::uint32_t low_bits(std::uint32_t word, std::uint32_t bits) {
  return bits == 32 ? word : word & ((1U << bits) - 1);
}

/// Writes the fields of a record of the GPU's memory one after the other, lowest bit first. The record is zero before.
class RecordBitWriter {
 public:
  explicit RecordBitWriter(std::span<std::byte> out) : out_(out) {}
  void put(std::uint32_t value, std::uint32_t bits) {
    assert(low_bits(value, bits) == value && at_ + bits <= 8 * out_.size());
    for (std::uint32_t i = 0; i < bits; ++i, ++at_) {
      out_[at_ / 8] |= static_cast<std::byte>((value >> i & 1U) << (at_ % 8));
    }
  }

 private:
  const std::span<std::byte> out_;
  std::size_t at_ = 0;
};

/// Reads the fields of a record in the order in which RecordBitWriter wrote them.
class RecordBitReader {
 public:
  explicit RecordBitReader(std::span<const std::byte> from) : from_(from) {}
  std::uint32_t get(std::uint32_t bits) {
    std::uint32_t value = 0;
    for (std::uint32_t i = 0; i < bits; ++i, ++at_) {
      value |= (static_cast<std::uint32_t>(from_[at_ / 8]) >> (at_ % 8) & 1U) << i;
    }
    return value;
  }

 private:
  const std::span<const std::byte> from_;
  std::size_t at_ = 0;
};

}  // namespace traces
