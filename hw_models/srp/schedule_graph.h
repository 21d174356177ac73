#pragma once
#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hw_models/srp/op_table.h"
#include "hw_models/srp/srp_config.h"
#include "shader_kernels/graph.h"

namespace hw {

/// Bytes that a port of local memory moves in a cycle.
inline constexpr std::uint32_t kPortBytes = 16;

/// Unit of scheduling: an operation of a kernel, or an access of one of its loads or stores, as wide as the port.
struct Operation {
  OpClass kind = OpClass::kFree;
  std::uint32_t node = 0;
  std::uint32_t part = 0;
  std::uint32_t latency = 0;
  std::uint32_t occupancy = 1;
};

/// `to` of an item uses what `from` made `distance` items before, `after` cycles after it is issued.
struct Dependence {
  std::uint32_t from = 0;
  std::uint32_t to = 0;
  std::uint32_t distance = 0;
  std::uint32_t after = 0;
};

/// Dependence graph of a kernel: operations and accesses, without what costs nothing.
/// On an array with multiply-add units a product that one addition or subtraction alone uses is part of that operation,
/// which reads its other operand when the product is there. So fusing takes nothing longer.
class ScheduleGraph {
 public:
  ScheduleGraph(const kernels::Graph& graph, const SrpConfig& config);

  const std::vector<Operation>& operations() const { return operations_; }
  const std::vector<Dependence>& dependences() const { return dependences_; }
  /// Node `id` is a product that is part of an addition.
  bool is_fused(std::uint32_t id) const { return fused_[id]; }

  /// For each operation the longest way, in cycles, from its issue to the end of its item or of a later one, when
  /// items start every `ii` cycles. Empty if `ii` is too short for a value handed from item to item.
  std::vector<std::int64_t> heights(std::uint32_t ii) const;
  /// The least interval for which there are heights.
  std::uint32_t recurrence_interval() const;

 private:
  /// Where a value comes from: an operation of this or an earlier item, or kNone (a constant, the item's number).
  struct Source {
    std::uint32_t operation = kernels::GraphNode::kNone;
    std::uint32_t distance = 0;
  };

  void fuse_products(const kernels::Graph& graph);
  bool adds_product(const kernels::GraphNode& node) const;
  void add_operations(const kernels::GraphNode& node, std::uint32_t id, const OpLatencyConfig& latency);
  /// Bytes that one access of such a load or store moves.
  std::uint32_t width(OpClass c) const { return c == OpClass::kCachedRead ? cache_width_ : kPortBytes; }
  void add_dependences(const kernels::Graph& graph, std::uint32_t id);
  void depend(const kernels::Graph& graph, std::uint32_t operation, std::uint32_t on_node, std::uint32_t after);
  Source source_of(const kernels::Graph& graph, std::uint32_t id) const;

  std::uint32_t cache_width_;
  std::uint32_t product_latency_;     ///< cycles until a multiply-add reads its other operand
  std::vector<bool> fused_;           ///< by node
  std::vector<std::uint32_t> first_;  ///< operation of each node
  std::vector<Operation> operations_;
  std::vector<Dependence> dependences_;
};

/// Functional units of one kind; not every unit of a pool can take every operation.
enum class Pool : std::uint8_t { kArray, kLocal, kCache, kCount };
inline constexpr std::size_t kPools = static_cast<std::size_t>(Pool::kCount);

Pool pool_of(OpClass c);
std::uint32_t pool_size(Pool pool, const ArrayConfig& array);
/// How many units of its pool, from the first on, can take such an operation.
std::uint32_t capable_units(OpClass c, const ArrayConfig& array);
/// The least interval at which every operation finds a unit.
std::uint32_t resource_interval(const std::vector<Operation>& operations, const ArrayConfig& array);

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
