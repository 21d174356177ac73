#include "tools/studies/energy/show.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "hw_models/dram/dram_energy.h"
#include "hw_models/machines/gpu_config.h"
#include "sim/config/quantity.h"
#include "sim/error.h"
#include "sim/io/printable.h"
#include "sim/report/energy_table.h"
#include "tools/pricing/idle_machine.h"
#include "tools/pricing/priced_run.h"
#include "tools/run/frame/load_config.h"
#include "tools/studies/energy/origins.h"
#include "traces/scene/did_you_mean.h"

namespace tools {
namespace {

constexpr std::string_view kEvents = "energy.events.";

/// Where each figure was given, by its full name.
using Origins = std::map<std::string, std::string>;

/// "core0.tni.trv2" -> "core.tni.trv"
std::string kind_of(const std::string& path) {
  std::string out;
  for (std::size_t i = 0; i < path.size(); ++i) {
    std::size_t end = path.find_first_not_of("0123456789", i);
    if (end == std::string::npos) end = path.size();
    const bool is_number = end > i && (end == path.size() || path[end] == '.') && path.compare(0, end, "l2") != 0;
    if (is_number) i = end;
    if (i < path.size()) out += path[i];
  }
  return out;
}

/// Counters by the event that they name, in words.
std::map<std::string, std::set<std::string>> counted_by(const std::vector<sim::UnitReport>& units) {
  std::map<std::string, std::set<std::string>> out;
  for (const sim::UnitReport& unit : units) {
    for (const sim::CounterReport& c : unit.counters) {
      if (!c.event.empty()) out[c.event].insert(fmt::format("{} {}: {}", kind_of(unit.path), c.name, c.meaning));
    }
  }
  return out;
}

/// Entry and what multiplies it.
class Users {
 public:
  explicit Users(const RunConfig& config)
      : config_(config), units_(idle_units(*config.gpu, true)), counters_(counted_by(units_)) {}

  const std::vector<sim::UnitReport>& units() const { return units_; }

  std::set<std::string> of(const EnergyEntry& entry) const {
    if (entry.name.starts_with(kEvents)) return of_event(entry.name.substr(kEvents.size()));
    for (const std::string table : {"energy.logic.", "energy.flops."}) {
      if (entry.name.starts_with(table)) return units_of(entry.name.substr(table.size()));
    }
    for (const std::string table : {"energy.parts.", "energy.parts_in_logic."}) {
      if (entry.name.starts_with(table)) return units_with(entry.name.substr(table.size()));
    }
    if (entry.name.starts_with("dram.")) return of_device(entry.name);
    return {};
  }

 private:
  std::set<std::string> of_event(const std::string& event) const {
    const auto found = counters_.find(event);
    return found == counters_.end() ? std::set<std::string>{} : found->second;
  }
  /// Units that have no entry of their own stand under their block's.
  std::set<std::string> units_of(const std::string& entry) const {
    std::map<std::string, std::size_t> kinds;
    for (const sim::UnitReport& unit : units_) {
      const std::string kind = kind_of(unit.path);
      const std::string own = fmt::format("{}.{}", unit.block, kind.substr(kind.rfind('.') + 1));
      const bool has_own = config_.energy.logic.contains(own);
      if (entry == (has_own ? own : unit.block)) ++kinds[kind];
    }
    std::set<std::string> out;
    for (const auto& [kind, count] : kinds) out.insert(fmt::format("{} units {}", count, kind));
    return out;
  }
  /// Units that hold a part, and how many of it each.
  std::set<std::string> units_with(const std::string& entry) const {
    std::map<std::pair<std::string, std::uint32_t>, std::size_t> kinds;
    for (const sim::UnitReport& unit : units_) {
      for (const sim::UnitPart& part : unit.parts) {
        const bool is_own = entry == fmt::format("{}.{}", sim::entry_name(unit), part.name);
        if (is_own || entry == fmt::format("{}.{}", unit.block, part.name)) ++kinds[{kind_of(unit.path), part.count}];
      }
    }
    std::set<std::string> out;
    for (const auto& [kind, count] : kinds) {
      out.insert(fmt::format("{} units {}, each with {}", count, kind.first, kind.second));
    }
    return out;
  }
  /// Events of the memory that change with a figure.
  std::set<std::string> of_device(const std::string& name) const {
    RunConfig changed = config_;
    for (EnergyEntry& entry : energy_entries(changed)) {
      for (const EnergyEntry::Figure& f : entry.figures) f.value->nominal += entry.name == name ? 1 : 0;
    }
    std::set<std::string> out;
    const auto before = hw::dram_energy_events(config_.gpu->dram), after = hw::dram_energy_events(changed.gpu->dram);
    for (const auto& [event, energy] : after) {
      if (energy.pj.nominal != before.at(event).pj.nominal) out.merge(of_event(event));
    }
    return out;
  }

  const RunConfig& config_;
  std::vector<sim::UnitReport> units_;
  std::map<std::string, std::set<std::string>> counters_;
};

std::string band_text(const sim::Band& s, const std::string& unit) {
  const std::string band =
      s.low == s.high ? fmt::format("{}", s.nominal) : fmt::format("{} / {} / {}", s.low, s.nominal, s.high);
  return (unit.empty() ? band : band + " " + unit) + (s.low == s.high ? "  (no band)" : "");
}

/// Bytes of "cache.l1_read@16KiB"; 0 for what is no point of a curve.
double size_of(const EnergyEntry::Figure& figure) {
  const std::size_t at = figure.name.find('@');
  if (at == std::string::npos) return 0;
  return static_cast<double>(sim::read_quantity(figure.name.substr(at + 1), sim::byte_units()));
}

/// Exponent with which a curve rises from each of its points to the next.
std::string curve_text(const EnergyEntry& entry) {
  std::vector<std::string> steps;
  for (auto a = entry.figures.begin(), b = std::next(a); b != entry.figures.end(); ++a, ++b) {
    const double power = std::log(b->band.nominal / a->band.nominal) / std::log(size_of(*b) / size_of(*a));
    const auto text = [](const EnergyEntry::Figure& f) {
      return sim::quantity_text(static_cast<std::uint64_t>(size_of(f)), sim::byte_units());
    };
    steps.push_back(fmt::format("{:.2f} from {} to {}", power, text(*a), text(*b)));
  }
  return fmt::format("  rises with size to the power {}; beyond the points on as at the nearest\n",
                     fmt::join(steps, ", "));
}

std::string short_name(const std::string& name) {
  return name.starts_with(kEvents) ? name.substr(kEvents.size()) : name;
}

std::string entry_text(const EnergyEntry& entry, const Users& users, const Origins& origins) {
  std::string out = short_name(entry.name) + "\n";
  for (const EnergyEntry::Figure& f : entry.figures) {
    const std::size_t at = f.name.find('@');
    const std::string size = at == std::string::npos ? "" : f.name.substr(at) + ": ";
    const auto origin = origins.find(f.name);
    out += fmt::format("  {}{}\n    {}\n", size, band_text(f.band, entry.unit),
                       sim::printable(origin == origins.end() ? "by default" : origin->second, 2000));
  }
  if (entry.figures.size() > 1) out += curve_text(entry);
  const std::set<std::string> counters = users.of(entry);
  if (counters.empty()) return out + "  " + entry.meaning + "\n";
  for (const std::string& counter : counters) out += "  counted by " + counter + "\n";
  return out;
}

/// Adds what an entry may be called, or a group that it is in: each run of the parts of its name.
void add_names(const EnergyEntry& entry, std::set<std::string>& known) {
  const std::string name = entry.name + ".";
  for (std::size_t begin = 0; begin < name.size(); begin = name.find('.', begin) + 1) {
    for (std::size_t end = name.find('.', begin); end != std::string::npos; end = name.find('.', end + 1)) {
      known.insert(name.substr(begin, end - begin));
    }
  }
}

bool is_meant(const std::string& entry, const std::string& name) {
  const std::string full = "." + entry;
  return name.empty() || full.ends_with("." + name) || full.find("." + name + ".") != std::string::npos;
}

}  // namespace

std::vector<std::string> energy_names(const JobOptions& options) {
  RunConfig config = load_run_config(options);
  std::vector<std::string> names;
  for (const EnergyEntry& entry : energy_entries(config)) names.push_back(short_name(entry.name));
  return names;
}

std::string energy_show(const JobOptions& options, const std::string& name) {
  RunConfig config = load_run_config(options);
  const Origins origins = config_origins(options.config, options.sets);
  const Users users(config);
  check_table_names(users.units(), config);
  std::string out;
  std::set<std::string> known;
  for (EnergyEntry& entry : energy_entries(config)) {
    std::ranges::sort(entry.figures, {}, size_of);
    add_names(entry, known);
    if (!is_meant(entry.name, sim::event_of(name))) continue;
    out += (out.empty() ? "" : "\n") + entry_text(entry, users, origins);
  }
  if (out.empty()) {
    throw sim::InputError(fmt::format("no energy entry is called '{}'{}; see raywatt energy show", sim::printable(name),
                                      traces::did_you_mean(name, std::vector(known.begin(), known.end()))));
  }
  return fmt::format("{}: low / nominal / high\n\n{}", config.energy.process, out);
}

}  // namespace tools
