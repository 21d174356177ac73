#include <cstdlib>
#include <fstream>

#include <gtest/gtest.h>

#include "sim/error.h"
#include "sim/hash.h"
#include "tests/real_scenes.h"
#include "tests/traces/scene/feature_scene.h"
#include "tests/traces/scene/gltf_mutants.h"
#include "tests/traces/scene/gltf_seeds.h"
#include "tests/traces/scene/random_gltf.h"
#include "traces/scene/export.h"
#include "traces/scenes/builtin.h"

// Tests that the Khronos validator reports neither errors nor warnings about exported scenes. RAYWATT_EXPORTS sets the
// number of random files (default 16), and adds large built-in scenes and real scenes.

namespace test {
namespace {

std::size_t files_wanted() {
  const char* wanted = std::getenv("RAYWATT_EXPORTS");
  return wanted == nullptr ? 16 : std::strtoull(wanted, nullptr, 10);
}

bool is_long() { return std::getenv("RAYWATT_EXPORTS") != nullptr; }

/// Exports scenes and validates many of them in one run of the validator.
class Exports {
 public:
  ~Exports() { std::cout << count_ << " exports validated\n"; }

  void add(const std::string& name, const traces::Scene& scene) {
    const std::string glb = traces::export_glb(scene);
    std::string file = std::to_string(count_++) + " " + name + ".glb";
    std::ranges::replace(file, '/', '-');
    list_ += folder_.write(file, glb).string() + "\n";
    bytes_ += glb.size();
    ++waiting_;
    if (waiting_ == 100 || bytes_ > kMostBytes) {
      EXPECT_EQ(complaints(), "");
    }
  }

  /// Runs the validator on the files since the last call and returns its output.
  std::string complaints() {
    if (waiting_ == 0) return {};
    if (std::system("command -v node >/dev/null") != 0) return "node is not installed; tools/test installs it";
    if (!std::filesystem::exists(GLTF_VALIDATOR_MODULES)) {
      return "the glTF validator is not installed in " GLTF_VALIDATOR_MODULES "; tools/test installs it";
    }
    const TempFolder folder;
    const std::filesystem::path list = folder.write("list", list_), said = folder.path() / "said";
    const std::string command =
        "node '" GLTF_VALIDATOR "' '" GLTF_VALIDATOR_MODULES "' <'" + list.string() + "' >'" + said.string() + "' 2>&1";
    const int status = std::system(command.c_str());
    const std::string text = read_bytes(said);
    std::istringstream files(std::exchange(list_, {}));
    for (std::string file; std::getline(files, file);) std::filesystem::remove(file);
    waiting_ = bytes_ = 0;
    return status != 0 && text.empty() ? "the validator failed" : text;
  }

 private:
  static constexpr std::size_t kMostBytes = std::size_t{1} << 28;
  TempFolder folder_;
  std::string list_;
  std::size_t count_ = 0, waiting_ = 0, bytes_ = 0;
};

/// Reads a file, and exports it if it is valid.
void add_file(Exports& exports, const std::string& name, const std::string& bytes) {
  const TempFolder folder;
  traces::SceneLimits limits;
  limits.memory = {std::uint64_t{1} << 26};
  try {
    exports.add(name, traces::load_gltf(folder.write("a.gltf", bytes), limits));
  } catch (const sim::InputError&) {
  }
}

TEST(ExportValidity, TheValidatorFindsWhatIsWrong) {
  Exports exports;
  traces::Scene scene = feature_scene();
  scene.materials[0].name = "fine";
  scene.cameras[0].vertical_fov = -1;
  exports.add("a camera without an angle", scene);
  EXPECT_SAYS(exports.complaints(), "0 a camera without an angle.glb: error ");
}

TEST(ExportValidity, OfBuiltinScenes) {
  Exports exports;
  for (const traces::BuiltinInfo& info : traces::builtin_scenes()) {
    if (!is_long() && info.triangles > 60'000) continue;
    exports.add(info.name, traces::build_scene(info.name));
    for (const std::uint32_t triangles : {1000U, 20'000U}) {
      if (is_long()) exports.add(info.name, traces::build_scene(info.name, {.triangles = triangles}));
    }
  }
  exports.add("features", feature_scene());
  EXPECT_EQ(exports.complaints(), "");
}

TEST(ExportValidity, OfRandomFiles) {
  Exports exports;
  for (std::size_t i = 0; i < files_wanted(); ++i) add_file(exports, "random", random_gltf(i).text());
  EXPECT_EQ(exports.complaints(), "");
}

TEST(ExportValidity, OfChangedFiles) {
  Exports exports;
  const std::size_t mutants = is_long() ? 150 : 20;
  for (const Seed& seed : seeds()) {
    add_file(exports, seed.name, seed.file.text());
    for (std::size_t i = 0; i < mutants; ++i) {
      add_file(exports, seed.name, mutant_of(seed.file, sim::hash(i, seed.name.size())));
    }
  }
  EXPECT_EQ(exports.complaints(), "");
}

TEST(ExportValidity, OfTheFuzzCorpus) {
  Exports exports;
  for (const char* target : {"glb", "gltf"}) {
    const std::filesystem::path corpus = std::filesystem::path(RAYWATT_SOURCE_DIR) / "tests/fuzz/corpus" / target;
    for (const auto& entry : std::filesystem::directory_iterator(corpus)) {
      add_file(exports, entry.path().filename().string(), read_bytes(entry.path()));
    }
  }
  EXPECT_EQ(exports.complaints(), "");
}

TEST(ExportValidity, OfRealScenes) {
  if (!is_long()) GTEST_SKIP() << "RAYWATT_EXPORTS is not set";
  if (!std::filesystem::exists(scenes_folder())) GTEST_SKIP() << "there are no scenes in " << scenes_folder();
  Exports exports;
  for (const auto& entry : std::filesystem::directory_iterator(scenes_folder())) {
    if (entry.path().extension() != ".glb") continue;
    exports.add(entry.path().stem().string(), traces::load_gltf(entry.path()));
  }
  EXPECT_EQ(exports.complaints(), "");
}

}  // namespace
}  // namespace test
