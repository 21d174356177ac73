#include <stdexcept>

#include <gtest/gtest.h>

#include "shader_kernels/catalogue.h"
#include "shader_kernels/graph.h"
#include "shader_kernels/recorder.h"
#include "sim/named.h"

namespace kernels {
namespace {

struct Double {
  template <class V>
  struct Ports {
    Local<V, WordRecord> words, doubled;
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.words));
      port(NAMED(p.doubled));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> word = at.words.load(item).word;
    at.doubled.store(item, {word + word});
  }
};

/// Part of a fused kernel: loads a word and its double, and adds them.
struct Add {
  template <class V>
  struct Ports {
    Local<V, WordRecord> words, doubled, sums;
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.words));
      port(NAMED(p.doubled));
      port(NAMED(p.sums));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    at.sums.store(item, {at.words.load(item).word + at.doubled.load(item).word});
  }
};

/// Part of a fused kernel: loads the double, adds one, and stores it.
struct Increment {
  template <class V>
  struct Ports {
    Local<V, WordRecord> doubled;
    static void describe(auto& p, auto&& port) { port(NAMED(p.doubled)); }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    at.doubled.store(item, {at.doubled.load(item).word + 1U});
  }
};

/// Part that cannot use registers: it loads the double of the next item.
struct LookAhead {
  template <class V>
  struct Ports {
    Local<V, WordRecord> doubled, ahead;
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.doubled));
      port(NAMED(p.ahead));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    at.ahead.store(item, {at.doubled.load(item + 1U).word});
  }
};

/// Part that doubles a word of its own, by the same operation as another part.
struct DoubleAgain {
  template <class V>
  struct Ports {
    Local<V, WordRecord> words, again;
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.words));
      port(NAMED(p.again));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> word = at.words.load(item).word;
    at.again.store(item, {word + word});
  }
};

template <class... Parts>
struct Named : Fused<Parts...> {
  static constexpr std::string_view kName = "test";
};
struct InRegisters : Named<Double, Add> {
  static constexpr std::array<std::string_view, 1> kRegisters{"doubled"};
};
struct NeverStored : Named<Add> {
  static constexpr std::array<std::string_view, 1> kRegisters{"doubled"};
};

/// Returns the number of nodes with an operation in the graph of kernel K.
template <class K>
std::uint32_t number_of(Op op) {
  return count_ops(record_graph<K>())[static_cast<std::size_t>(op)];
}

TEST(Fusion, LoadsEachRecordOnceAndTakesStoredOnesFromRegisters) {
  using K = Named<Double, Add>;
  EXPECT_EQ(number_of<K>(Op::kLoadLocal), 1U);
  EXPECT_EQ(number_of<K>(Op::kStoreLocal), 2U);
  EXPECT_EQ(number_of<K>(Op::kIntAdd), 2U);
}

TEST(Fusion, StoresNothingInMemoriesWithoutOtherReaders) {
  EXPECT_EQ(number_of<InRegisters>(Op::kStoreLocal), 1U);
  EXPECT_EQ(number_of<InRegisters>(Op::kLoadLocal), 1U);
}

TEST(Fusion, StoresARecordThatPartsChangeOnce) {
  using K = Named<Double, Increment>;
  EXPECT_EQ(number_of<K>(Op::kStoreLocal), 1U);
  const Graph graph = record_graph<K>();
  EXPECT_EQ(graph.nodes[graph.nodes.back().stored.front()].op, Op::kIntAdd);
  EXPECT_EQ(number_of<K>(Op::kIntAdd), 2U);
}

TEST(Fusion, SharesEqualOperationsOfParts) {
  using K = Named<Double, DoubleAgain>;
  EXPECT_EQ(number_of<K>(Op::kIntAdd), 1U);
  EXPECT_EQ(number_of<K>(Op::kStoreLocal), 2U);
}

TEST(Fusion, RefusesALoadOfWhatAnotherPartMayHaveStored) {
  EXPECT_THROW((record_graph<Named<Double, LookAhead>>()), std::logic_error);
}

TEST(Fusion, RefusesALoadOfARegisterThatNoPartHasStored) {
  EXPECT_THROW(record_graph<NeverStored>(), std::logic_error);
}

TEST(Fusion, NamesTheKernelsWhoseWorkItDoes) {
  using Names = std::vector<std::string_view>;
  EXPECT_EQ((CheckInterpolate<false, true, false>::part_names()),
            (Names{"check_similarity_x_secondary", "interpolate_x_secondary"}));
  EXPECT_EQ(PackSample::part_names(), Names{"pack_colour"});
  for (const KernelInfo& kernel : kernel_catalogue()) {
    for (const std::string_view part : kernel.parts) EXPECT_TRUE(find_kernel(part)->parts.empty()) << kernel.name;
    const bool is_variant = kernel.name.ends_with("_untextured") || kernel.name.ends_with("_local");
    EXPECT_EQ(kernel.parts.empty(), kernel.id < kKernelId<FetchSurface<false>> || is_variant) << kernel.name;
  }
}

TEST(Fusion, ListsTheAccessesOfAnyPart) {
  EXPECT_TRUE(kListsAccesses<FetchLit<false>::Ports<float>>);
  EXPECT_TRUE(kListsAccesses<LightSurfaceGeometry<true>::Ports<float>>);
  EXPECT_FALSE(kListsAccesses<LightSurface::Ports<float>>);
  EXPECT_FALSE(kListsAccesses<CombineRecordShadow::Ports<float>>);
}

}  // namespace
}  // namespace kernels
