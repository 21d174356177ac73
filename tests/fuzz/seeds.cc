#include <cstdio>
#include <fstream>
#include <set>

#include <fmt/format.h>

#include "tests/fuzz/seed_report.h"
#include "tests/fuzz/trace_work.h"
#include "tests/temp_folder.h"
#include "tests/tools/run/hand_made_trace.h"
#include "tests/traces/scene/gltf_seeds.h"
#include "traces/scene/images.h"

// Writes seed files and a dictionary for each fuzz target: FOLDER/TARGET/NAME and FOLDER/TARGET.dict.

namespace {

namespace fs = std::filesystem;

class Writer {
 public:
  Writer(const fs::path& folder, const std::string& target) : folder_(folder / target) {
    fs::create_directories(folder_);
  }
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;

  /// Writes the dictionary of a fuzz target, with words for mutations.
  ~Writer() {
    std::ofstream out(folder_.string() + ".dict");
    for (const std::string& word : words_) out << '"' << word << "\"\n";
  }

  void add(const std::string& name, const std::string& bytes) {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    std::string word;
    for (const char c : bytes + " ") {
      if (std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.') {
        word += c;
        continue;
      }
      if (word.size() > 2 && word.size() < 40) words_.insert(word);
      word.clear();
    }
  }

  /// Adds the small files of a folder as seeds.
  void add_files(const fs::path& folder) {
    constexpr std::uintmax_t kMostBytes = 4096;
    for (const fs::directory_entry& file : fs::directory_iterator(folder)) {
      if (!file.is_regular_file() || file.path().extension() != ".yaml" || file.file_size() > kMostBytes) continue;
      add(file.path().filename().string(), test::read_bytes(file.path()));
    }
  }

 private:
  fs::path folder_;
  std::set<std::string> words_;
};

void add_yaml(const fs::path& folder) {
  const fs::path source = RAYWATT_SOURCE_DIR;
  Writer config(folder, "config");
  config.add_files(source / "configs");
  config.add_files(source / "configs" / "dram");
  config.add(
      "small.yaml",
      "extends: sgrt-2016\ncores: 2\ntni: {trv: &trv {rays: 16, l1: {size: 8 KiB}}}\n"
      "energy:\n  events:\n    tni.box_test: {low: 1, nominal: 2, high: 3}\nscene: {lights: {position: [1, 2, 3]}}\n");
  Writer workload(folder, "workload");
  workload.add_files(source / "traces" / "workloads");
  Writer sweep(folder, "sweep");
  sweep.add_files(source / "configs" / "experiments");
  sweep.add("axes.yaml",
            "schema: raywatt-sweep/1\nworkloads: [chess, {scene: teapot, frames: '0:1', name: t}]\n"
            "programs: ['full:1', undersample]\naxes:\n  cores: {from: 1, to: 8, factor: 2}\n"
            "  caches: {keys: [tni.trv.l1.size, tni.trv.rays], values: [[8 KiB, 4], [16 KiB, 8]]}\n"
            "  render.depth: {from: 1, to: 5, step: 2}\n  dram.mhz: {from: 100, to: 200, count: 3, scale: log}\n"
            "exclude:\n  - {cores: 8, render.depth: '> 1'}\nwhere: [{cores: '< 8'}]\n"
            "sets: [tni.trvs=4]\nresolution: 8x8\n");
  sweep.add("subset.yaml",
            "schema: raywatt-sweep/1\naxes: {cores: [1, 2, 4], tni.trvs: [1, 2, 4]}\nsubset: {sobol: 4, seed: 3}\n");
  Writer suite(folder, "suite");
  suite.add_files(source / "tests" / "baseline");
  suite.add("runs.yaml",
            "values: x.yaml\nkeep: {cycles: exact, energy_mj: 0.5 %}\ndefaults: {resolution: 4x4, set: {cores: 1}}\n"
            "runs:\n  a:\n  b: {program: undersample, reference: 'full:4', set: {tni.trvs: 2}}\n");
  suite.add("values.yaml",
            "schema: raywatt-baseline/1\nembree: 3.1\nconfig: {cores: 2}\nruns:\n  a: {program: 'full:1', "
            "scene_sha256: x, bvh_hash: y, config: {cores: 1}, values: {'': {cycles: 7}, totals: {rays: 1e3}}}\n");
}

/// Returns a minimal JPEG file of 8 x 8 pixels: one component, and one code in each table.
std::string jpeg() {
  const std::string codes = std::string("\0\1", 2) + std::string(15, '\0') + '\0';
  std::string ac = codes;
  ac[0] = '\x10';
  return std::string("\xff\xd8\xff\xdb\0\x43\0", 7) + std::string(64, '\1') +
         std::string("\xff\xc0\0\x0b\x08\0\x08\0\x08\1\1\x11\0", 13) + std::string("\xff\xc4\0\x14", 4) +
         codes.substr(0, 18) + std::string("\xff\xc4\0\x14", 4) + ac +
         std::string("\xff\xda\0\x08\1\1\0\0\x3f\0\x3f\xff\xd9", 13);
}

void add_images(const fs::path& folder) {
  Writer image(folder, "image");
  const test::TempFolder made;
  std::vector<std::uint8_t> rgb(8 * 8 * 3);
  std::vector<float> linear(8 * 8 * 3);
  for (std::size_t i = 0; i < rgb.size(); ++i) {
    rgb[i] = static_cast<std::uint8_t>(i * i);
    linear[i] = static_cast<float>(i) / 16;
  }
  traces::write_png(made.path() / "a.png", 8, 8, rgb);
  traces::write_png(made.path() / "b.png", 1, 1, std::span(rgb).first(3));
  traces::write_exr(made.path() / "a.exr", 8, 8, linear);
  for (const char* name : {"a.png", "b.png", "a.exr"}) image.add(name, test::read_bytes(made.path() / name));
  traces::Texture texture;
  texture.width = texture.height = 2;
  texture.texels = {1, 0x80ff00ff, 3, 0};
  image.add("alpha.png", traces::encode_png(texture));
  image.add("gray.jpg", jpeg());
}

void add_scenes(const fs::path& folder) {
  Writer gltf(folder, "gltf"), glb(folder, "glb");
  for (const test::Seed& seed : test::seeds()) {
    gltf.add(seed.name + ".gltf", seed.file.text());
    glb.add(seed.name + ".glb", seed.file.glb());
  }
}

void add_traces(const fs::path& folder) {
  Writer trace(folder, "trace"), work(folder, "trace_work");
  const auto add = [&](const std::string& name, const std::string& walks, bool levels) {
    std::string header, contents;
    const test::Change keep = [&](test::OrderedJson& h, test::OrderedJson& c) {
      header = h.dump();
      contents = c.dump();
    };
    trace.add(name, test::trace(walks, levels, keep));
    std::string parts = header;
    for (const std::string& part :
         {contents, levels ? test::kLevels : test::kTree, test::tile(0, walks), test::tile(1, walks)}) {
      parts.append(fuzz::kBetween).append(part);
    }
    work.add(name, parts);
  };
  add("words", test::kWords, false);
  add("bits", test::bits(), false);
  add("levels", test::bits_of_levels(), true);
}

void add_lists(const fs::path& folder) {
  const std::array<float, 16> rays = {0, 0, 0, 0, 0, 0, 1, 10, 1, 2, 3, 0.5, -1, 0.5, 0, INFINITY};
  Writer(folder, "rays").add("two", {reinterpret_cast<const char*>(rays.data()), sizeof rays});
  Writer(folder, "stream").add("some", "# requests\n0x1f40 R 12.5\n80 W\n\n0XFF R 1e3 # late\n");
}

void add_json(const fs::path& folder) {
  Writer report(folder, "report"), sweep(folder, "sweep_json");
  report.add("report.json", fuzz::seed_report().dump());
  sweep.add("report.json", fuzz::seed_report().dump());
  sweep.add("sweep.json", R"({"schema": "raywatt-sweep-folder/1", "of": "sweep", "store": "s", "slurm": ["-p", "x"]})");
  sweep.add("points.jsonl",
            R"({"n": 0, "id": ")" + std::string(64, 'a') +
                R"(", "axes": {"cores": "1"}, "config": "sgrt-2016", "scene": "cornell", "program": "full:1",)"
                R"( "sets": ["cores=1"], "stream": "k", "image": true, "error": "e"})");
  sweep.add("failure.json", R"({"id": "0", "exit": 2, "error": "e", "log": "l", "host": "h", "attempt": 1})");
}

/// Returns a file of intervals: two frames of two units, with three intervals of 3, 0 and 2 cycles each. One counter is
/// always 0.
void add_intervals(const fs::path& folder) {
  const std::string units = {
      "\x02\x02\x01u\x01\x04"
      "busy\x01\x04hits\0\x01v\0\x01\x04peak\x01",
      27};
  const std::string frame = {"\xe8\x07\xc4\x13\x03\x05\3\0\2\0\x07\x07\0\0", 14};
  std::string all = "raywatt-intervals/1\n" + units;
  for (const char number : {'\0', '\1'}) all.append(fuzz::kBetween).append(1, number).append(frame);
  Writer(folder, "intervals").add("two-frames", all);
}

void add_tiles(const fs::path& folder) {
  Writer(folder, "tiles")
      .add(
          "two.json",
          R"({"schema": "raywatt-tiles/1", "units": {"tile": "", "core": "", "steps": "steps", "energy_mj_low": "mJ"},)"
          R"( "frames": [{"frame": 0, "columns": {"tile": [0, 1], "core": [0, 0], "steps": [3, 4],)"
          R"( "energy_mj_low": [0.5, 0.25]}, "rest": {"energy_mj_low": 0.125}, "totals": {"steps": 7,)"
          R"( "energy_mj_low": 0.875}}]})");
}

void add_slice(const fs::path& folder) {
  Writer(folder, "slice")
      .add("second.json",
           R"({"tiles": {"first": 20, "end": 40, "lead": 20, "warming": 0}, "time": 5, "units": [{"path": "core0",)"
           R"( "elapsed": 5, "why": [3, 2], "counters": [7]}], "kernels": [{"launches": 1, "items": 64, "idle": 0,)"
           R"( "cycles": 4, "starved": 0}], "before": {"time": 1.5, "energy_pj": 0.25}, "after": {"time": 2,)"
           R"( "energy_pj": 0.5}, "function": {"rays": [4, 3, 0, 0], "continued": 0, "traversal_steps": 9, "sampling":)"
           R"( {"wanted": 1, "traced": 1, "background": 0, "traced_background": 0}}, "host": {"slice_s": 0.5,)"
           R"( "timing_s": 0.25, "functional_s": 0.25, "waited_s": 0, "wall_s": 1}})");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    fmt::print(stderr, "usage: fuzz_seeds FOLDER\n");
    return 2;
  }
  const fs::path folder = argv[1];
  add_yaml(folder);
  add_images(folder);
  add_scenes(folder);
  add_traces(folder);
  add_lists(folder);
  add_json(folder);
  add_intervals(folder);
  add_tiles(folder);
  add_slice(folder);
  return 0;
}
