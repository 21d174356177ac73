#include "tests/tools/studies/sweep/results/made_sweep.h"

#include <fstream>
#include <sstream>

#include <nlohmann/json.hpp>

#include "sim/sha256.h"

namespace test {

namespace fs = std::filesystem;
using OrderedJson = nlohmann::ordered_json;

namespace {

void write_bytes(const fs::path& file, const std::string& bytes) { std::ofstream(file, std::ios::binary) << bytes; }

sim::Json made_of(std::uint64_t n) { return {{"n", n}}; }

OrderedJson core(int loads) { return {{"srp", {{"counters", {{"loads", loads}}}}}}; }

}  // namespace

OrderedJson minimal_report(double cycles) {
  static int made = 0;
  ++made;
  const OrderedJson totals = {{"cycles", cycles},
                              {"time_ms", cycles / 500},
                              {"traversal_steps", cycles},
                              {"limiter", "L2, and \"DRAM\""},
                              {"power_w", {{"low", 0.1}, {"nominal", 0.5}, {"high", 0.9}}},
                              {"perf", {{"fps", 1e6 / cycles}, {"frames_per_joule_gpu", 2e6 / cycles}}},
                              {"top_down", {{"cores", {{{"boxes", 0.25}}, {{"boxes", 0.5}}}}}},
                              {"psnr_db", nullptr},
                              {"identical", true}};
  OrderedJson frame = totals;
  frame["frame"] = 3;
  frame["rays"] = {{"total", 17}};
  return {{"schema", "raywatt-report/1"},
          {"partial", false},
          {"provenance", {{"argv", {"raywatt", std::to_string(made)}}}},
          {"totals", totals},
          {"frames", {frame, frame}},
          {"units", {{"core0", core(7)}, {"core1", core(8)}}},
          {"host", {{"name", "a"}, {"wall_s", made}, {"threads", 2}}}};
}

std::size_t MadeSweep::add(const Axes& axes, const std::string& program) {
  tools::sweep::Point point;
  point.n = points_.size();
  point.id = sim::sha256_hex(sim::json_line(made_of(point.n)));
  point.axes = axes;
  point.program = program;
  points_.push_back(std::move(point));
  return points_.size() - 1;
}

void MadeSweep::add_grid(const std::string& a, const std::vector<std::string>& values_of_a, const std::string& b,
                         const std::vector<std::string>& values_of_b,
                         const std::function<double(std::size_t, std::size_t)>& cycles) {
  for (std::size_t i = 0; i < values_of_a.size(); ++i) {
    for (std::size_t k = 0; k < values_of_b.size(); ++k) {
      finish(add({{a, values_of_a[i]}, {b, values_of_b[k]}}), cycles(i, k));
    }
  }
}

void MadeSweep::finish(std::size_t n, const std::string& report) const {
  remove(n);
  store().put_result(id(n), made_of(n), [&](const fs::path& folder) {
    write_bytes(folder / "config.yaml", "cores: 4\n");
    write_bytes(folder / "report.json", report);
  });
}

void MadeSweep::finish(std::size_t n, const OrderedJson& report) const { finish(n, report.dump(2) + "\n"); }

void MadeSweep::finish(std::size_t n, double cycles) const { finish(n, minimal_report(cycles)); }

void MadeSweep::fail(std::size_t n, const std::string& error) const {
  store().put_failure({id(n), 3, error, "one\ntwo", "a", 2});
}

void MadeSweep::damage(std::size_t n, const std::string& report) const {
  write_bytes(point(n) / "report.json", report);
}

void MadeSweep::remove(std::size_t n) const { fs::remove_all(point(n)); }

tools::sweep::SweepFolder MadeSweep::write() const {
  return tools::sweep::SweepFolder::create(folder(), tools::sweep::SweepFolder::FolderKind::kSweep, "", points_,
                                           store().root(), {});
}

tools::results::Collected MadeSweep::collect() const { return tools::results::collect_results(write()); }

tools::results::Results MadeSweep::results() const {
  collect();
  return tools::results::Results(folder());
}

std::vector<std::vector<std::string>> cells_of(const std::string& csv) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream lines(csv);
  for (std::string line; std::getline(lines, line);) {
    rows.emplace_back();
    std::istringstream cells(line + ",");
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(cell);
  }
  return rows;
}

}  // namespace test
