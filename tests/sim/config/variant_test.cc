#include "sim/config/variant.h"

#include <gtest/gtest.h>

#include "machine.h"
#include "sim/config/describe.h"

namespace sim::test {
namespace {

/// A configuration and a variant of it.
struct Bound {
  MachineConfig base, config;
  ConfigNode base_tree = config_tree(base), tree = config_tree(config);
  ConfigVariant variant{base_tree, tree};

  void set(const std::string& argument) { ConfigLoader(tree).apply_set(argument); }
  void expect_hashes_of_the_whole_tree() const {
    EXPECT_EQ(variant.hash({}), hash_tree(tree, {}));
    for (std::size_t i = 0; i < names_of(Affects{}).size(); ++i) {
      const auto only = static_cast<Affects>(i);
      EXPECT_EQ(variant.hash(only), hash_tree(tree, only)) << names_of(only)[i];
    }
  }
};

constexpr const char* kArguments[] = {"direct=false",
                                      "seed=99",
                                      "threshold=0.25",
                                      "name=\"a: b\"",
                                      "clock=333 MHz",
                                      "fabric=3 ns",
                                      "refresh={low: 1, nominal: 4, high: 9}",
                                      "events.tni.box_test=3",
                                      "unit.rays=7",
                                      "unit.stack=restart",
                                      "unit.prefetch=on",
                                      "unit.l1.size=4 KiB",
                                      "l2.ways=8"};

TEST(ConfigVariant, HashesAsItsWholeTreeWhateverHasChanged) {
  Bound b;
  b.expect_hashes_of_the_whole_tree();
  for (const char* argument : kArguments) {
    SCOPED_TRACE(argument);
    b.set(argument);
    b.expect_hashes_of_the_whole_tree();
  }
}

TEST(ConfigVariant, IsTheBaseAfterAReset) {
  Bound b;
  const std::string hash = b.variant.hash({});
  for (const char* argument : kArguments) {
    SCOPED_TRACE(argument);
    b.set(argument);
    EXPECT_NE(b.variant.hash({}), hash);
    b.variant.reset();
    EXPECT_EQ(b.config, b.base);
    EXPECT_EQ(b.variant.hash({}), hash);
    for (const ConfigNode& node : b.tree.children) EXPECT_EQ(node.origin, "") << node.key;
  }
}

TEST(ConfigVariant, NamesNoFormerArgumentAfterAReset) {
  Bound b;
  b.set("l2.ways=3");  // the number of sets is then not an integer
  EXPECT_THROW(check_tree(b.tree), std::exception);
  b.variant.reset();
  EXPECT_NO_THROW(check_tree(b.tree));
}

}  // namespace
}  // namespace sim::test
