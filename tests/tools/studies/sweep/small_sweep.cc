#include "tests/tools/studies/sweep/small_sweep.h"

#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "sim/error.h"

namespace test {

namespace fs = std::filesystem;

fs::path write_sweep(const TempFolder& folder, const std::string& lines, const std::string& name) {
  const bool has_sizes = lines.starts_with("resolution:") || lines.find("\nresolution:") != std::string::npos ||
                         lines.find("resolution: [") != std::string::npos;
  return folder.write(
      name, "schema: raywatt-sweep/1\n" + std::string(has_sizes ? "image: no\n" : "resolution: 16x16\n") + lines);
}

std::vector<tools::sweep::Point> points_of(const std::string& lines) {
  const TempFolder folder;
  return tools::sweep::plan_points(tools::sweep::read_spec(write_sweep(folder, lines)), folder.path());
}

std::string complaint_of(const std::string& lines) {
  const TempFolder folder;
  const fs::path file = write_sweep(folder, lines);
  try {
    tools::sweep::plan_points(tools::sweep::read_spec(file), folder.path());
  } catch (const sim::InputError& error) {
    std::string text = error.what();
    const std::size_t name = text.find(file.string());
    return name == 0 ? text.substr(file.string().size() - file.filename().string().size()) : text;
  }
  return {};
}

Words sweep_run(const TempFolder& folder, const fs::path& file, const Words& more) {
  Words words = {"sweep",
                 "run",
                 file.string(),
                 "-o",
                 (folder.path() / "out").string(),
                 "--store",
                 (folder.path() / "store").string()};
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

void sweep_twice_at_once(const TempFolder& folder, const fs::path& file) {
  Words second = sweep_run(folder, file, {"-j", "2"});
  second[4] = (folder.path() / "second").string();
  Program a(sweep_run(folder, file, {"-j", "2"})), b(second);
  const ProcessResult end_a = a.wait(), end_b = b.wait();
  EXPECT_EQ(end_a.exit, 0) << end_a.err;
  EXPECT_EQ(end_b.exit, 0) << end_b.err;
}

Words axis_labels(const std::vector<tools::sweep::Point>& points) {
  Words labels;
  for (const tools::sweep::Point& point : points) {
    std::string label;
    for (const auto& [name, value] : point.axes) label += (label.empty() ? "" : " ") + name + "=" + value;
    labels.push_back(std::move(label));
  }
  return labels;
}

std::size_t points_in(const fs::path& store) {
  std::size_t count = 0;
  std::error_code missing;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(store / "points", missing)) {
    count += entry.path().filename() == "point.json" ? 1 : 0;
  }
  return count;
}

nlohmann::json comparable(nlohmann::json report) {
  report.erase("host");
  report["provenance"].erase("argv");
  return report;
}

Tally last_run_counts(const fs::path& out) {
  std::istringstream runs(read_bytes(out / "log" / "runs.jsonl"));
  std::string last;
  for (std::string line; std::getline(runs, line);) last = line;
  const auto run = nlohmann::json::parse(last);
  return {run["points"], run["computed"], run["found"], run["failed"]};
}

}  // namespace test
