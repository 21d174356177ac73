#pragma once
#include <algorithm>
#include <bit>
#include <cstdint>
#include <vector>

namespace hw {

/// A row of bits that is searched a word at a time.
class Bits {
 public:
  explicit Bits(std::uint32_t size) : size_(size), words_((size + 63) / 64) {}

  std::uint32_t size() const { return size_; }
  void set(std::uint32_t index, bool value) {
    const std::uint64_t bit = std::uint64_t{1} << index % 64;
    std::uint64_t& word = words_[index / 64];
    set_ += (value ? 1U : 0U) - ((word & bit) != 0 ? 1U : 0U);
    word = value ? word | bit : word & ~bit;
  }
  std::uint32_t count(bool value) const { return value ? set_ : size_ - set_; }
  /// The first index from `from` on, and below `end`, that has the value; `end` if none has.
  std::uint32_t first(std::uint32_t from, std::uint32_t end, bool value) const {
    const std::uint64_t flip = value ? 0 : ~std::uint64_t{0};
    std::uint64_t below = (std::uint64_t{1} << from % 64) - 1;
    for (std::uint32_t word = from / 64; word * 64 < end; ++word, below = 0) {
      const std::uint64_t found = (words_[word] ^ flip) & ~below;
      if (found != 0) return std::min(end, word * 64 + static_cast<std::uint32_t>(std::countr_zero(found)));
    }
    return end;
  }

 private:
  std::uint32_t size_;
  std::uint32_t set_ = 0;
  std::vector<std::uint64_t> words_;
};

/// Rows of the reservation table from `row`, which may lie up to twice round, to the first that is busy or free; a
/// whole round if none is.
inline std::uint32_t rows_until(const Bits& rows, std::uint32_t row, bool busy) {
  std::uint32_t first = row;
  while (first >= rows.size()) first -= rows.size();
  const std::uint32_t found = rows.first(first, rows.size(), busy);
  return found < rows.size() ? found - first : rows.size() - first + rows.first(0, first, busy);
}

/// Rows from `from` to the first of `length` free ones, which follow each other as if the table were a ring; `limit` if
/// that is not less.
inline std::uint32_t rows_until_gap(const Bits& rows, std::uint32_t from, std::uint32_t length, std::uint32_t limit) {
  if (rows.count(false) < length) return limit;
  for (std::uint32_t at = 0; at < limit;) {
    at += rows_until(rows, from + at, false);
    const std::uint32_t gap = length == 1 ? 1 : rows_until(rows, from + at, true);
    if (gap >= length) return std::min(at, limit);
    at += gap;
  }
  return limit;
}

}  // namespace hw
