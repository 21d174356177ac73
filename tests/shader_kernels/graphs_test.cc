#include <algorithm>
#include <numeric>
#include <ostream>

#include <gtest/gtest.h>

#include "shader_kernels/catalogue.h"
#include "shader_kernels/listing.h"

namespace kernels {
namespace {

/// Operations of a kernel by what executes them.
struct Count {
  std::uint32_t add, mul, div_sqrt, other, compare, select, integer, convert, load, store, cached;
  friend bool operator==(const Count&, const Count&) = default;
};

Count count(const Graph& graph) {
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

std::ostream& operator<<(std::ostream& out, const Count& c) {
  return out << c.add << ' ' << c.mul << ' ' << c.div_sqrt << ' ' << c.other << ' ' << c.compare << ' ' << c.select
             << ' ' << c.integer << ' ' << c.convert << ' ' << c.load << ' ' << c.store << ' ' << c.cached;
}

// Counted by hand from the kernels' sources:
//
//   dot 3 mul 2 add | vector + vector 3 add | vector * scalar 3 mul | largest 2 max
//   normalised      dot, max, sqrt, div, 3 mul                            2 add  6 mul 2 div_sqrt 1 other
//   split           add, mul, floor, mul, sub                             2 add  2 mul 1 other
//   scrambled       3 xor, 3 shift, 2 mul                                 8 integer
//   next            select, int_add                                       1 select 1 integer
//   add_light       load, 3 add, store                                    3 add
//   interface       -dot, less, 1/ior, select; 3 mul 2 sub; sub add div; compare max sqrt select sub; mul;
//                   4 mul 3 sub              10 add 11 mul 3 div_sqrt 2 other 2 compare 2 select
//
//   generate_rays             3 split, 2 + 2 (2 add, mul), 2 scale, 2 vector add, normalised, to_float
//   generate_jittered_rays    the same with 2 (shift, to_float, mul) for 0.5; 2 to_int, mul, add; xor; 3 scrambled;
//                             to_int, add; xor
//   classify_hits             2 (compare, next)
//   shade_background          3 mul, add_light
//   shade_surface             2 sub; 3 scale, 2 vector add, normalised; dot, compare, select; scale; scale, vector add;
//                             2 sub, 4 mul; 2 max; 6 mul 4 add; classes: 3 max, 5 compare, and, 4 or, 5 select
//   classify_surfaces         5 (and, compare, next)
//   shade_textured            2 neighbours (max min, mul floor mul sub, sub min, mul sub, floor, add, 2 compare,
//                             2 select, 2 to_int, sub); shift, add; 2 shift, 2 or; 4 texels of 3 channels (to_float,
//                             mul, 3 mul 2 add) with 3 and, 2 shift; 3 blends of 3 (sub, mul, add); 3 mul
//   shade_emission            3 mul, add_light
//   shade_ambient             6 mul, add_light
//   shade_diffuse             scale, vector sub; dot, sqrt, div; dot, mul; dot, neg, mul; mul add max min; 4 mul;
//                             9 mul; 2 max, compare, next; mul, sub
//   combine_shadow            compare, 3 select, add_light
//   shade_mirror              interface; sub, 2 mul; scale, vector add; mul, scale, vector add; 3 mul; 2 max,
//                             compare, next
//   shade_glass               interface; mul, max, sqrt, sub; 2 scale, vector add; 2 sub, 2 mul; scale; 2 max,
//                             compare, next
//   average_colour            to_float, split, compare; 3 (select, max, min, add); to_int; 3 mul
//   pack_colour               3 (max min, 3 sqrt, 3 mul add sub, compare, mul, select, mul, add, to_int); 2 shift, 3 or
struct Hand {
  std::string_view kernel;
  Count count;
};
constexpr Hand kByHand[] = {
    //                         add mul d/s oth cmp sel int cnv  ld  st  $
    {"generate_rays", {20, 20, 2, 4, 0, 0, 0, 1, 0, 3, 0}},
    {"generate_jittered_rays", {20, 22, 2, 4, 0, 0, 31, 6, 0, 3, 0}},
    {"classify_hits", {0, 0, 0, 0, 2, 2, 2, 0, 1, 2, 0}},
    {"shade_background", {3, 3, 0, 0, 0, 0, 0, 0, 3, 1, 0}},
    {"shade_surface", {21, 34, 2, 6, 6, 6, 5, 0, 3, 3, 2}},
    {"classify_surfaces", {0, 0, 0, 0, 5, 5, 10, 0, 2, 5, 0}},
    {"shade_textured", {52, 66, 0, 10, 4, 4, 26, 16, 5, 1, 1}},
    {"shade_emission", {3, 3, 0, 0, 0, 0, 0, 0, 4, 1, 1}},
    {"shade_ambient", {3, 6, 0, 0, 0, 0, 0, 0, 4, 1, 0}},
    {"shade_diffuse", {11, 29, 2, 5, 1, 1, 1, 0, 4, 2, 0}},
    {"combine_shadow", {3, 0, 0, 0, 1, 3, 0, 0, 3, 1, 0}},
    {"shade_mirror", {17, 23, 3, 4, 3, 3, 1, 0, 4, 2, 1}},
    {"shade_glass", {16, 23, 4, 5, 3, 3, 1, 0, 4, 2, 1}},
    {"average_colour", {5, 5, 0, 7, 1, 3, 0, 2, 1, 1, 0}},
    {"pack_colour", {9, 15, 9, 6, 3, 3, 5, 3, 1, 1, 0}},
};

TEST(Graphs, OperationsAreThoseOfTheSource) {
  ASSERT_EQ(std::size(kByHand), catalogue().size());
  for (const Hand& hand : kByHand) {
    const KernelInfo* kernel = find_kernel(hand.kernel);
    ASSERT_NE(kernel, nullptr) << hand.kernel;
    EXPECT_EQ(count(kernel->graph), hand.count) << hand.kernel;
  }
}

TEST(Graphs, KernelsAreFoundByIdAndName) {
  for (std::size_t i = 0; i < catalogue().size(); ++i) {
    EXPECT_EQ(catalogue()[i].id, i);
    EXPECT_EQ(find_kernel(catalogue()[i].name), &catalogue()[i]);
    EXPECT_EQ(catalogue()[i].graph.kernel, catalogue()[i].name);
    EXPECT_FALSE(catalogue()[i].meaning.empty());
  }
  EXPECT_EQ(kKernelId<ShadeGlass>, find_kernel("shade_glass")->id);
  EXPECT_EQ(find_kernel("shade_nothing"), nullptr);
}

TEST(Graphs, InputsComeFirstUnlessCarried) {
  for (const KernelInfo& kernel : catalogue()) {
    for (std::uint32_t i = 0; i < kernel.graph.nodes.size(); ++i) {
      const GraphNode& node = kernel.graph.nodes[i];
      for_each_input(node, [&](std::uint32_t id) {
        EXPECT_LT(id, kernel.graph.nodes.size());
        EXPECT_TRUE(id < i || node.distance != 0) << kernel.name << " node " << i;
      });
      EXPECT_TRUE(node.distance == 0 || node.op == Op::kInput);
      EXPECT_EQ(node.stored.size() * 4, node.op == Op::kStoreLocal ? node.bytes : 0);
    }
  }
}

TEST(Graphs, LiteralsAreRecordedOnce) {
  for (const KernelInfo& kernel : catalogue()) {
    std::vector<std::uint32_t> bits;
    for (const GraphNode& node : kernel.graph.nodes) {
      if (node.op == Op::kConstant && node.label.empty()) bits.push_back(node.value);
    }
    std::ranges::sort(bits);
    EXPECT_EQ(std::ranges::adjacent_find(bits), bits.end()) << kernel.name;
  }
}

TEST(Graphs, CompactionIsALoopCarriedCount) {
  const Graph& graph = find_kernel("classify_hits")->graph;
  std::uint32_t carried = 0;
  for (const GraphNode& node : graph.nodes) {
    if (node.distance == 0) continue;
    ++carried;
    EXPECT_EQ(graph.nodes[node.inputs[0]].op, Op::kIntAdd);
  }
  EXPECT_EQ(carried, 2U);
}

TEST(Graphs, ListingShowsEveryNode) {
  const Graph& graph = find_kernel("combine_shadow")->graph;
  const std::string text = listing(graph);
  EXPECT_EQ(static_cast<std::size_t>(std::ranges::count(text, '\n')), graph.nodes.size());
  EXPECT_NE(text.find("shadow_hits.triangle"), std::string::npos);
  EXPECT_NE(summary(graph).find("combine_shadow: 11 operations"), std::string::npos);
}

}  // namespace
}  // namespace kernels
