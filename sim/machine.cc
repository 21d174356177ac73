#include "sim/machine.h"

#include <algorithm>
#include <stdexcept>
#include <string_view>

namespace sim {

UnitId Machine::unit(Declaration declaration) {
  require_rule(!is_started(), "a unit is declared before the start");
  declared_.push_back(std::move(declaration));
  return {declared_.size() - 1, declared_.back().clock};
}

void Machine::require_rule(bool is_kept, std::string_view rule) {
  if (!is_kept) throw std::logic_error("sim::Machine: " + std::string(rule));
}

void Machine::require_unbuilt(UnitId id) const {
  require_rule(!is_started(), "a unit is built before the start");
  require_rule(id.index < declared_.size(), "a unit is declared before it is built");
  require_rule(std::ranges::none_of(units_, [&](const auto& unit) { return unit->declared == id.index; }),
               declared_[id.index].name + " is built once");
}

void Machine::require_cluster_rules(const std::vector<UnitId>& units) const {
  require_rule(!is_started() && !units.empty(), "a cluster has units, and is named before the start");
  const Declaration& first = declared_[units.front().index];
  const auto alike = [&](UnitId unit) {
    return unit.clock == first.clock && declared_[unit.index].partition == first.partition;
  };
  require_rule(first.partition != 0 && std::ranges::all_of(units, alike),
               "a cluster has one outer partition and one clock");
  const auto elsewhere = [&](const ClusteredUnits& other) {
    return declared_[other.units.front().index].partition != first.partition;
  };
  require_rule(std::ranges::all_of(clusters_, elsewhere), "a partition has one cluster at most");
}

bool Machine::is_drained() const {
  return std::ranges::all_of(units_, [](const auto& unit) { return unit->idle(); }) &&
         std::ranges::all_of(wires_, [](const auto& wire) { return wire->empty(); });
}

void Machine::record_intervals(Intervals& intervals) {
  require_rule(!is_started(), "intervals are recorded from the start");
  std::size_t width = 0;
  for (const UnitReport& unit : report()) width += unit.cycles_by_reason.size() + unit.counters.size();
  intervals.allocate_rows(width);
  intervals_ = &intervals;
  next_boundary_ = intervals.next_interval_boundary();
}

void Machine::sample_intervals_until(Time now) {
  for (; next_boundary_ <= now; next_boundary_ = intervals_->next_interval_boundary()) {
    account_until(next_boundary_);
    write_counter_values(intervals_->add_next_row());
  }
}

void Machine::finish(Time end) {
  if (intervals_ != nullptr) sample_intervals_until(end - 1);
  account_until(end);
  if (intervals_ == nullptr) return;
  write_counter_values(intervals_->add_last_row(end));
  next_boundary_ = kNever;
}

void Machine::account_until(Time end) {
  for (const auto& unit : units_) unit->finish(declared_[unit->declared].clock.edge_at_or_after(end));
}

void Machine::write_counter_values(std::uint64_t* row) const {
  for (const Values& values : values_) row = values.write(values.unit, row);
}

std::string Machine::state() const {
  std::string all;
  for (const auto& unit : units_) {
    const std::string state = unit->state();
    if (!state.empty()) all += declared_[unit->declared].name + ": " + state + "\n";
  }
  return all;
}

std::vector<UnitReport> Machine::report() const {
  std::vector<UnitReport> all;
  all.reserve(reports_.size());
  for (const auto& report : reports_) all.push_back(report());
  return all;
}

std::uint64_t Machine::retired_items() const {
  std::uint64_t all = 0;
  for (const auto& unit : units_) all += unit->retired_items();
  return all;
}

void Machine::start() {
  if (is_started()) return;
  require_rule(units_.size() == declared_.size(), "each declared unit is built");
  assign_wakeup_slots();
  connect_links();
}

/// Assigns each unit an index in the wake-up table. Each partition and each cluster gets separate groups of the table.
/// The inner partition gets the last groups.
void Machine::assign_wakeup_slots() {
  std::size_t partitions = 1;
  for (const Declaration& declared : declared_) partitions = std::max(partitions, declared.partition + 1);
  partitions_.outer.resize(partitions - 1);
  slots_.resize(declared_.size());
  std::vector<std::vector<std::size_t>> members(partitions), clustered(partitions);
  for (const ClusteredUnits& cluster : clusters_) {
    const std::size_t number = declared_[cluster.units.front().index].partition;
    for (const UnitId unit : cluster.units) clustered[number].push_back(unit.index);
    Cluster& of = partitions_.outer[number - 1].cluster;
    of.owner = cluster.owner;
    of.run = cluster.run;
  }
  for (std::size_t unit = 0; unit < declared_.size(); ++unit) {
    const std::size_t number = declared_[unit].partition;
    if (std::ranges::find(clustered[number], unit) == clustered[number].end()) members[number].push_back(unit);
  }
  std::size_t slot = 0;
  for (std::size_t number = 1; number < partitions; ++number) {
    Partition& outer = partitions_.outer[number - 1];
    outer.units = assign_group_slots(members[number], slot);
    outer.cluster.units = assign_group_slots(clustered[number], slot);
  }
  partitions_.inner.units = assign_group_slots(members[0], slot);
  wakeups_.reset(slot, kNever);
  tick_functions_.resize(slot);
  for (const auto& unit : units_) {
    tick_functions_[slots_[unit->declared]] = unit->tick;
    wakeups_.lower_to(slots_[unit->declared], 0);
  }
}

/// Assigns consecutive entries of the wake-up table, from index `slot` on. Advances `slot` to the next group.
WakeupTable::Groups Machine::assign_group_slots(std::span<const std::size_t> units, std::size_t& slot) {
  const std::size_t first = slot / WakeupTable::kGroup;
  for (const std::size_t unit : units) slots_[unit] = slot++;
  slot = WakeupTable::round_up_to_groups(slot);
  return {first, slot / WakeupTable::kGroup};
}

void Machine::connect_links() {
  for (const auto& wire : wires_) {
    const std::size_t from = declared_[wire->from].partition, to = declared_[wire->to].partition;
    require_rule(from == to || from == 0 || to == 0, "outer partitions meet the inner one alone");
    Partition& sender = from == 0 ? partitions_.inner : partitions_.outer[from - 1];
    wire->attach_ends(wakeups_.handle_of(slots_[wire->from]), wakeups_.handle_of(slots_[wire->to]),
                      from != to ? &sender.nearly_full : nullptr);
    if (from != to && wire->lookahead == Lookahead::kByLatency) lookahead_ = std::min(lookahead_, wire->latency());
  }
}

}  // namespace sim
