#include <chrono>

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "sim/error.h"
#include "sim/hash.h"
#include "tests/traces/scene/gltf_seeds.h"

// Small files changed in every way, the same ones in every run: each becomes a scene or is refused with an InputError
// of one line, quickly and within the memory allowed.

namespace test {
namespace {

using nlohmann::json;

constexpr int kMutantsPerSeed = 150;

/// Draws numbers for one mutant.
class Dice {
 public:
  explicit Dice(std::uint64_t mutant) : mutant_(mutant) {}
  std::size_t below(std::size_t limit) { return limit == 0 ? 0 : sim::hash(mutant_, count_++) % limit; }

 private:
  std::uint64_t mutant_, count_ = 0;
};

void collect(json& value, std::vector<json*>& all) {
  all.push_back(&value);
  if (value.is_structured()) {
    for (json& child : value) collect(child, all);
  }
}

/// Another value in the place of some value of the JSON, or a member that is gone.
void edit_json(TinyGltf& file, Dice& dice) {
  static const json kValues[] = {0,
                                 1,
                                 2,
                                 3,
                                 -1,
                                 255,
                                 65536,
                                 1'000'000'000,
                                 1U << 31,
                                 UINT_MAX,
                                 1ULL << 53,
                                 1e300,
                                 -1e300,
                                 1e-300,
                                 0.5,
                                 "",
                                 "text",
                                 "TRIANGLES",
                                 nullptr,
                                 true,
                                 json::array(),
                                 json::object(),
                                 json::array({0, 0}),
                                 json::array({1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16})};
  std::vector<json*> all;
  collect(file.json, all);
  json& target = *all[1 + dice.below(all.size() - 1)];
  if (target.is_object() && !target.empty() && dice.below(2) == 0) {
    auto victim = target.begin();
    std::advance(victim, static_cast<std::ptrdiff_t>(dice.below(target.size())));
    target.erase(victim);
  } else if (target.is_number_integer() && dice.below(2) == 0) {
    target = target.get<std::int64_t>() + static_cast<std::int64_t>(dice.below(9)) - 4;
  } else {
    target = kValues[dice.below(std::size(kValues))];
  }
}

void set_word(std::string& bytes, std::size_t at, std::uint32_t value) {
  if (at + sizeof value <= bytes.size()) std::memcpy(bytes.data() + at, &value, sizeof value);
}

std::string mutant_of(const TinyGltf& seed, std::uint64_t number) {
  Dice dice(number);
  TinyGltf file = seed;
  switch (dice.below(6)) {
    case 0:  // flipped bits in the buffer: numbers, indices, compressed data, pictures
      for (std::size_t n = 1 + dice.below(4); n > 0; --n) {
        char& byte = file.binary[dice.below(file.binary.size())];
        byte = static_cast<char>(byte ^ (1 << dice.below(8)));
      }
      return file.glb();
    case 1: {  // a run of other bytes in the buffer
      const std::size_t begin = dice.below(file.binary.size()), run = 1 + dice.below(16);
      for (std::size_t i = begin; i < std::min(begin + run, file.binary.size()); ++i) {
        file.binary[i] = static_cast<char>(dice.below(2) == 0 ? 0xff : dice.below(256));
      }
      return file.glb();
    }
    case 2: {  // cut, with or without a header that admits it
      std::string bytes = file.glb();
      bytes.resize(dice.below(bytes.size()));
      if (dice.below(2) == 0) set_word(bytes, 8, static_cast<std::uint32_t>(bytes.size()));
      return bytes;
    }
    case 3: {  // lies about lengths, flipped bits anywhere
      std::string bytes = file.glb();
      set_word(bytes, 4 * dice.below(5), static_cast<std::uint32_t>(sim::hash(number, 99) >> dice.below(32)));
      char& byte = bytes[dice.below(bytes.size())];
      byte = static_cast<char>(byte ^ (1 << dice.below(8)));
      return bytes;
    }
    default:  // other values in the JSON
      for (std::size_t n = 1 + dice.below(3); n > 0; --n) edit_json(file, dice);
      return dice.below(2) == 0 ? file.glb() : file.text();
  }
}

long peak_kib() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss;
}

struct Figures {
  int scenes = 0, refusals = 0;
  double slowest = 0;
};

void try_out(const std::filesystem::path& path, const traces::SceneLimits& limits, Figures& figures) {
  const auto begin = std::chrono::steady_clock::now();
  try {
    const traces::Scene scene = traces::load_gltf(path, limits);
    EXPECT_FALSE(scene.instances.empty());
    for (const traces::Instance& instance : scene.instances) ASSERT_LT(instance.mesh, scene.meshes.size());
    for (const traces::Mesh& mesh : scene.meshes) {
      ASSERT_LT(mesh.material, scene.materials.size());
      for (const auto& triangle : mesh.triangles) {
        for (const std::uint32_t vertex : triangle) ASSERT_LT(vertex, mesh.positions.size());
      }
    }
    ++figures.scenes;
  } catch (const sim::InputError& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    ++figures.refusals;
  }
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  EXPECT_LT(took.count(), 5);
  figures.slowest = std::max(figures.slowest, took.count());
}

TEST(GltfFuzz, SeedsAreGoodFiles) {
  for (const Seed& seed : seeds()) {
    SCOPED_TRACE(seed.name);
    const TempFolder folder;
    EXPECT_FALSE(traces::load_gltf(folder.write("a.glb", seed.file.glb())).instances.empty());
    EXPECT_LT(seed.file.glb().size(), 3000U);
  }
}

TEST(GltfFuzz, EveryMutantBecomesASceneOrIsRefused) {
  const traces::SceneLimits limits{.memory = {std::uint64_t{1} << 24}, .pixels = 1 << 20, .nodes = 1000};
  const TempFolder folder;
  [[maybe_unused]] const long before = peak_kib();
  for (const Seed& seed : seeds()) {
    Figures figures;
    for (int i = 0; i < kMutantsPerSeed; ++i) {
      SCOPED_TRACE(seed.name + ", mutant " + std::to_string(i));
      const std::string bytes = mutant_of(seed.file, sim::hash(static_cast<std::uint64_t>(i), seed.name.size()));
      try_out(folder.write("mutant.gltf", bytes), limits, figures);
      if (HasFatalFailure()) return;
    }
    EXPECT_GT(figures.refusals, kMutantsPerSeed / 10) << seed.name << ": the mutations do not bite";
    EXPECT_GT(figures.scenes, 0) << seed.name << ": the mutations break everything";
    std::cout << seed.name << ": " << figures.scenes << " scenes, " << figures.refusals << " refusals, slowest "
              << figures.slowest << " s\n";
  }
#ifndef RAYWATT_SANITIZED
  EXPECT_LT(peak_kib() - before, 200'000) << "KiB; a file may take 16 MiB, the image library is loaded on the way";
#endif
}

}  // namespace
}  // namespace test
