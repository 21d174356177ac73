#include <filesystem>

#include "tests/fuzz/common.h"
#include "tools/studies/sweep/results/collect.h"
#include "tools/studies/sweep/store/store.h"

// Fuzz target: files in a sweep's folder and store. The input is read as each of them: sweep.json, points.jsonl, record
// of a failure, report of a point.

namespace {

namespace fs = std::filesystem;

const std::string kId(64, '0');

void read_folder(const std::string& folder) {
  fuzz::ignore_input_errors([&] {
    const auto sweep = tools::sweep::SweepFolder::open(fuzz::folder() / folder);
    sweep.read_points();
  });
}

void read_failure(std::string_view bytes) {
  const fs::path root = fuzz::folder() / "store";
  const tools::sweep::Store store(root);
  static const bool made = fs::create_directories(store.failure_file(kId).parent_path());
  if (made) fuzz::file_of(bytes, fs::relative(store.failure_file(kId), fuzz::folder()).string());
  fuzz::ignore_input_errors([&] { store.read_failure(kId); });
}

}  // namespace

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed) {
  return fuzz::mutate_json(data, size, most, seed);
}

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes = fuzz::text_of(data, size);
  static const bool made = [] {
    fs::create_directories(fuzz::folder() / "points");
    fuzz::file_of(R"({"schema": "raywatt-sweep-folder/1", "of": "sweep", "store": "s", "points": 1, "slurm": []})",
                  "points/sweep.json");
    return fs::create_directories(fuzz::folder() / "sweep");
  }();
  if (!made) return 0;
  fuzz::file_of(bytes, "sweep/sweep.json");
  read_folder("sweep");
  fuzz::file_of(bytes, "points/points.jsonl");
  read_folder("points");
  read_failure(bytes);
  tools::results::MetricNames names;
  tools::results::ReportScan scan;
  tools::results::scan_report(bytes, names, scan);
  return 0;
}
