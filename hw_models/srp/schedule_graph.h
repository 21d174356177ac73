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

/// Bytes that a port of the shader core's local memory moves per cycle.
inline constexpr std::uint32_t kPortBytes = 16;

/// What the kernel scheduler places: an operation of a kernel, or one port-wide access of a load or store.
struct Operation {
  OpClass kind = OpClass::kFree;
  std::uint32_t node = 0;
  std::uint32_t part = 0;
  std::uint32_t latency = 0;
  std::uint32_t occupancy = 1;
};

/// A dependence between operations of a kernel: operation `to` uses the result that operation `from` produced
/// `distance` items before. `to` reads the result `after` cycles after its own issue.
struct Dependence {
  std::uint32_t from = 0;
  std::uint32_t to = 0;
  std::uint32_t distance = 0;
  std::uint32_t after = 0;
};

/// Dependence graph of a kernel: the operations and memory accesses that occupy a unit or port. If the array has
/// multiply-add units, a product that is used only by one addition or subtraction is fused with it. The multiply-add
/// reads the other summand when its product is ready, so fusing lengthens no path.
class ScheduleGraph {
 public:
  ScheduleGraph(const kernels::Graph& graph, const SrpConfig& config);

  const std::vector<Operation>& operations() const { return operations_; }
  const std::vector<Dependence>& dependences() const { return dependences_; }
  /// True if node `id` of the kernel's graph is a product that is fused with an addition.
  bool is_fused(std::uint32_t id) const { return fused_[id]; }

  /// Returns the height of each operation: the longest path, in cycles, from its issue to the end of its loop item, or
  /// of a later item that uses its result. `ii`: initiation interval. Empty if `ii` is too short for a value passed
  /// from item to item.
  std::vector<std::int64_t> path_heights(std::uint32_t ii) const;
  /// Returns the smallest initiation interval at which every value passed from item to item arrives in time.
  std::uint32_t recurrence_interval() const;

 private:
  /// The operation that produced an operand, `distance` loop items earlier. kNone: the operand is a constant or the
  /// item's number.
  struct Source {
    std::uint32_t operation = kernels::GraphNode::kNone;
    std::uint32_t distance = 0;
  };

  void fuse_products(const kernels::Graph& graph);
  bool is_fused_addition(const kernels::GraphNode& node) const;
  void add_operations(const kernels::GraphNode& node, std::uint32_t id, const OpLatencyConfig& latency);
  /// Returns the bytes that one access moves, for a memory operation of class `op_class`.
  std::uint32_t access_bytes(OpClass op_class) const {
    return op_class == OpClass::kCachedRead ? cache_width_ : kPortBytes;
  }
  void add_dependences(const kernels::Graph& graph, std::uint32_t id);
  void add_dependence(const kernels::Graph& graph, std::uint32_t operation, std::uint32_t on_node, std::uint32_t after);
  Source source_of(const kernels::Graph& graph, std::uint32_t id) const;

  std::uint32_t cache_width_;
  std::uint32_t product_latency_;     ///< cycles from a multiply-add's issue until it reads the other summand
  std::vector<bool> fused_;           ///< for each node, whether it is fused with an addition (is_fused())
  std::vector<std::uint32_t> first_;  ///< index of each node's first operation
  std::vector<Operation> operations_;
  std::vector<Dependence> dependences_;
};

/// Pools of units or ports that operations occupy. Some operations can use only some units of their pool.
enum class Pool : std::uint8_t { kArray, kLocal, kCache, kCount };
inline constexpr std::size_t kPools = static_cast<std::size_t>(Pool::kCount);

Pool pool_of(OpClass op_class);
std::uint32_t pool_size(Pool pool, const ArrayConfig& array);
/// Returns the number of units that can execute operations of the class. These units come first in their pool.
std::uint32_t capable_units(OpClass op_class, const ArrayConfig& array);
/// Returns the smallest initiation interval at which the array has enough units and ports for a kernel's operations.
std::uint32_t resource_interval(const std::vector<Operation>& operations, const ArrayConfig& array);

/// A bit vector that is searched 64 bits at a time.
class BitVector {
 public:
  explicit BitVector(std::uint32_t size) : size_(size), words_((size + 63) / 64) {}

  std::uint32_t size() const { return size_; }
  void set(std::uint32_t index, bool value) {
    const std::uint64_t bit = std::uint64_t{1} << index % 64;
    std::uint64_t& word = words_[index / 64];
    set_ += (value ? 1U : 0U) - ((word & bit) != 0 ? 1U : 0U);
    word = value ? word | bit : word & ~bit;
  }
  std::uint32_t count_of(bool value) const { return value ? set_ : size_ - set_; }
  /// Returns the first index in [from, end) of a bit that equals `value`; `end` if there is none.
  std::uint32_t find_first(std::uint32_t from, std::uint32_t end, bool value) const {
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

/// Returns the number of rows, in a unit's cyclic reservation table, from `row` to the next row that is busy
/// (`is_busy`) or free (not `is_busy`). Returns the size of the table if there is none. `row` may exceed that size.
inline std::uint32_t rows_until(const BitVector& rows, std::uint32_t row, bool is_busy) {
  std::uint32_t first = row;
  while (first >= rows.size()) first -= rows.size();
  const std::uint32_t found = rows.find_first(first, rows.size(), is_busy);
  return found < rows.size() ? found - first : rows.size() - first + rows.find_first(0, first, is_busy);
}

/// Returns the number of rows, in a unit's cyclic reservation table, from row `from` to the next gap of `length` free
/// rows; at most `limit`.
inline std::uint32_t rows_until_gap(const BitVector& rows, std::uint32_t from, std::uint32_t length,
                                    std::uint32_t limit) {
  if (rows.count_of(false) < length) return limit;
  for (std::uint32_t at = 0; at < limit;) {
    at += rows_until(rows, from + at, false);
    const std::uint32_t gap = length == 1 ? 1 : rows_until(rows, from + at, true);
    if (gap >= length) return std::min(at, limit);
    at += gap;
  }
  return limit;
}

}  // namespace hw
