#include "tools/studies/microbench/benchmark.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include <fmt/format.h>

#include "hw_models/machines/gpu_config.h"
#include "sim/error.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "sim/report/table.h"
#include "sim/time.h"
#include "tools/host/paths.h"

namespace tools {
namespace {

constexpr double kTolerance = 0.02;

/// The name of a relation between a measured and an expected value, and the function that tests it.
struct RelationRule {
  const char* words;
  bool (*holds)(double measured, double expected);
};
/// Name and test of each relation, indexed by Measurement::Relation.
constexpr std::array<RelationRule, 5> kRules = {{
    {"exactly", [](double m, double e) { return std::abs(m - e) <= 1e-9 * std::abs(e); }},
    {"within 2 %", [](double m, double e) { return std::abs(m - e) <= kTolerance * e; }},
    {"nine tenths or more", [](double m, double e) { return m >= 0.9 * e && m <= e; }},
    {"an upper bound", [](double m, double e) { return m <= (1 + kTolerance) * e; }},
    {"a lower bound", [](double m, double e) { return m >= e; }},
}};
const RelationRule& rule_of(const Measurement& m) { return kRules.at(static_cast<std::size_t>(m.holds)); }

std::string measurement_table(const Findings& findings) {
  sim::Table table({findings.title, "measured", "closed form", "", "difference", "holds", "", ""});
  for (const Measurement& f : findings.measurements) {
    table.add_row({f.name, fmt::format("{:.3f}", f.measured), fmt::format("{:.3f}", f.expected), f.unit,
                   fmt::format("{:+.2f} %", 100 * f.relative_error()), rule_of(f).words, f.remark,
                   f.is_good() ? "" : "MISSED"});
  }
  return table.text();
}

}  // namespace

bool Measurement::is_good() const { return rule_of(*this).holds(measured, expected); }

double Measurement::relative_error() const { return measured == expected ? 0 : measured / expected - 1; }

bool Findings::is_good() const {
  return std::ranges::all_of(measurements, [](const Measurement& f) { return f.is_good(); });
}

UpperBound tightest_bound(const std::vector<UpperBound>& bounds) {
  constexpr double kClear = 1.5;
  UpperBound tightest = *std::ranges::min_element(bounds, {}, &UpperBound::value);
  for (const UpperBound& bound : bounds) tightest.reached &= bound.reached || bound.value > kClear * tightest.value;
  return tightest;
}

std::string findings_table(const Findings& findings) {
  std::string text = findings.table.empty() ? measurement_table(findings) : findings.table;
  for (const std::string& note : findings.notes) text += "\n" + note + "\n";
  return text;
}

std::string findings_json(std::string_view benchmark, const Findings& findings) {
  sim::Json measurements = sim::Json::array();
  for (const Measurement& f : findings.measurements) {
    measurements.push_back({{"name", f.name},
                            {"unit", f.unit},
                            {"measured", f.measured},
                            {"expected", f.expected},
                            {"relative_error", f.relative_error()},
                            {"holds", rule_of(f).words},
                            {"remark", f.remark},
                            {"good", f.is_good()}});
  }
  return sim::json_lines({{"schema", "raywatt-microbench/1"},
                          {"benchmark", benchmark},
                          {"title", findings.title},
                          {"figures", measurements},
                          {"notes", findings.notes},
                          {"good", findings.is_good()}});
}

BenchmarkOption json_option() { return {"--json", "print JSON", &BenchmarkJob::json}; }

RunConfig non_ideal_machine(const JobOptions& job) {
  RunConfig config = load_run_config(job);
  config.gpu->ideal = {};
  return config;
}

std::vector<JobOptions> jobs_with_all_dram_grades(const JobOptions& job) {
  for (const std::string& set : job.sets) {
    if (!set.starts_with("dram.extends=")) continue;
    throw sim::InputError(
        fmt::format("--all-grades and --set {} exclude each other; allowed: one of them", sim::printable(set)));
  }
  std::vector<JobOptions> jobs;
  for (const std::string& grade : config_names_in("dram")) {
    JobOptions of_grade = job;
    of_grade.sets.insert(of_grade.sets.begin(), "dram.extends=" + grade);
    jobs.push_back(std::move(of_grade));
  }
  return jobs;
}

double steady_rate(std::vector<std::uint64_t> moments) {
  std::ranges::sort(moments);
  const std::size_t first = moments.size() / 10, last = moments.size() - 1 - first;
  return static_cast<double>(last - first) / static_cast<double>(moments[last] - moments[first]) *
         static_cast<double>(sim::kFemtosecondsPerSecond);
}

}  // namespace tools
