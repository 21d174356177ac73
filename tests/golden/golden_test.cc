#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "sim/io/json.h"
#include "tests/param_name.h"
#include "tools/run/frame/run_job.h"

// Compares small runs with all counters stored in tests/golden/*.json, summed over units of a kind. To accept new
// values after an intended change: RAYWATT_ACCEPT=1 ctest --preset release -R golden

namespace tools {
namespace {

using sim::Json;

struct Case {
  const char* name;
  const char* scene;
  const char* program;
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

std::string kind_of(std::string path) {
  std::erase_if(path, [](unsigned char c) { return std::isdigit(c) != 0; });
  return path;
}

Json measure(const Case& c) {
  JobOptions options;
  options.scene = c.scene;
  options.resolution = "64x32";
  options.threads = 1;
  const Inputs inputs = load_inputs(options);
  const FrameResult s = simulate_frame(inputs, kernels::parse_program(c.program), 1);
  Json out = {{"cycles", s.cycles}, {"rays", s.rays()}, {"traversal_steps", s.rendered.traversal_steps}};
  for (const auto& [block, energy] : s.energy.blocks) out["energy_pj"][block] = energy.total().nominal;
  for (const sim::UnitReport& unit : s.units) {
    Json& kind = out["units"][kind_of(unit.path)];
    const auto add = [&](const std::string& group, const std::string& name, std::uint64_t value) {
      Json& sum = kind[group][name];
      sum = (sum.is_null() ? 0 : sum.get<std::uint64_t>()) + value;
    };
    for (const auto& [reason, cycles] : unit.cycles_by_reason) add("why", reason, cycles);
    for (const sim::CounterReport& counter : unit.counters) add("counters", counter.name, counter.value);
  }
  return out;
}

/// Prints the old and new value of every changed number.
std::string difference(const Json& was, const Json& is, const std::string& path = "") {
  if (was.is_object() && is.is_object()) {
    std::string all;
    for (const auto& [key, value] : was.items()) {
      all += is.contains(key) ? difference(value, is[key], path + "/" + key) : path + "/" + key + " is gone\n";
    }
    for (const auto& [key, value] : is.items()) {
      if (!was.contains(key)) all += path + "/" + key + " is new\n";
    }
    return all;
  }
  // Energies interpolated on a curve use the C library's logarithm, which may differ.
  const bool same = was.is_number_float()
                        ? std::abs(was.get<double>() - is.get<double>()) <= 1e-9 * std::abs(was.get<double>())
                        : was == is;
  return same ? "" : path + " was " + sim::json_line(was) + ", is " + sim::json_line(is) + "\n";
}

std::string case_name(const testing::TestParamInfo<Case>& parameter) {
  return ::test::name_of_text(parameter.param.name);
}

class Golden : public testing::TestWithParam<Case> {};

TEST_P(Golden, RunHasNotMovedByACounter) {
  const std::filesystem::path file =
      std::filesystem::path(RAYWATT_SOURCE_DIR) / "tests/golden" / (std::string(GetParam().name) + ".json");
  const Json now = measure(GetParam());
  if (std::getenv("RAYWATT_ACCEPT") != nullptr) std::ofstream(file) << sim::json_lines(now);
  std::ifstream in(file);
  ASSERT_TRUE(in) << file << " is missing; make it with RAYWATT_ACCEPT=1";
  EXPECT_EQ(difference(sim::parse_json(in), now), "");
}

INSTANTIATE_TEST_SUITE_P(Runs, Golden,
                         testing::Values(Case{"cornell-full1", "cornell", "full:1"},
                                         Case{"cornell-full4", "cornell", "full:4"},
                                         Case{"teapot-full1", "teapot", "full:1"},
                                         Case{"teapot-full4", "teapot", "full:4"}),
                         case_name);

}  // namespace
}  // namespace tools
