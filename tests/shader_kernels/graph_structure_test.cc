#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "shader_kernels/catalogue.h"
#include "shader_kernels/graph.h"

namespace kernels {
namespace {

TEST(Graphs, KernelsAreFoundByIdAndName) {
  for (std::size_t i = 0; i < kernel_catalogue().size(); ++i) {
    EXPECT_EQ(kernel_catalogue()[i].id, i);
    EXPECT_EQ(find_kernel(kernel_catalogue()[i].name), &kernel_catalogue()[i]);
    EXPECT_EQ(kernel_catalogue()[i].graph.kernel, kernel_catalogue()[i].name);
    EXPECT_FALSE(kernel_catalogue()[i].meaning.empty());
  }
  EXPECT_EQ(kKernelId<ShadeGlass>, find_kernel("shade_glass")->id);
  EXPECT_EQ(find_kernel("shade_nothing"), nullptr);
}

TEST(Graphs, InputsComeFirstUnlessCarried) {
  for (const KernelInfo& kernel : kernel_catalogue()) {
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
  for (const KernelInfo& kernel : kernel_catalogue()) {
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
  const std::string text = node_listing(graph);
  EXPECT_EQ(static_cast<std::size_t>(std::ranges::count(text, '\n')), graph.nodes.size());
  EXPECT_NE(text.find("shadow_hits.triangle"), std::string::npos);
  EXPECT_NE(operation_summary(graph).find("combine_shadow: 11 operations"), std::string::npos);
}

}  // namespace
}  // namespace kernels
