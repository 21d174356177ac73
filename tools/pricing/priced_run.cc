#include "tools/pricing/priced_run.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "hw_models/dram/dram_energy.h"
#include "sim/config/config.h"
#include "sim/config/load.h"
#include "sim/config/yaml_tree.h"
#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/printable.h"
#include "tools/host/paths.h"
#include "tools/pricing/idle_machine.h"
#include "tools/simulation/energy_events.h"
#include "tools/simulation/power.h"

namespace tools {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint64_t kMostTableBytes = 4 << 20;
constexpr double kRounding = 1e-9;  ///< sums of frames are rounded otherwise than sums of counts

std::string name_of(const ReportFile& report) { return sim::printable(report.file.string()); }

/// A whole file has keys of energy alone; a configuration, or a table of something else, is told from it by its keys.
void check_kind(const std::filesystem::path& file) {
  const auto mapping = sim::parse_yaml_mapping(sim::read_file(file, kMostTableBytes), sim::printable(file.string()));
  const auto refuse = [&](const std::string& what) {
    throw sim::InputError(fmt::format("--energy {}: is {}, not an energy table; allowed: {}, or a file with such keys",
                                      sim::printable(file.string()), what, fmt::join(config_names_in("energy"), ", ")));
  };
  if (const sim::YamlNode::Entry* schema = mapping->find("schema")) {
    refuse(fmt::format("a file of schema '{}'", sim::printable(schema->value->scalar)));
  }
  RunConfig all;
  const sim::ConfigNode tree = sim::config_tree(all);
  for (const sim::YamlNode::Entry& entry : mapping->entries) {
    if (entry.key == "extends" || tree.child("energy")->child(entry.key) != nullptr) continue;
    if (tree.child(entry.key) != nullptr) refuse("a whole configuration");
    if (tree.child("dram")->child(entry.key) != nullptr) refuse("a memory grade");
    if (tree.child("area")->child(entry.key) != nullptr) refuse("an area table");
  }
}

/// The table's file: "energy/14nm", "14nm" or a path.
std::filesystem::path table_file(const std::string& name) {
  const std::vector<std::string> known = config_names_in("energy");
  const bool is_bare = std::ranges::find(known, "energy/" + name) != known.end();
  return sim::find_config(is_bare ? "energy/" + name : name, {}, "--energy", "energy");
}

/// Applies another table; keys that do more than price are refused.
void apply(const PriceTable& table, RunConfig& config) {
  sim::set_config_search_path(config_folders());
  const auto before = sim::list_fields(config);
  std::filesystem::path file;
  if (!table.energy.empty()) {
    file = std::filesystem::absolute(table_file(table.energy));
    check_kind(file);
    config.energy = {};
  }
  sim::ConfigNode tree = sim::config_tree(config);
  sim::ConfigLoader loader(tree);
  if (!table.energy.empty()) loader.apply_set("energy.extends=" + file.string());
  for (const std::string& set : table.sets) loader.apply_set(set);
  check_run_config(config, table.energy.empty() ? "--set" : table.energy);
  const auto after = sim::list_fields(config);
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (before[i].value == after[i].value) continue;
    if (before[i].path.starts_with("area.")) {
      throw sim::InputError(before[i].path + ": changes the machine's area, not its energy; give it to a run");
    }
    if (before[i].affects == sim::Affects::kEnergy) continue;
    throw sim::InputError(
        fmt::format("{}: changes what the machine does, so it needs another run; allowed: keys that affect energy "
                    "alone, such as energy.events.tni.box_test, dram.energy.phy",
                    before[i].path));
  }
}

/// Node of a unit in a report's tree, "core0.tni.trv2"; null if there is none.
const Json* node_of(const Json& units, std::string_view path) {
  const std::size_t dot = path.find('.');
  const auto found = units.find(std::string(path.substr(0, dot)));
  if (found == units.end() || !found->is_object()) return nullptr;
  return dot == std::string_view::npos ? &*found : node_of(*found, path.substr(dot + 1));
}

std::size_t units_below(const Json& node, int depth = 0) {
  constexpr int kDeepest = 32;
  if (!node.is_object() || depth > kDeepest) return 0;
  std::size_t count = node.contains("counters") ? 1 : 0;
  for (const auto& [name, child] : node.items()) {
    if (name != "counters" && name != "why") count += units_below(child, depth + 1);
  }
  return count;
}

/// Puts a report's counts into the units of a machine at rest.
class Counts {
 public:
  explicit Counts(const ReportFile& report) : report_(report) {
    const auto units = report.json.find("units");
    if (units == report.json.end()) refuse("it has no units");
    units_ = &*units;
  }

  void fill(std::vector<sim::UnitReport>& units) const {
    if (const std::size_t found = units_below(*units_); found != units.size()) {
      refuse(fmt::format("it has {} units, the machine of its configuration {}", found, units.size()));
    }
    for (sim::UnitReport& unit : units) {
      const Json* node = node_of(*units_, unit.path);
      if (node == nullptr) refuse(fmt::format("unit {} is not there", unit.path));
      for (auto& [reason, cycles] : unit.why) cycles = number(*node, "why", reason, unit);
      for (sim::CounterReport& counter : unit.counters) counter.value = number(*node, "counters", counter.name, unit);
    }
  }
  [[noreturn]] void refuse(const std::string& why) const {
    throw sim::InputError(
        fmt::format("{}: cannot be priced: {}; allowed: reports of this version's model", name_of(report_), why));
  }

 private:
  std::uint64_t number(const Json& node, const char* group, const std::string& name,
                       const sim::UnitReport& unit) const {
    const auto in = node.find(group);
    if (in != node.end() && in->is_object()) {
      const auto value = in->find(name);
      if (value != in->end() && value->is_number_unsigned()) return value->get<std::uint64_t>();
    }
    refuse(fmt::format("units.{}.{}.{} is no count", unit.path, group, name));
  }

  const ReportFile& report_;
  const Json* units_ = nullptr;
};

WorkDone work_of(const ReportFile& report) {
  const auto frames = report.json.find("frames");
  const bool listed = frames != report.json.end() && frames->is_array() && !frames->empty();
  return {report.number("totals.time_ms"), report.number("totals.rays.total"),
          listed ? static_cast<double>(frames->size()) : 1};
}

}  // namespace

RunConfig config_of(const ReportFile& report) {
  const auto json = report.json.find("config");
  if (json == report.json.end() || !json->is_object()) {
    throw sim::InputError(fmt::format("{}: has no config, so nobody knows which machine it was", name_of(report)));
  }
  RunConfig config;
  sim::ConfigNode tree = sim::config_tree(config);
  sim::ConfigLoader(tree).apply_text(json->dump(), name_of(report) + ": config");
  check_run_config(config, name_of(report));
  return config;
}

PricedRun::PricedRun(const ReportFile& report, const PriceTable& table)
    : config_(config_of(report)), work_(work_of(report)) {
  const double cycles = report.number("totals.cycles");
  if (!(cycles >= 0 && cycles < 0x1p53)) Counts(report).refuse("totals.cycles is no count");
  elapsed_ = static_cast<sim::Time>(cycles) * config_.gpu.clocks.tni.clock().period();
  std::vector<sim::UnitReport> units = idle_units(config_.gpu);
  Counts(report).fill(units);
  make_formula(units);
  const double own = total(&sim::Spread::nominal) / kPicojoulesPerMillijoule;
  const double stated = report.number("totals.energy_mj.nominal");
  if (!(std::abs(own - stated) <= kRounding * stated)) {
    Counts(report).refuse(
        fmt::format("by its own table its counts come to {:.6g} mJ, and it states {:.6g}", own, stated));
  }
  if (!table.is_own()) {
    apply(table, config_);
    units = idle_units(config_.gpu);
    Counts(report).fill(units);
    make_formula(units);
  }
  for (EnergyEntry& entry : energy_entries(config_)) {
    if (entry.has_band()) entries_.push_back(std::move(entry));
  }
}

void PricedRun::make_formula(const std::vector<sim::UnitReport>& units) {
  device_ = hw::dram_energy_events(config_.gpu.dram);
  check_energy_events(units, config_.energy);
  formula_ = std::make_unique<sim::EnergyFormula>(units, config_.energy, device_, elapsed_, power_scales(config_));
}

void PricedRun::refresh() {
  for (const auto& [name, event] : hw::dram_energy_events(config_.gpu.dram)) device_.at(name) = event;
}

void PricedRun::draw(const EnergyDraw& draw) {
  for (EnergyEntry& entry : entries_) entry.set_quantile(draw.quantile(entry));
  refresh();
}

void PricedRun::restore() {
  for (EnergyEntry& entry : entries_) entry.restore();
  refresh();
}

double PricedRun::of_block(const std::string& block, sim::Side side) const {
  const std::vector<std::string>& names = formula_->blocks();
  const auto found = std::ranges::find(names, block);
  if (found == names.end()) throw sim::InputError(fmt::format("no energy block is called '{}'", block));
  return formula_->of_blocks(side)[static_cast<std::size_t>(found - names.begin())];
}

}  // namespace tools
