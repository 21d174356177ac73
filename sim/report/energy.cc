#include "sim/report/energy.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/config/quantity.h"
#include "sim/config/value.h"
#include "sim/edit_distance.h"
#include "sim/error.h"

namespace sim {
namespace {

std::uint64_t frequency_of(const std::string& name, std::string_view text) {
  try {
    const std::uint64_t hz = read_quantity(text, frequency_units());
    if (hz > 0) return hz;
    throw BadValue{"a frequency of 0"};
  } catch (const BadValue& bad) {
    throw InputError(
        fmt::format("power.dvfs.{}: {}; allowed: a domain and its frequency, such as tni@500MHz", name, bad.problem));
  }
}

}  // namespace

double VoltageCurve::voltage_at(std::uint64_t hz) const {
  const auto above = std::ranges::find_if(points_, [&](const Point& p) { return p.hz >= hz; });
  if (above != points_.end() && (above == points_.begin() || above->hz == hz)) return above->volt;
  if (points_.size() == 1) return points_.front().volt;
  const Point& b = above == points_.end() ? points_.back() : *above;
  const Point& a = *(&b - 1);
  return a.volt + (b.volt - a.volt) * (static_cast<double>(hz) - static_cast<double>(a.hz)) /
                      (static_cast<double>(b.hz) - static_cast<double>(a.hz));
}

std::map<std::string, VoltageCurve> voltage_curves(const PowerConfig& config) {
  std::map<std::string, VoltageCurve> curves;
  for (const auto& [name, volt] : config.dvfs) {
    const std::size_t at = std::min(name.find('@'), name.size());
    const std::uint64_t hz = frequency_of(name, std::string_view(name).substr(std::min(at + 1, name.size())));
    curves[name.substr(0, at)].points_.push_back({hz, volt.nominal});
  }
  for (auto& [domain, curve] : curves) {
    std::ranges::sort(curve.points_, {}, &VoltageCurve::Point::hz);
    for (std::size_t i = 1; i < curve.points_.size(); ++i) {
      const VoltageCurve::Point &a = curve.points_[i - 1], &b = curve.points_[i];
      if (a.hz < b.hz && a.volt <= b.volt) continue;
      throw InputError(fmt::format(
          "power.dvfs: {} has {} V at {} and {} V at {}; allowed: one voltage a frequency, "
          "which does not fall as the clock rises",
          domain, a.volt, quantity_text(a.hz, frequency_units()), b.volt, quantity_text(b.hz, frequency_units())));
    }
  }
  return curves;
}

PowerScale power_scale(const PowerConfig& config, double volt) {
  const double ratio = volt / config.nominal_voltage;
  return {ratio * ratio, std::pow(ratio, config.leakage_exponent) *
                             std::exp2((config.temperature - config.nominal_temperature) / config.leakage_doubling)};
}

namespace {

double size_of(std::string_view key, const std::string& name, std::string_view size) {
  try {
    const std::uint64_t bytes = read_quantity(size, byte_units());
    if (bytes > 0) return static_cast<double>(bytes);
    throw BadValue{"a size of 0"};
  } catch (const BadValue& bad) {
    throw InputError(fmt::format("{}.{}: {}; allowed: a size such as @16KiB", key, name, bad.problem));
  }
}

}  // namespace

EnergyTable::EnergyTable(const std::map<std::string, Band>& events, std::string_view key) {
  for (const auto& [name, pj] : events) {
    const std::size_t at = name.find('@');
    const double bytes = at == std::string::npos ? 0 : size_of(key, name, std::string_view(name).substr(at + 1));
    std::vector<EnergyCurve::Point>& curve = curves_[event_name_of(name)].points_;
    if (!curve.empty() && (bytes == 0 || curve.front().bytes == 0)) {
      throw InputError(fmt::format("{}.{}: given with and without a size; allowed: either", key, name));
    }
    curve.push_back({bytes, &pj});
  }
  for (auto& [name, curve] : curves_) std::ranges::sort(curve.points_, {}, &EnergyCurve::Point::bytes);
}

double EnergyPoint::energy_of(BandMember member) const {
  const double pj = left->*member;
  return right == nullptr ? pj : pj * std::pow(right->*member / pj, part);
}

EnergyPoint EnergyCurve::point_at(std::uint64_t bytes) const {
  if (points_.size() == 1) return {.left = points_.front().pj};
  assert(bytes > 0);
  const auto size = static_cast<double>(bytes);
  const auto above = std::ranges::find_if(points_, [&](const Point& p) { return p.bytes >= size; });
  const auto right = std::clamp(above, points_.begin() + 1, points_.end() - 1);
  const Point& a = *(right - 1);
  const Point& b = *right;
  return {a.pj, b.pj, std::log(size / a.bytes) / std::log(b.bytes / a.bytes)};
}

Band EnergyTable::energy_of(std::string_view event, std::uint64_t bytes) const {
  const EnergyPoint point = curve_of(event).point_at(bytes);
  return {point.energy_of(&Band::low), point.energy_of(&Band::nominal), point.energy_of(&Band::high)};
}

std::vector<std::string> EnergyTable::event_names() const {
  std::vector<std::string> names;
  for (const auto& [name, curve] : curves_) names.push_back(name);
  return names;
}

const Band& required_entry(const std::map<std::string, Band>& table, const UnitReport& unit, std::string_view key) {
  if (const Band* const entry = find_entry(table, unit)) return *entry;
  throw_missing_entry(unit, key);
}

void throw_missing_entry(const UnitReport& unit, std::string_view key) {
  throw InputError(
      fmt::format("{}: no entry for unit '{}'; allowed: '{}' or '{}'", key, unit.path, entry_name(unit), unit.block));
}

Band operator+(const Band& a, const Band& b) { return {a.low + b.low, a.nominal + b.nominal, a.high + b.high}; }
Band operator*(const Band& a, const Band& b) { return {a.low * b.low, a.nominal * b.nominal, a.high * b.high}; }
Band operator*(const Band& a, double factor) { return a * Band{factor, factor, factor}; }
Band& operator+=(Band& a, const Band& b) { return a = a + b; }

EnergyReport compute_energy(std::span<const UnitReport> units, const EnergyConfig& config,
                            const std::map<std::string, DeviceEvent>& device_events, Time elapsed,
                            const PowerScales& scales) {
  return EnergyFormula(units, config, device_events, elapsed, scales).compute_report();
}

EnergyByKind& EnergyByKind::operator+=(const EnergyByKind& other) {
  dynamic += other.dynamic;
  clock += other.clock;
  leakage += other.leakage;
  return *this;
}

EnergyReport& EnergyReport::operator+=(const EnergyReport& other) {
  for (const auto& [name, energy] : other.blocks) blocks[name] += energy;
  for (const auto& [block, more] : other.events) {
    for (const auto& [event, energy] : more) events[block][event] += energy;
  }
  kinds += other.kinds;
  total_pj += other.total_pj;
  return *this;
}

namespace {

double leakage_pj_per_mw(Time elapsed) {
  constexpr double kPicojoulesPerMilliwattFemtosecond = 1e-6;
  return static_cast<double>(elapsed) * kPicojoulesPerMilliwattFemtosecond;
}

std::uint64_t idle_cycles(const UnitReport& unit) {
  std::uint64_t cycles = 0;
  for (std::size_t i = 0; i < unit.reasons.size(); ++i) {
    if (unit.reasons[i].kind == ReasonKind::kIdle) cycles += unit.cycles_by_reason[i].second;
  }
  return cycles;
}

/// Flip-flops and logic area of units that are not on the chip.
constexpr Band kNothing{};

std::vector<std::string> blocks_of(std::span<const UnitReport> units) {
  std::set<std::string> blocks;
  for (const UnitReport& unit : units) blocks.insert(unit.block);
  return {blocks.begin(), blocks.end()};
}

}  // namespace

void EnergyFormula::Kinds::add(const Kinds& more) {
  dynamic += more.dynamic;
  clock += more.clock;
  leakage += more.leakage;
}

EnergyFormula::EnergyFormula(std::span<const UnitReport> units, const EnergyConfig& config,
                             const std::map<std::string, DeviceEvent>& device_events, Time elapsed,
                             const PowerScales& scales)
    : config_(config),
      table_(config.events),
      blocks_(blocks_of(units)),
      leakage_pj_per_mw_(leakage_pj_per_mw(elapsed)) {
  for (const std::string& block : blocks_) {
    const auto scale = scales.find(block);
    scales_.push_back(scale == scales.end() ? PowerScale{} : scale->second);
  }
  for (const UnitReport& unit : units) {
    const auto block = static_cast<std::size_t>(std::ranges::lower_bound(blocks_, unit.block) - blocks_.begin());
    Unit of{block,
            {},
            static_cast<double>(unit.sram_bytes) / 1024,
            static_cast<double>(idle_cycles(unit)),
            unit.block == kOutsideBlock ? &kNothing : &required_entry(config.flops, unit, "energy.flops"),
            LogicArea(unit, config)};
    for (const CounterReport& counter : unit.counters) {
      if (counter.event.empty()) continue;
      of.terms.push_back({index_of(find_event_energy(unit, counter, device_events)), static_cast<double>(counter.value),
                          counter.event});
    }
    units_.push_back(std::move(of));
  }
}

void EnergyFormula::set_counts(std::span<const UnitReport> units, Time elapsed) {
  assert(units.size() == units_.size());
  leakage_pj_per_mw_ = leakage_pj_per_mw(elapsed);
  for (std::size_t u = 0; u < units.size(); ++u) {
    units_[u].idle_cycles = static_cast<double>(idle_cycles(units[u]));
    auto term = units_[u].terms.begin();
    for (const CounterReport& counter : units[u].counters) {
      if (!counter.event.empty()) (term++)->count = static_cast<double>(counter.value);
    }
  }
}

EnergyFormula::EventEnergy EnergyFormula::find_event_energy(
    const UnitReport& unit, const CounterReport& counter,
    const std::map<std::string, DeviceEvent>& device_events) const {
  if (const auto device = device_events.find(counter.event); device != device_events.end()) {
    return {.device = &device->second};
  }
  if (!table_.contains(counter.event)) {
    throw InputError(fmt::format("energy.events: no figure for '{}', which counter '{}' of unit '{}' names",
                                 counter.event, counter.name, unit.path));
  }
  const EnergyCurve& curve = table_.curve_of(counter.event);
  if (unit.cache_bytes == 0 && curve.depends_on_size()) {
    throw InputError(fmt::format("energy.events: '{}' depends on the size of an array, and unit '{}' has none",
                                 counter.event, unit.path));
  }
  return {.point = curve.point_at(unit.cache_bytes)};
}

std::size_t EnergyFormula::index_of(const EventEnergy& energy) {
  const auto known = std::ranges::find(event_energies_, energy);
  if (known != event_energies_.end()) return static_cast<std::size_t>(known - event_energies_.begin());
  event_energies_.push_back(energy);
  return event_energies_.size() - 1;
}

std::vector<double> EnergyFormula::pj_per_event(BandMember member) const {
  std::vector<double> out;
  out.reserve(event_energies_.size());
  for (const EventEnergy& energy : event_energies_) out.push_back(energy.energy_of(member));
  return out;
}

EnergyFormula::Kinds EnergyFormula::unit_kinds(const Unit& unit, const std::vector<double>& pj_per_event,
                                               BandMember member) const {
  const PowerScale& scale = scales_[unit.block];
  Kinds sum;
  double on_chip = 0;
  for (const Term& term : unit.terms) {
    const DeviceEvent* device = event_energies_[term.energy_index].device;
    (device == nullptr ? on_chip
     : device->standby ? sum.leakage
                       : sum.dynamic) += pj_per_event[term.energy_index] * term.count;
  }
  const double share = config_.clock_share.*member;
  sum.dynamic += on_chip * scale.dynamic;
  sum.clock = (on_chip * (share / (1 - share)) +
               config_.flop_clock.*member * (config_.idle_clocked.*member) * (unit.flops->*member) * unit.idle_cycles) *
              scale.dynamic;
  sum.leakage +=
      (config_.sram_leakage.*member * unit.sram_kib + config_.logic_leakage.*member * unit.logic.area_of(member)) *
      leakage_pj_per_mw_ * scale.leakage;
  return sum;
}

std::vector<double> EnergyFormula::block_energies(BandMember member) const {
  const std::vector<double> values = pj_per_event(member);
  std::vector<Kinds> kinds(blocks_.size());
  for (const Unit& unit : units_) kinds[unit.block].add(unit_kinds(unit, values, member));
  std::vector<double> out;
  for (const Kinds& block : kinds) out.push_back(block.total());
  return out;
}

std::vector<double> EnergyFormula::kind_energies(BandMember member) const {
  const std::vector<double> values = pj_per_event(member);
  Kinds sum;
  for (const Unit& unit : units_) sum.add(unit_kinds(unit, values, member));
  return {sum.dynamic, sum.clock, sum.leakage};
}

double EnergyFormula::total_pj(BandMember member) const {
  const std::vector<double> values = pj_per_event(member);
  Kinds sum;
  for (const Unit& unit : units_) sum.add(unit_kinds(unit, values, member));
  return sum.total();
}

std::vector<EnergyFormula::UnitEnergy> EnergyFormula::unit_energies() const {
  std::vector<UnitEnergy> all(units_.size());
  for (const BandMember member : kBandMembers) {
    const std::vector<double> values = pj_per_event(member);
    const double share = config_.clock_share.*member;
    for (std::size_t u = 0; u < units_.size(); ++u) {
      const Unit& unit = units_[u];
      const PowerScale& scale = scales_[unit.block];
      all[u].events.resize(unit.terms.size());
      double counted = 0;
      for (std::size_t t = 0; t < unit.terms.size(); ++t) {
        const DeviceEvent* device = event_energies_[unit.terms[t].energy_index].device;
        double pj = values[unit.terms[t].energy_index] * unit.terms[t].count;
        if (device == nullptr) pj = pj / (1 - share) * scale.dynamic;
        if (device == nullptr || !device->standby) counted += all[u].events[t].*member = pj;
      }
      all[u].idle.*member = unit_kinds(unit, values, member).total() - counted;
    }
  }
  return all;
}

EnergyReport EnergyFormula::compute_report() const {
  EnergyReport report;
  for (const BandMember member : kBandMembers) {
    const std::vector<double> values = pj_per_event(member);
    for (const Unit& unit : units_) {
      const Kinds kinds = unit_kinds(unit, values, member);
      std::map<std::string, Band>& events = report.events[blocks_[unit.block]];
      for (const Term& term : unit.terms) {
        const double scale = event_energies_[term.energy_index].device == nullptr ? scales_[unit.block].dynamic : 1;
        events[term.event].*member += values[term.energy_index] * term.count * scale;
      }
      for (EnergyByKind* sum : {&report.blocks[blocks_[unit.block]], &report.kinds}) {
        sum->dynamic.*member += kinds.dynamic;
        sum->clock.*member += kinds.clock;
        sum->leakage.*member += kinds.leakage;
      }
    }
  }
  report.total_pj = report.kinds.total();
  return report;
}

namespace {

const Band& find_part_entry(const std::map<std::string, Band>& table, const UnitReport& unit, const UnitPart& part,
                            const char* key) {
  const std::string own = entry_name(unit) + "." + part.name, of_block = unit.block + "." + part.name;
  for (const std::string& name : {own, of_block}) {
    if (const auto found = table.find(name); found != table.end()) return found->second;
  }
  throw InputError(fmt::format("{}: no entry for part '{}' of unit '{}'; allowed: '{}' or '{}'", key, part.name,
                               unit.path, own, of_block));
}

}  // namespace

LogicArea::LogicArea(const UnitReport& unit, const EnergyConfig& config)
    : logic_(unit.block == kOutsideBlock ? &kNothing : &required_entry(config.logic, unit, "energy.logic")) {
  if (unit.block == kOutsideBlock) return;
  if (config.parts.empty() && config.parts_in_logic.empty()) return;
  for (const UnitPart& part : unit.parts) {
    const Band& area = find_part_entry(config.parts, unit, part, "energy.parts");
    const double held = find_part_entry(config.parts_in_logic, unit, part, "energy.parts_in_logic").nominal;
    if (part.count != held) differences_.push_back({part.count - held, &area});
  }
}

double LogicArea::area_of(BandMember member) const {
  double mm2 = logic_->*member;
  for (const Difference& d : differences_) mm2 += d.count * (d.count < 0 ? d.part->nominal : d.part->*member);
  return std::max(0.0, mm2);
}

Band LogicArea::area_band() const { return {area_of(&Band::low), area_of(&Band::nominal), area_of(&Band::high)}; }

namespace {

/// Returns the area of a unit's memory array. If several units share an array as its banks, returns the unit's share.
Band array_area_of(const EnergyTable& arrays, const UnitReport& unit) {
  const double share = static_cast<double>(unit.sram_bytes) / static_cast<double>(unit.cache_bytes);
  for (const std::string& name : {entry_name(unit), unit.block}) {
    if (arrays.contains(name)) return arrays.energy_of(name, unit.cache_bytes) * std::min(1.0, share);
  }
  throw_missing_entry(unit, "area.arrays");
}

/// Returns the area of a unit's pads, in proportion to its data pins. `area`: entry of the area table, for 16 pins.
Band pad_area_of(const Band& area, const UnitReport& unit) {
  if (unit.data_lines != 0) return area * (static_cast<double>(unit.data_lines) / 16);
  throw InputError(fmt::format("area.pads: unit '{}' has no data lines at the die's edge", unit.path));
}

}  // namespace

Band AreaOfBlock::total() const { return logic + arrays + buffers + pads; }

AreaReport compute_area(std::span<const UnitReport> units, const EnergyConfig& energy, const AreaConfig& config) {
  const EnergyTable arrays(config.arrays, "area.arrays");
  AreaReport report;
  for (const UnitReport& unit : units) {
    AreaOfBlock& block = report.blocks[unit.block];
    block.logic += LogicArea(unit, energy).area_band() * config.logic_scale;
    if (unit.cache_bytes != 0) block.arrays += array_area_of(arrays, unit);
    if (unit.sram_bytes > unit.cache_bytes) {
      const double kib = static_cast<double>(unit.sram_bytes - unit.cache_bytes) / 1024;
      block.buffers += required_entry(config.buffers, unit, "area.buffers") * kib;
    }
    if (const Band* const pads = find_entry(config.pads, unit)) block.pads += pad_area_of(*pads, unit);
  }
  for (const auto& [name, block] : report.blocks) report.total += block.total();
  report.total = report.total * config.placement;
  return report;
}

namespace {

using Names = std::set<std::string>;

/// Throws InputError for a table entry with an unknown name. `fault`: the problem, such as "no counter names this
/// event".
[[noreturn]] void throw_unknown_entry(std::string_view table, const std::string& name, std::string_view fault,
                                      const Names& known) {
  const std::string_view start = comparison_prefix(name);
  const auto found = find_nearest(start, known, std::max<std::size_t>(1, start.size() / 3));
  throw InputError(fmt::format("{}.{}: {}{}; allowed: {}", table, name, fault,
                               found == known.end() ? "" : fmt::format(", did you mean '{}'?", *found),
                               fmt::join(known, ", ")));
}

std::string whole_entry(std::string_view entry) { return std::string(entry); }

/// Throws InputError unless the names of all entries of an energy or area table are known. `name_of`: returns the name
/// of an entry, without a size at the end if the table has sizes.
void check_entries(std::string_view table, const std::map<std::string, Band>& entries, std::string_view fault,
                   const Names& known, std::string (*name_of)(std::string_view) = whole_entry) {
  for (const auto& [entry, value] : entries) {
    if (const std::string name = name_of(entry); !known.contains(name)) throw_unknown_entry(table, name, fault, known);
  }
}

constexpr std::string_view kNoUnit = "no unit goes by this name";

Names names_of(std::span<const UnitReport> units) {
  Names names;
  for (const UnitReport& unit : units) names.insert({entry_name(unit), unit.block});
  return names;
}

Names parts_of(std::span<const UnitReport> units) {
  Names names;
  for (const UnitReport& unit : units) {
    for (const UnitPart& part : unit.parts) {
      for (const std::string& name : {entry_name(unit), unit.block}) names.insert(name + "." + part.name);
    }
  }
  return names;
}

}  // namespace

void check_energy_events(const EnergyConfig& config, std::span<const std::string> declared) {
  const Names known(declared.begin(), declared.end());
  check_entries("energy.events", config.events, "no counter names this event", known, event_name_of);
  const EnergyTable table(config.events);
  for (const std::string& name : known) {
    if (!table.contains(name)) throw InputError(fmt::format("energy.events: no figure for '{}'", name));
  }
}

void check_unit_names(const EnergyConfig& config, std::span<const UnitReport> units) {
  const Names known = names_of(units), parts = parts_of(units);
  check_entries("energy.logic", config.logic, kNoUnit, known);
  check_entries("energy.flops", config.flops, kNoUnit, known);
  check_entries("energy.parts", config.parts, "no unit has a part of this name", parts);
  check_entries("energy.parts_in_logic", config.parts_in_logic, "no unit has a part of this name", parts);
}

void check_unit_names(const AreaConfig& config, std::span<const UnitReport> units) {
  const Names known = names_of(units);
  check_entries("area.arrays", config.arrays, kNoUnit, known, event_name_of);
  check_entries("area.buffers", config.buffers, kNoUnit, known);
  check_entries("area.pads", config.pads, kNoUnit, known);
}

namespace {

/// The memory array of one kind of unit, and the range of sizes of its energy or area curve.
struct Array {
  std::string kind;
  std::uint64_t bytes, least, most;
  auto operator<=>(const Array&) const = default;
};
/// Memory arrays whose size is outside their energy or area curve, each with the names of its table entries.
using ArraysOutsideCurve = std::map<Array, std::set<std::string>>;

void add_if_outside(const EnergyTable& table, const std::string& entry, const UnitReport& unit,
                    ArraysOutsideCurve& outside) {
  if (!table.contains(entry) || !table.curve_of(entry).depends_on_size()) return;
  const EnergyCurve& curve = table.curve_of(entry);
  if (unit.cache_bytes >= curve.smallest_array_bytes() && unit.cache_bytes <= curve.largest_array_bytes()) return;
  outside[{entry_name(unit), unit.cache_bytes, curve.smallest_array_bytes(), curve.largest_array_bytes()}].insert(
      entry);
}

std::string size_text(std::uint64_t bytes) { return quantity_text(bytes, byte_units()); }

void append_warnings(const char* table, const ArraysOutsideCurve& outside, std::vector<std::string>& lines) {
  for (const auto& [array, entries] : outside) {
    lines.push_back(fmt::format("{}: the array of {} has {}, outside {} to {} of {}, and is extrapolated", table,
                                array.kind, size_text(array.bytes), size_text(array.least), size_text(array.most),
                                fmt::join(entries, ", ")));
  }
}

}  // namespace

std::vector<std::string> curve_range_warnings(std::span<const UnitReport> units,
                                              const std::map<std::string, Band>& events,
                                              const std::map<std::string, Band>& arrays) {
  const EnergyTable energy(events), area(arrays, "area.arrays");
  ArraysOutsideCurve of_energy, of_area;
  for (const UnitReport& unit : units) {
    if (unit.cache_bytes == 0) continue;
    for (const CounterReport& counter : unit.counters) add_if_outside(energy, counter.event, unit, of_energy);
    const std::string name = entry_name(unit);
    add_if_outside(area, area.contains(name) ? name : unit.block, unit, of_area);
  }
  std::vector<std::string> lines;
  append_warnings("energy.events", of_energy, lines);
  append_warnings("area.arrays", of_area, lines);
  return lines;
}

}  // namespace sim
