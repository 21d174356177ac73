#include "tools/pricing/priced_run.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "hw_models/dram/dram_energy.h"
#include "hw_models/machines/gpu_config.h"
#include "sim/config/config.h"
#include "sim/config/config_tree.h"
#include "sim/config/load.h"
#include "sim/config/yaml_tree.h"
#include "sim/error.h"
#include "sim/hash.h"
#include "sim/io/file.h"
#include "sim/io/printable.h"
#include "sim/report/energy.h"
#include "sim/report/table.h"
#include "tools/analysis/report_file.h"
#include "tools/host/paths.h"
#include "tools/pricing/reported_units.h"
#include "tools/run/frame/frame_rate.h"
#include "tools/run/frame/load_config.h"
#include "tools/run/frame/machine_run.h"
#include "tools/run/frame/power.h"

namespace tools {
namespace {

std::uint64_t hash_of(const std::string& name) {
  std::uint64_t h = 0;
  for (const char c : name) h = sim::hash(h, static_cast<unsigned char>(c));
  return h;
}

void add_figure(std::vector<EnergyEntry>& entries, const sim::ConfigNode& node, const std::string& key,
                sim::Band& figure) {
  const std::string name = key.empty() ? node.path : node.path + "." + key;
  const std::string entry = sim::event_name_of(name);
  if (entries.empty() || entries.back().name != entry) {
    entries.push_back({entry, node.unit, node.meaning, hash_of(entry), {}});
  }
  entries.back().figures.push_back({name, &figure, figure});
}

void collect_entries(const sim::ConfigNode& group, std::vector<EnergyEntry>& entries) {
  for (const sim::ConfigNode& node : group.children) {
    // Area tables and power settings contain no energies.
    if (node.path == "area" || node.path == "power") continue;
    if (node.is_group()) {
      collect_entries(node, entries);
    } else if (node.affects != sim::Affects::kEnergy) {
      continue;
    } else if (auto* const figure = std::get_if<sim::Band*>(&*node.target)) {
      add_figure(entries, node, "", **figure);
    } else if (auto* const map = std::get_if<std::map<std::string, sim::Band>*>(&*node.target)) {
      for (auto& [key, spread] : **map) add_figure(entries, node, key, spread);
    }
  }
}

}  // namespace

bool EnergyEntry::has_band() const {
  return std::ranges::any_of(figures, [](const Figure& f) { return f.band.low != f.band.high; });
}

void EnergyEntry::set_quantile(double quantile) {
  for (const Figure& f : figures) f.value->nominal = value_at_quantile(f.band, quantile);
}

void EnergyEntry::restore_nominal() {
  for (const Figure& f : figures) *f.value = f.band;
}

std::vector<EnergyEntry> energy_entries(RunConfig& config) {
  std::vector<EnergyEntry> entries;
  collect_entries(sim::config_tree(config), entries);
  return entries;
}

double value_at_quantile(const sim::Band& band, double quantile) {
  const bool lower = quantile < 0.5;
  const double from = lower ? band.low : band.nominal, to = lower ? band.nominal : band.high;
  const double part = lower ? 2 * quantile : 2 * quantile - 1;
  return from > 0 ? from * std::pow(to / from, part) : from + (to - from) * part;
}

double EnergyDraw::quantile_of(const EnergyEntry& entry) const {
  return sim::hash_to_unit_float(sim::hash(seed, number, entry.hash));
}

namespace {

constexpr std::uint64_t kMostTableBytes = 4 << 20;
/// Relative tolerance between reported and recomputed energy, because their sums are rounded differently.
constexpr double kSumRounding = 1e-9;

/// Throws InputError unless the file given with --energy is an energy table: its top-level keys are those of the group
/// `energy`.
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
    if (entry.key == "extends" || tree.find_child("energy")->find_child(entry.key) != nullptr) continue;
    if (tree.find_child(entry.key) != nullptr) refuse("a whole configuration");
    if (tree.find_child("dram")->find_child(entry.key) != nullptr) refuse("a memory grade");
    if (tree.find_child("area")->find_child(entry.key) != nullptr) refuse("an area table");
  }
}

/// Returns the file of an energy table that is given as "energy/14nm", "14nm" or a path.
std::filesystem::path table_file(const std::string& name) {
  const std::vector<std::string> known = config_names_in("energy");
  const bool is_bare = std::ranges::find(known, "energy/" + name) != known.end();
  return sim::find_config(is_bare ? "energy/" + name : name, {}, "--energy", "energy");
}

/// Applies an energy table and single energy keys to `config`. Throws InputError for keys that change more than energy.
void apply_table(const PriceTable& table, RunConfig& config) {
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
  for (const std::string& set : table.sets) {
    if (!set.starts_with("process=")) continue;
    throw sim::InputError(
        fmt::format("--set {0}: sets tables of area and latency too, so it needs another run; allowed: "
                    "--energy energy/{1} --set power.extends=power/{1}",
                    sim::printable(set), sim::printable(set.substr(set.find('=') + 1))));
  }
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

WorkDone work_done_of(const ReportFile& report) {
  const auto frames = report.json.find("frames");
  const bool listed = frames != report.json.end() && frames->is_array() && !frames->empty();
  return {report.number("totals.time_ms"), report.number("totals.rays.total"),
          listed ? static_cast<double>(frames->size()) : 1};
}

}  // namespace

PricedRun::PricedRun(const ReportFile& report, const PriceTable& table)
    : config_(reported_config(report)), work_(work_done_of(report)) {
  const double cycles = report.number("totals.cycles");
  if (!(cycles >= 0 && cycles < 0x1p53)) ReportedCounts(report).refuse("totals.cycles is no count");
  elapsed_ = static_cast<sim::Time>(cycles) * config_.gpu->clocks.tni.clock().period();
  const ReportedCounts counts(report);
  std::vector<sim::UnitReport> units = idle_unit_reports(*config_.gpu, counts.optional_units(), config_.bvh);
  counts.fill(units);
  build_energy_formula(units);
  const double own = total(&sim::Band::nominal) / sim::kPicojoulesPerMillijoule;
  const double stated = report.number("totals.energy_mj.nominal");
  if (!(std::abs(own - stated) <= kSumRounding * stated)) {
    ReportedCounts(report).refuse(
        fmt::format("by its own table its counts come to {:.6g} mJ, and it states {:.6g}", own, stated));
  }
  if (!table.is_own_table()) {
    apply_table(table, config_);
    units = idle_unit_reports(*config_.gpu, counts.optional_units(), config_.bvh);
    counts.fill(units);
    build_energy_formula(units);
  }
  for (EnergyEntry& entry : energy_entries(config_)) {
    if (entry.has_band()) entries_.push_back(std::move(entry));
  }
}

void PricedRun::build_energy_formula(const std::vector<sim::UnitReport>& units) {
  device_ = hw::dram_energy_events(config_.gpu->dram);
  check_table_names(units, config_);
  extrapolated_ = sim::curve_range_warnings(units, config_.energy.events, {});
  std::ranges::move(power_warnings(config_), std::back_inserter(extrapolated_));
  RunConfig priced = config_;
  priced.area.arrays.clear();  // no warning about the process of the area table, which does not affect energy
  std::ranges::move(process_warnings(priced), std::back_inserter(extrapolated_));
  formula_ = std::make_unique<sim::EnergyFormula>(units, config_.energy, device_, elapsed_, power_scales(config_));
  idle_ = std::make_unique<sim::EnergyFormula>(idle_millisecond_reports(units), config_.energy, device_,
                                               sim::kFemtosecondsPerSecond / 1000, power_scales(config_));
}

double PricedRun::period_energy_pj(sim::BandMember side) const {
  const std::vector<double> kinds = idle_->kind_energies(side);  // in order: dynamic, clock, leakage
  const double chip_pj_per_ms = remaining_between_frames(config_.power, kinds[2], kinds[1]);
  constexpr double kPicojoulesPerMicrojoule = 1e6;  // mW x ms = uJ
  const double memory_pj_per_ms = hw::dram_idle_power_mw(config_.gpu->dram).*side * kPicojoulesPerMicrojoule;
  const double rest_ms = std::max(0.0, 1000 / config_.frame.fps - work_.time_ms / work_.frames);
  return total(side) / work_.frames + (chip_pj_per_ms + memory_pj_per_ms) * rest_ms;
}

void PricedRun::update_formula() {
  for (const auto& [name, event] : hw::dram_energy_events(config_.gpu->dram)) device_.at(name) = event;
}

void PricedRun::apply_draw(const EnergyDraw& draw) {
  for (EnergyEntry& entry : entries_) entry.set_quantile(draw.quantile_of(entry));
  update_formula();
}

void PricedRun::restore_nominal() {
  for (EnergyEntry& entry : entries_) entry.restore_nominal();
  update_formula();
}

double PricedRun::block_energy_pj(const std::string& block, sim::BandMember side) const {
  const std::vector<std::string>& names = formula_->block_names();
  const auto found = std::ranges::find(names, block);
  if (found == names.end()) throw sim::InputError(fmt::format("no energy block is called '{}'", block));
  return formula_->block_energies(side)[static_cast<std::size_t>(found - names.begin())];
}

namespace {

/// Removes a number or a group from a report's totals.
void remove_total(ReportFile& report, const std::string& name) {
  const std::size_t dot = name.rfind('.');
  std::string group = dot == std::string::npos ? "" : "/" + name.substr(0, dot);
  std::ranges::replace(group, '.', '/');
  const sim::JsonPointer at("/totals" + group);
  if (report.json.contains(at)) report.json[at].erase(name.substr(dot + 1));
  const std::string path = "totals." + name;
  std::erase_if(report.numbers,
                [&](const auto& number) { return number.first == path || number.first.starts_with(path + "."); });
}

}  // namespace

FrameRate evaluate_report_rate(const ReportFile& report, double fps) {
  const PricedRun run(report);
  RunConfig config = run.config();
  config.frame.fps = fps;
  const sim::EnergyReport energy = run.energy();
  const std::vector<sim::UnitReport> units =
      idle_unit_reports(*config.gpu, ReportedCounts(report).optional_units(), config.bvh);
  const double mean_ms = run.work().time_ms / run.work().frames;
  double slowest_ms = 0;
  for (int i = 0; i < static_cast<int>(run.work().frames); ++i) {
    slowest_ms = std::max(slowest_ms, report.number(fmt::format("frames[{}].time_ms", i)));
  }
  return evaluate_frame_rate(config, {.energy = energy,
                                      .units = units,
                                      .count = run.work().frames,
                                      .time_ms = run.work().time_ms,
                                      .slowest_ms = slowest_ms > 0 ? slowest_ms : mean_ms});
}

void set_frame_rate(ReportFile& report, double fps) {
  sim::Json rated = frame_rate_json(evaluate_report_rate(report, fps));
  for (ReportNumber& number : report_numbers({{"totals", rated}}))
    report.numbers[std::move(number.path)] = number.value;
  std::vector<std::string> stale = {"replicates.figures.fps_margin", "replicates.figures.power_at_fps_w"};
  if (report.number("config.frame.fps") != fps) {
    for (const char* metric : {"sustained_fps", "stability", "sustained"}) {
      stale.push_back(metric);
      stale.push_back(fmt::format("replicates.figures.{}", metric));
    }
  }
  for (const std::string& metric : stale) remove_total(report, metric);
  report.json["totals"].update(rated);
}

}  // namespace tools
