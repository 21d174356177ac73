#include "sim/machine.h"

#include <algorithm>
#include <stdexcept>
#include <string_view>

namespace sim {

UnitId Machine::unit(Declaration declared) {
  expect(!started(), "a unit is declared before the start");
  declared_.push_back(std::move(declared));
  return {declared_.size() - 1, declared_.back().clock};
}

void Machine::expect(bool kept, std::string_view rule) {
  if (!kept) throw std::logic_error("sim::Machine: " + std::string(rule));
}

void Machine::expect_to_be_built(UnitId id) const {
  expect(!started(), "a unit is built before the start");
  expect(id.index < declared_.size(), "a unit is declared before it is built");
  expect(std::ranges::none_of(units_, [&](const auto& unit) { return unit->declared == id.index; }),
         declared_[id.index].name + " is built once");
}

void Machine::expect_to_be_a_cluster(const std::vector<UnitId>& units) const {
  expect(!started() && !units.empty(), "a cluster has units, and is named before the start");
  const Declaration& first = declared_[units.front().index];
  const auto alike = [&](UnitId unit) {
    return unit.clock == first.clock && declared_[unit.index].partition == first.partition;
  };
  expect(first.partition != 0 && std::ranges::all_of(units, alike), "a cluster has one outer partition and one clock");
  const auto elsewhere = [&](const ClusteredUnits& other) {
    return declared_[other.units.front().index].partition != first.partition;
  };
  expect(std::ranges::all_of(clusters_, elsewhere), "a partition has one cluster at most");
}

bool Machine::quiet() const {
  return std::ranges::all_of(units_, [](const auto& unit) { return unit->idle(); }) &&
         std::ranges::all_of(wires_, [](const auto& wire) { return wire->empty(); });
}

void Machine::record(Intervals& intervals) {
  expect(!started(), "intervals are recorded from the start");
  std::size_t width = 0;
  for (const UnitReport& unit : report()) width += unit.why.size() + unit.counters.size();
  intervals.begin(width);
  intervals_ = &intervals;
  next_edge_ = intervals.next_edge();
}

void Machine::pass_edges(Time now) {
  for (; next_edge_ <= now; next_edge_ = intervals_->next_edge()) {
    bring_up_to(next_edge_);
    write_row(intervals_->next_row());
  }
}

void Machine::finish(Time end) {
  if (intervals_ != nullptr) pass_edges(end - 1);
  bring_up_to(end);
  if (intervals_ == nullptr) return;
  write_row(intervals_->last_row(end));
  next_edge_ = kNever;
}

void Machine::bring_up_to(Time end) {
  for (const auto& unit : units_) unit->finish(declared_[unit->declared].clock.edge_at_or_after(end));
}

void Machine::write_row(std::uint64_t* row) const {
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

std::uint64_t Machine::retired() const {
  std::uint64_t all = 0;
  for (const auto& unit : units_) all += unit->retired();
  return all;
}

void Machine::start() {
  if (started()) return;
  expect(units_.size() == declared_.size(), "each declared unit is built");
  place_units();
  connect_links();
}

/// Assigns wake-up times: whole groups for each partition, separate groups for its cluster, the inner partition last.
void Machine::place_units() {
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
    outer.units = place(members[number], slot);
    outer.cluster.units = place(clustered[number], slot);
  }
  partitions_.inner.units = place(members[0], slot);
  wakes_.reset(slot, kNever);
  ticked_.resize(slot);
  for (const auto& unit : units_) {
    ticked_[slots_[unit->declared]] = unit->ticked;
    wakes_.lower(slots_[unit->declared], 0);
  }
}

/// Gives the units neighbouring wake-up times from `slot` on and advances `slot` to the next whole group.
Wakes::Groups Machine::place(std::span<const std::size_t> units, std::size_t& slot) {
  const std::size_t first = slot / Wakes::kGroup;
  for (const std::size_t unit : units) slots_[unit] = slot++;
  slot = Wakes::whole_groups(slot);
  return {first, slot / Wakes::kGroup};
}

void Machine::connect_links() {
  for (const auto& wire : wires_) {
    const std::size_t from = declared_[wire->from].partition, to = declared_[wire->to].partition;
    expect(from == to || from == 0 || to == 0, "outer partitions meet the inner one alone");
    Partition& sender = from == 0 ? partitions_.inner : partitions_.outer[from - 1];
    wire->connect(wakes_.of(slots_[wire->from]), wakes_.of(slots_[wire->to]),
                  from != to ? &sender.nearly_full : nullptr);
    if (from != to && wire->lookahead == Lookahead::kByLatency) lookahead_ = std::min(lookahead_, wire->latency());
  }
}

}  // namespace sim
