#include <algorithm>
#include <deque>
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "shader_kernels/catalogue.h"
#include "shader_kernels/programs/wavefront/scene_tables.h"
#include "sim/hash.h"
#include "tests/shader_kernels/interpret.h"

namespace kernels {
namespace {

constexpr std::uint32_t kItems = 200;
constexpr std::uint32_t kRecords = 16 * kItems;  ///< size of each memory in records; random indices may exceed the
                                                 ///< items
constexpr std::uint32_t kTextureSize = 16;
constexpr std::uint32_t kLeast = 32;  // samples from here on have neighbours on all sides

/// Binds every port of a kernel to random records, and every uniform to a random value.
class RandomPorts {
 public:
  /// `with_identities`: verdict words have the format of block programs, otherwise that of sub-pixels.
  RandomPorts(std::uint32_t seed, bool with_misses, bool with_identities)
      : seed_(seed), with_misses_(with_misses), with_identities_(with_identities) {
    for (std::uint32_t i = 0; i < kItems; ++i) {
      traces::Texture& t = textures_.emplace_back();
      t.width = t.height = kTextureSize;
      for (std::uint32_t k = 0; k < kTextureSize * kTextureSize; ++k) t.texels.push_back(random());
    }
  }

  template <template <class> class R>
  void operator()(Local<float, R>& port, std::string_view name) {
    if (known(port, name)) return;
    port.base = memory<R>(name);
    if constexpr (std::is_same_v<R<float>, WordRecord<float>>) fill_stream(name);
  }
  template <template <class> class R>
  void operator()(Table<float, R>& port, std::string_view name) {
    if (!known(port, name)) port.base = memory<R>(name);
  }
  template <template <class> class R, traces::Access::Kind kKind>
  void operator()(Cached<float, R, kKind>& port, std::string_view name) {
    if (!known(port, name)) port.base = memory<R>(name);
  }
  void operator()(Texels<float>& port, std::string_view) { port.textures = textures_.data(); }
  void operator()(Counter<float>&, std::string_view) {}
  void operator()(LoopCarried<float>& port, std::string_view) { port.value = number(); }
  void operator()(float& uniform, std::string_view name) {
    const bool is_inverse = name.find("inverse_") != std::string_view::npos;
    const float count = counted(name);
    uniform = count == 0 ? number() : is_inverse ? 1 / count : count;
    // A light's range must reach surfaces.
    if (name == "light.inverse_range_squared") uniform *= 0.01F;
    if (name == "light.cone_offset") uniform += 1;
  }
  void operator()(std::uint32_t& uniform, std::string_view name) {
    if (name == "step" || name == "line_step") {
      uniform = random() % 2 == 0 ? 1 : 15;
    } else if (name == "digit_shift") {
      uniform = random() % 24;
    } else if (name == "round") {
      uniform = random() % 2 << kRoundShift;
    } else if (name == "mirrored" || name == "refracted" || name == "apart" || name == "branch" || name == "shaded") {
      uniform = random() % kItems;
    } else {
      uniform = name == "white" ? random() % (kItems / 2) : random();
    }
  }
  void operator()(Vec3<float>& uniform, std::string_view) { uniform = vector(); }

  std::deque<std::vector<std::byte>>& memories() { return memories_; }
  /// Returns the memories after a run, except those that a fused kernel keeps in registers.
  template <class K>
  std::deque<std::vector<std::byte>> stored() const {
    std::deque<std::vector<std::byte>> all = memories_;
    if constexpr (requires { K::kRegisters; }) {
      for (const std::string_view name : K::kRegisters) all[index_.at(std::string(name))].clear();
    }
    return all;
  }

 private:
  std::uint32_t random() { return static_cast<std::uint32_t>(sim::hash(seed_, drawn_++)); }
  float number() { return 0.1F + 1.9F * sim::hash_to_unit_float(sim::hash(seed_, drawn_++)); }
  float signed_number() { return number() * ((random() & 1U) != 0 ? 1.0F : -1.0F); }
  Vec3<float> vector() { return {signed_number(), signed_number(), signed_number()}; }

  /// True if a port of the same name has been bound; both then use the same memory.
  bool known(auto& port, std::string_view name) {
    const auto at = index_.find(name);
    if (at != index_.end()) port.base = memories_[at->second].data();
    return at != index_.end();
  }

  /// Returns a value for a uniform that is a count, or 0 if it is none. Counts are consistent: 4 samples per pixel, 5
  /// pixels per row, blocks of 2 to 4.
  float counted(std::string_view name) const {
    const float block = static_cast<float>(2 + seed_ % 3);
    if (name.ends_with("samples")) return 4;
    if (name == "width" || name == "inverse_width") return 5;
    if (name == "grid" || name == "inverse_grid") return 2;
    if (name == "pitch") return 10;
    if (name.ends_with("inner") || name.ends_with("across")) return 8;
    if (name.ends_with("gaps")) return block - 1;
    if (name == "line.block" || name == "line.inverse_block") return block;
    if (name.ends_with("row_step") || name.ends_with("line_step")) return 6;
    if (name == "line.step" || name.ends_with("first") || name == "lattice.step") return 1;
    if (name == "line.low") return 1;
    if (name == "line.high") return 40;
    return 0;
  }

  /// Fills samples that are read together with their neighbours, and words whose bits have a meaning.
  void fill_stream(std::string_view name) {
    const auto store = [&](auto&& word) {
      for (std::uint32_t i = 0; i <= kItems; ++i) {
        const std::uint32_t value = word();
        std::memcpy(memories_.back().data() + i * sizeof(value), &value, sizeof(value));
      }
    };
    const auto sample = [&] { return kLeast + random() % (kItems - 2 * kLeast); };
    if (name == "samples") store(sample);
    if (name == "passed") store([&] { return sample() | (random() % 3) << kGapShift; });
    if (name == "verdicts") {
      const std::uint32_t whole = with_identities_ ? kReferenceVerdict : 1U << kActiveShift;
      store([&] { return random() % 3 == 0 ? whole : random() % 2; });
    }
    if (name == "identities") store([&] { return random() & (kTracedSample | kInterpolatedSample | 1U); });
  }

  template <template <class> class R>
  std::byte* memory(std::string_view memory_name) {
    index_.emplace(memory_name, memories_.size());
    std::vector<R<float>> records(kRecords);
    for (R<float>& record : records) {
      if constexpr (std::is_same_v<R<float>, AxisRecord<float>>) {
        record = axis_record(kTextureSize, static_cast<traces::Texture::Wrap>(random() % 3),
                             static_cast<traces::Texture::Filter>(random() % 2));
      } else if constexpr (std::is_same_v<R<float>, LevelRecord<float>>) {
        with_footprints_ = true;
        record = {8 * number(), static_cast<float>(1U << random() % 5)};
      } else if constexpr (std::is_same_v<R<float>, InstanceHitRecord<float>>) {
        const auto weight = [&] { return random() << traces::kHalfBits; };
        record = {number(), weight() | random() % kItems, weight(), random() % kItems};
      } else {
        R<float>::fields(record, [&]<class T>(T& field, std::string_view name) { fill(field, name); });
      }
    }
    std::vector<std::byte>& bytes = memories_.emplace_back(records.size() * sizeof(R<float>));
    std::memcpy(bytes.data(), records.data(), bytes.size());
    return bytes.data();
  }
  void fill(float& field, std::string_view name) {
    field = signed_number();
    if (name == "place" && (random() & 3U) != 0) field = position_checksum<float>({1.5F, 0.5F, 2.5F});
  }
  void fill(Vec3<float>& field, std::string_view name) {
    field = vector();
    // Makes positions coincide sometimes.
    if ((name == "origin" || name == "position") && (random() & 3U) != 0) field = {1.5F, 0.5F, 2.5F};
  }
  void fill(std::uint32_t& field, std::string_view name) {
    field = random() % (name.ends_with("texture") ? kItems / 2 : kItems);
    if (name == "texture" && with_footprints_) field = pack_footprint<float>(field, number());
    if (name == "word" && (random() & 1U) != 0) field |= 1U << kActiveShift;
    if (name == "blue_why") field = random() & ((2U << kRoundShift) - 1);
    if (name == "shadows" || name == "objects") field %= 4;
    if (name == "triangle" && with_misses_ && (random() & 1U) != 0) field = traces::kNoHit;
  }

  const std::uint32_t seed_;
  const bool with_misses_, with_identities_;
  bool with_footprints_ = false;  ///< mip levels are read (their port is described first), so words of textures contain
                                  ///< footprints
  std::uint32_t drawn_ = 0;
  std::deque<std::vector<std::byte>> memories_;
  std::map<std::string, std::size_t, std::less<>> index_;
  std::vector<traces::Texture> textures_;
};

template <class K>
class Readings : public testing::Test {};

template <class T>
struct AsTypes;
template <class... Ks>
struct AsTypes<std::tuple<Ks...>> {
  using type = testing::Types<Ks...>;
};
TYPED_TEST_SUITE(Readings, AsTypes<AllKernels>::type, );

TYPED_TEST(Readings, ComputingAndInterpretingTheGraphGiveEqualBits) {
  using Ports = typename TypeParam::template Ports<float>;
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    Ports ports;
    RandomPorts random(
        seed, !requires { ports.attributes; } && !requires { ports.vertices; } && !requires { ports.objects; },
        requires { ports.identities; });
    Ports::describe(ports, random);
    const auto before = random.memories();

    Environment environment;
    Ports::describe(ports, EnvironmentBinder(environment));
    const auto start = environment.carried;
    interpret_graph(kernel_catalogue()[kKernelId<TypeParam>].graph, kItems, environment);
    const auto interpreted = random.stored<TypeParam>();

    for (std::size_t m = 0; m < before.size(); ++m) std::ranges::copy(before[m], random.memories()[m].begin());
    for (std::uint32_t i = 0; i < kItems; ++i) TypeParam::template body<float>(i, ports);

    EXPECT_TRUE(before != interpreted || start != environment.carried) << "nothing was stored or counted";
    EXPECT_EQ(interpreted, random.stored<TypeParam>()) << "seed " << seed;
    Environment after;
    Ports::describe(ports, EnvironmentBinder(after));
    EXPECT_EQ(environment.carried, after.carried) << "seed " << seed;
  }
}

}  // namespace
}  // namespace kernels
