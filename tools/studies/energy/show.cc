#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "hw_models/dram/dram_energy.h"
#include "hw_models/machines/gpu_config.h"
#include "sim/config/load.h"
#include "sim/config/quantity.h"
#include "sim/config/scale.h"
#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/printable.h"
#include "sim/report/energy.h"
#include "tools/host/paths.h"
#include "tools/pricing/priced_run.h"
#include "tools/run/frame/load_config.h"
#include "tools/run/frame/machine_run.h"
#include "tools/studies/energy/energy.h"
#include "traces/scene/did_you_mean.h"

namespace tools {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kLargestConfig = 4 << 20;
constexpr std::string_view kEvents = "energy.events.";

/// Origin (file and line, or option) of each configuration value, by its full key.
using Origins = std::map<std::string, std::string>;

/// Returns the comment at line `line` of a YAML text, without the word "source:" at its start.
std::string comment_of(const std::string& text, int line) {
  std::size_t begin = 0;
  for (int i = 1; i < line; ++i) begin = text.find('\n', begin) + 1;
  const std::string whole = text.substr(begin, text.find('\n', begin) - begin);
  const std::size_t comment = whole.find("# ");
  if (comment == std::string::npos) return "no comment";
  const std::string comment_text = whole.substr(comment + 2);
  return comment_text.starts_with("source: ") ? comment_text.substr(8) : comment_text;
}

/// Returns the text after the last dot of a path.
std::string last_part(const std::string& path) { return path.substr(path.rfind('.') + 1); }

/// Collects for each configuration value the file or option that sets it. Later ones override earlier ones.
class Layers {
 public:
  Layers(Origins& out, const std::vector<std::string>& sets) : out_(out) {
    for (const std::string& set : sets) {
      if (set.starts_with("process=")) process_ = set.substr(set.find('=') + 1);
    }
  }

  void add_file(const std::string& prefix, const fs::path& path) {
    const std::string text = sim::read_file(path, kLargestConfig);
    add_mapping(prefix, *sim::parse_yaml_mapping(text, path.string()), path.parent_path(),
                [&](int line) { return fmt::format("{}  ({}:{})", comment_of(text, line), path.string(), line); });
  }

  /// Adds an option --set, "KEY=VALUE". A value in braces sets several keys.
  void add_set(const std::string& text) {
    const std::size_t equals = text.find('=');
    const std::string value = text.substr(equals + 1), origin = "--set " + text;
    std::string key = text.substr(0, equals);
    if (key == "process") add_process({});
    for (const std::string end : {".nominal", ".extends"}) {
      if (key.ends_with(end)) key.resize(key.size() - end.size());
      if (text.substr(0, equals) == key + ".extends") add_file(key, sim::find_config(value, {}, text, last_part(key)));
    }
    if (value.starts_with('{')) {
      add_mapping(key, *sim::parse_yaml_mapping(value, origin), {}, [&](int) { return origin; });
    }
    out_[key] = origin;
  }

 private:
  /// Adds all values of a YAML mapping. `origin`: returns the origin of a value from its line number.
  void add_mapping(const std::string& prefix, const sim::YamlNode& node, const fs::path& folder,
                   const std::function<std::string(int)>& origin) {
    const auto* process = prefix.empty() ? node.find("process") : nullptr;
    if (process != nullptr && process_.empty()) process_ = process->value->scalar;
    if (const auto* base = node.find("extends"))
      add_file(prefix, sim::find_config(base->value->scalar, folder, "extends", last_part(prefix)));
    if (const auto* factors = node.find("scale")) add_scale(prefix, *factors->value, origin);
    if (process != nullptr) add_process(folder);
    for (const sim::YamlNode::Entry& entry : node.entries) {
      if (entry.key == "scale") continue;
      const std::string key = prefix.empty() ? entry.key : prefix + "." + entry.key;
      out_[key] = origin(entry.key_at.line);
      if (entry.value->kind == sim::YamlNode::Kind::kMapping) add_mapping(key, *entry.value, folder, origin);
    }
  }

  /// Adds the tables of the semiconductor process, once. If several files set `process`, the outermost file counts.
  void add_process(const fs::path& folder) {
    if (is_process_added_) return;
    is_process_added_ = true;
    for (const char* table : {"energy", "area", "power", "latency"}) {
      add_file(table, sim::find_config(fs::path(table) / process_, folder, "process", table));
    }
  }

  /// Appends to the origin of each value below `prefix` the factor by which a key `scale` multiplies the value.
  void add_scale(const std::string& prefix, const sim::YamlNode& factors,
                 const std::function<std::string(int)>& origin) {
    sim::BandScale keys;
    std::map<std::string, std::string> texts;
    for (const sim::YamlNode::Entry& entry : factors.entries) {
      keys.add(entry.key, {});
      const sim::YamlNode::Entry* nominal = entry.value->find("nominal");
      const std::string factor = nominal == nullptr ? entry.value->scalar : nominal->value->scalar;
      texts[entry.key] = fmt::format("\n    x {}: {}", factor, origin(entry.key_at.line));
    }
    for (auto& [path, text] : out_) {
      if (!path.starts_with(prefix + ".")) continue;
      const std::string key = keys.covering_key(std::string_view(path).substr(prefix.size() + 1));
      if (!key.empty()) text += texts.at(key);
    }
  }

  Origins& out_;
  std::string process_;  ///< name in the outermost `process` setting
  bool is_process_added_ = false;
};

/// Returns the origin of each value of a configuration: the comment after "source:" and "FILE:LINE", or "--set ...".
Origins config_origins(const JobOptions& options) {
  sim::set_config_search_path(config_folders());
  Origins out;
  Layers layers(out, options.sets);
  layers.add_file("", find_config(options.config));
  for (const std::string& set : options.sets) layers.add_set(set);
  return out;
}

/// Returns the kind of a unit from its path: "core.tni.trv" for "core0.tni.trv2".
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

/// Returns, for each energy event, the performance counters that count it.
std::map<std::string, std::set<std::string>> counters_by_event(const std::vector<sim::UnitReport>& units) {
  std::map<std::string, std::set<std::string>> out;
  for (const sim::UnitReport& unit : units) {
    for (const sim::CounterReport& c : unit.counters) {
      if (!c.event.empty()) out[c.event].insert(fmt::format("{} {}: {}", kind_of(unit.path), c.name, c.meaning));
    }
  }
  return out;
}

/// Returns a machine's configuration with the units that it may lack.
hw::GpuConfig with_all_units(hw::GpuConfig config) {
  config.tni.predictor.enabled = true;
  return config;
}

/// Finds the performance counters and hardware units whose energy depends on an entry of the energy tables.
class Users {
 public:
  explicit Users(const RunConfig& config)
      : config_(config),
        units_(idle_unit_reports(with_all_units(*config.gpu), {.rasterisers = true, .tree_builder = true}, config.bvh)),
        counters_(counters_by_event(units_)) {}

  const std::vector<sim::UnitReport>& all_units() const { return units_; }

  std::set<std::string> find_users(const EnergyEntry& entry) const {
    if (entry.name.starts_with(kEvents)) return counters_of_event(entry.name.substr(kEvents.size()));
    for (const std::string table : {"energy.logic.", "energy.flops."}) {
      if (entry.name.starts_with(table)) return unit_kinds_using(entry.name.substr(table.size()));
    }
    for (const std::string table : {"energy.parts.", "energy.parts_in_logic."}) {
      if (entry.name.starts_with(table)) return unit_kinds_containing(entry.name.substr(table.size()));
    }
    if (entry.name.starts_with("dram.")) return dram_events_using(entry.name);
    return {};
  }

 private:
  std::set<std::string> counters_of_event(const std::string& event) const {
    const auto found = counters_.find(event);
    return found == counters_.end() ? std::set<std::string>{} : found->second;
  }
  /// Returns the kinds of unit that use an entry. A unit without an entry of its own uses the entry of its area block.
  std::set<std::string> unit_kinds_using(const std::string& entry) const {
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
  /// Returns the kinds of unit that contain the hardware described by an entry, as text: the number of units, and how
  /// often each contains this hardware.
  std::set<std::string> unit_kinds_containing(const std::string& entry) const {
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
  /// Returns the energy events of the DRAM whose energy depends on the entry `name`.
  std::set<std::string> dram_events_using(const std::string& name) const {
    RunConfig changed = config_;
    for (EnergyEntry& entry : energy_entries(changed)) {
      for (const EnergyEntry::Figure& f : entry.figures) f.value->nominal += entry.name == name ? 1 : 0;
    }
    std::set<std::string> out;
    const auto before = hw::dram_energy_events(config_.gpu->dram), after = hw::dram_energy_events(changed.gpu->dram);
    for (const auto& [event, energy] : after) {
      if (energy.pj.nominal != before.at(event).pj.nominal) out.merge(counters_of_event(event));
    }
    return out;
  }

  const RunConfig& config_;
  std::vector<sim::UnitReport> units_;
  std::map<std::string, std::set<std::string>> counters_;
};

std::string band_text(const sim::Band& s, const std::string& unit) {
  const std::string band = s.low == s.high ? fmt::format("{:.10g}", s.nominal)
                                           : fmt::format("{:.10g} / {:.10g} / {:.10g}", s.low, s.nominal, s.high);
  return (unit.empty() ? band : band + " " + unit) + (s.low == s.high ? "  (no band)" : "");
}

/// Returns the size in bytes in the name of an energy value, "cache.l1_read@16KiB"; 0 if there is none.
double size_of(const EnergyEntry::Figure& figure) {
  const std::size_t at = figure.name.find('@');
  if (at == std::string::npos) return 0;
  return static_cast<double>(sim::read_quantity(figure.name.substr(at + 1), sim::byte_units()));
}

/// Describes how an energy grows with size: the exponents between neighbouring sizes of its curve.
std::string curve_text(const EnergyEntry& entry) {
  std::vector<std::string> steps;
  for (auto a = entry.figures.begin(), b = std::next(a); b != entry.figures.end(); ++a, ++b) {
    const double power = std::log(b->band.nominal / a->band.nominal) / std::log(size_of(*b) / size_of(*a));
    const auto text = [](const EnergyEntry::Figure& f) {
      return sim::quantity_text(static_cast<std::uint64_t>(size_of(f)), sim::byte_units());
    };
    steps.push_back(fmt::format("{:.2f} from {} to {}", power, text(*a), text(*b)));
  }
  return fmt::format("  grows with size to the power {}; extrapolated with the nearest exponent\n",
                     fmt::join(steps, ", "));
}

std::string short_name(const std::string& name) {
  return name.starts_with(kEvents) ? name.substr(kEvents.size()) : name;
}

/// Formats the origin of a configuration value: a line for the file or option that sets it, then one per factor `scale`
/// that multiplies it.
std::string printable_lines(const std::string& text) {
  std::string out;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::size_t first = std::min(text.find_first_not_of(' ', begin), end);
    out += (out.empty() ? "" : "\n      ") + sim::printable(text.substr(first, end - first), 2000);
    begin = end + 1;
  }
  return out;
}

std::string entry_text(const EnergyEntry& entry, const Users& users, const Origins& origins) {
  std::string out = short_name(entry.name) + "\n";
  for (const EnergyEntry::Figure& f : entry.figures) {
    const std::size_t at = f.name.find('@');
    const std::string size = at == std::string::npos ? "" : f.name.substr(at) + ": ";
    const auto origin = origins.find(f.name);
    out += fmt::format("  {}{}\n    {}\n", size, band_text(f.band, entry.unit),
                       origin == origins.end() ? "by default" : printable_lines(origin->second));
  }
  if (entry.figures.size() > 1) out += curve_text(entry);
  const std::set<std::string> counters = users.find_users(entry);
  if (counters.empty()) return out + "  " + entry.meaning + "\n";
  for (const std::string& counter : counters) out += "  counted by " + counter + "\n";
  return out;
}

/// Adds all names by which a user can select an energy table entry: each contiguous part of its path.
void add_names(const EnergyEntry& entry, std::set<std::string>& known) {
  const std::string name = entry.name + ".";
  for (std::size_t begin = 0; begin < name.size(); begin = name.find('.', begin) + 1) {
    for (std::size_t end = name.find('.', begin); end != std::string::npos; end = name.find('.', end + 1)) {
      known.insert(name.substr(begin, end - begin));
    }
  }
}

bool is_selected_entry(const std::string& entry, const std::string& name) {
  const std::string full = "." + entry;
  return name.empty() || full.ends_with("." + name) || full.find("." + name + ".") != std::string::npos;
}

}  // namespace

std::vector<std::string> energy_entry_names(const JobOptions& options) {
  RunConfig config = load_run_config(options);
  std::vector<std::string> names;
  for (const EnergyEntry& entry : energy_entries(config)) names.push_back(short_name(entry.name));
  return names;
}

std::string describe_energy_entries(const JobOptions& options, const std::string& name) {
  RunConfig config = load_run_config(options);
  const Origins origins = config_origins(options);
  const Users users(config);
  check_table_names(users.all_units(), config);
  std::string out;
  std::set<std::string> known;
  for (EnergyEntry& entry : energy_entries(config)) {
    std::ranges::sort(entry.figures, {}, size_of);
    add_names(entry, known);
    if (!is_selected_entry(entry.name, sim::event_name_of(name))) continue;
    out += (out.empty() ? "" : "\n") + entry_text(entry, users, origins);
  }
  if (out.empty()) {
    throw sim::InputError(fmt::format("there is no energy entry '{}'{}; allowed: see raywatt energy show",
                                      sim::printable(name),
                                      traces::did_you_mean(name, std::vector(known.begin(), known.end()))));
  }
  return fmt::format("{}: low / nominal / high\n\n{}", config.energy.process, out);
}

}  // namespace tools
