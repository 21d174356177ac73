#pragma once
#include <algorithm>
#include <numeric>
#include <ostream>
#include <span>
#include <string_view>

#include <gtest/gtest.h>

#include "shader_kernels/catalogue.h"
#include "shader_kernels/graph.h"

namespace kernels {

/// Numbers of operations of a kernel, by class of functional unit.
struct Count {
  std::uint32_t add, mul, div_sqrt, other, compare, select, integer, convert, load, store, cached;
  friend bool operator==(const Count&, const Count&) = default;
};

inline Count count(const Graph& graph) {
  const OpCounts ops = count_ops(graph);
  const auto sum = [&](std::initializer_list<Op> kinds) {
    return std::accumulate(kinds.begin(), kinds.end(), 0U,
                           [&](std::uint32_t n, Op op) { return n + ops[static_cast<std::size_t>(op)]; });
  };
  return {.add = sum({Op::kAdd, Op::kSub}),
          .mul = sum({Op::kMul}),
          .div_sqrt = sum({Op::kDiv, Op::kSqrt}),
          .other = sum({Op::kMin, Op::kMax, Op::kAbs, Op::kNeg, Op::kFloor}),
          .compare = sum({Op::kLess, Op::kLessEqual, Op::kEqual, Op::kIntLess, Op::kIntEqual}),
          .select = sum({Op::kSelect}),
          .integer = sum(
              {Op::kIntAdd, Op::kIntSub, Op::kIntMul, Op::kAnd, Op::kOr, Op::kXor, Op::kShiftLeft, Op::kShiftRight}),
          .convert = sum({Op::kToFloat, Op::kToInt}),
          .load = sum({Op::kLoadLocal}),
          .store = sum({Op::kStoreLocal}),
          .cached = sum({Op::kLoadCached})};
}

inline std::ostream& operator<<(std::ostream& out, const Count& c) {
  return out << c.add << ' ' << c.mul << ' ' << c.div_sqrt << ' ' << c.other << ' ' << c.compare << ' ' << c.select
             << ' ' << c.integer << ' ' << c.convert << ' ' << c.load << ' ' << c.store << ' ' << c.cached;
}

struct Hand {
  std::string_view kernel;
  Count count;
};

/// Id of the first fused kernel; the catalogue lists fused kernels after all others.
inline constexpr traces::KernelId kFirstFused = kKernelId<FetchSurface<false>>;

inline void expect_counts(std::span<const Hand> by_hand) {
  for (const Hand& hand : by_hand) {
    const KernelInfo* kernel = find_kernel(hand.kernel);
    ASSERT_NE(kernel, nullptr) << hand.kernel;
    EXPECT_EQ(count(kernel->graph), hand.count) << hand.kernel;
  }
}

}  // namespace kernels
