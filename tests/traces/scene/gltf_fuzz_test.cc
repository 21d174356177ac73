#include <chrono>

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "sim/error.h"
#include "sim/hash.h"
#include "tests/traces/scene/gltf_mutants.h"
#include "tests/traces/scene/gltf_seeds.h"

// Tests that small files with random changes become a scene or are refused with an InputError of one line, quickly and
// within the memory limit. The changes are the same in every run.

namespace test {
namespace {

constexpr int kMutantsPerSeed = 150;

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
