#include "tools/studies/baseline/changes.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include <fmt/format.h>

#include "hw_models/machines/unit_kinds.h"
#include "tools/analysis/units.h"

namespace tools {
namespace {

/// Returns the name of the configuration group of a unit kind: "tni.trv" of "core.tni.trv".
std::string_view without_core(std::string_view kind) {
  constexpr std::string_view kCore = "core.";
  return kind.starts_with(kCore) ? kind.substr(kCore.size()) : kind;
}

/// Returns the unit kind of a configuration group; empty if there is none or more than one.
std::string_view kind_of_group(std::string_view group) {
  std::string_view inside;
  std::size_t kinds_inside = 0;
  for (const hw::UnitKind& kind : hw::kUnitKinds) {
    if (without_core(kind.name) == group) return kind.name;
    if (!is_part_of(kind.name, group)) continue;
    inside = kind.name;
    kinds_inside += 1;
  }
  return kinds_inside == 1 ? inside : std::string_view();
}

/// Returns "dram.timing" of "dram.timing.rcd"; empty for a key without a group.
std::string_view group_of(std::string_view key) {
  const std::size_t dot = key.rfind('.');
  return dot == std::string_view::npos ? std::string_view() : key.substr(0, dot);
}

}  // namespace

ChangedKeys changed_keys(const FlatConfig& was, const FlatConfig& is) {
  ChangedKeys out;
  for (const auto& [key, before] : was) {
    const auto after = is.find(key);
    if (after == is.end()) {
      out.of_one.push_back({key, before, "none"});
    } else if (before != after->second) {
      out.changed.push_back({key, before, after->second});
    }
  }
  for (const auto& [key, after] : is) {
    if (!was.contains(key)) out.of_one.push_back({key, "none", after});
  }
  std::ranges::stable_sort(out.of_one, {}, &KeyPair::key);
  return out;
}

std::string unit_of_key(std::string_view key) {
  std::string_view group = key;
  for (std::size_t dot = key.rfind('.'); dot != std::string_view::npos; dot = group.rfind('.')) {
    group = group.substr(0, dot);
    if (const std::string_view kind = kind_of_group(group); !kind.empty()) return std::string(kind);
  }
  return group == key ? std::string() : std::string(group);
}

bool is_part_of(std::string_view kind, std::string_view unit) {
  const std::string_view name = without_core(kind);
  return kind == unit || (name.starts_with(unit) && name.size() > unit.size() && name[unit.size()] == '.');
}

std::string changed_text(const KeyPair& key) { return fmt::format("{} was {}, is {}", key.key, key.a, key.b); }

std::string changed_text(const std::vector<KeyPair>& keys) {
  constexpr std::ptrdiff_t kMostOfGroup = 4;
  std::vector<std::string> units;
  for (const KeyPair& key : keys) {
    std::string unit = unit_of_key(key.key);
    if (std::ranges::find(units, unit) == units.end()) units.push_back(std::move(unit));
  }
  std::string out;
  for (const std::string& unit : units) {
    std::string_view shown;  // group of the previous line
    for (const KeyPair& key : keys) {
      if (unit_of_key(key.key) != unit) continue;
      const std::string_view group = group_of(key.key);
      const auto others = std::ranges::count(keys, group, [](const KeyPair& k) { return group_of(k.key); }) - 1;
      const bool is_many = !group.empty() && others >= kMostOfGroup;
      if (is_many && group == shown) continue;
      shown = group;
      out += fmt::format("Changed{}: {}{}\n", unit.empty() ? "" : " in " + unit, changed_text(key),
                         is_many ? fmt::format(", and {} more keys of {}", others, group) : "");
    }
  }
  return out;
}

namespace {

double value_or_zero(const Values& values, const std::string& path) {
  const auto found = values.find(path);
  return found == values.end() ? 0 : found->second;
}

/// Returns the length of a cycle of an average unit of a kind, in T&I cycles.
double tni_cycles_per_cycle(const Values& values, std::string_view unit) {
  const double elapsed = value_or_zero(values, fmt::format("units.{}.elapsed", unit));
  return elapsed == 0 ? 0 : value_or_zero(values, "totals.cycles") / elapsed;
}

/// Cycles of a unit with one reason, in both runs.
struct Move {
  std::string_view unit;
  std::string reason;
  sim::ReasonKind kind;
  double was = 0, is = 0;  ///< T&I cycles of an average unit
  double difference() const { return is - was; }
};

std::vector<Move> all_moves(const Values& was, const Values& is) {
  std::vector<Move> out;
  for (const auto& [unit, declared] : hw::kUnitKinds) {
    const std::string prefix = fmt::format("units.{}.why.", unit);
    std::set<std::string> reasons;
    for (const Values* values : {&was, &is}) {
      for (auto at = values->lower_bound(prefix); at != values->end() && at->first.starts_with(prefix); ++at) {
        reasons.insert(at->first.substr(prefix.size()));
      }
    }
    for (const std::string& reason : reasons) {
      out.push_back({unit, reason, hw::kind_of_reason(unit, reason).value_or(sim::ReasonKind::kWaiting),
                     value_or_zero(was, prefix + reason) * tni_cycles_per_cycle(was, unit),
                     value_or_zero(is, prefix + reason) * tni_cycles_per_cycle(is, unit)});
    }
  }
  return out;
}

/// Returns the sum of a counter over all units of a kind.
template <class Unit>
double sum_of(const Values& values, std::uint64_t Unit::Stats::*counter, std::string_view kind = Unit::kName) {
  return value_or_zero(values, counter_path<Unit>(counter, kind));
}

/// Returns a counter of cycles in T&I cycles, summed over all units of the kind.
template <class Unit>
double time_of(const Values& values, std::uint64_t Unit::Stats::*counter, std::string_view kind = Unit::kName) {
  return sum_of<Unit>(values, counter, kind) * tni_cycles_per_cycle(values, kind) *
         value_or_zero(values, fmt::format("units.{}.units", kind));
}

/// Lines requested by one level and served by the next, and their total time in T&I cycles, as counted by each level.
struct Traffic {
  double requested = 0, served = 0;
  double request_time = 0, service_time = 0;
  /// Returns the time spent between the two levels. None if it would be negative, or if the next level also served
  /// other requesters, whose time is only in `service_time`.
  std::optional<double> time_between() const {
    if (requested != served || request_time < service_time) return {};
    return request_time - service_time;
  }
};

Traffic between_l1_and_l2(const Values& values) {
  using Trv = hw::Trv::Stats;
  using Ist = hw::Ist::Stats;
  using Srp = hw::Srp::Stats;
  using L2 = hw::L2Bank::Stats;
  return {.requested = sum_of<hw::Trv>(values, &Trv::l1_fills) + sum_of<hw::Ist>(values, &Ist::l1_fills) +
                       sum_of<hw::Srp>(values, &Srp::cache_fills),
          .served = sum_of<hw::L2Bank>(values, &L2::reads),
          .request_time = time_of<hw::Trv>(values, &Trv::l1_miss_cycles) +
                          time_of<hw::Ist>(values, &Ist::l1_miss_cycles) +
                          time_of<hw::Srp>(values, &Srp::cache_miss_cycles),
          .service_time = time_of<hw::L2Bank>(values, &L2::latency)};
}
Traffic between_l2_and_memory(const Values& values) {
  using L2 = hw::L2Bank::Stats;
  using Dram = hw::DramChannel::Stats;
  return {.requested = sum_of<hw::L2Bank>(values, &L2::fills),
          .served = sum_of<hw::DramChannel>(values, &Dram::reads),
          .request_time = time_of<hw::L2Bank>(values, &L2::line_cycles),
          .service_time = time_of<hw::DramChannel>(values, &Dram::read_latency)};
}

/// Miss time between two levels, in both runs.
struct TrafficPath {
  const char* name;
  double was = 0, is = 0;
  double difference() const { return is - was; }
};

/// Returns the paths whose time both runs counted.
std::vector<TrafficPath> traffic_paths(const Values& was, const Values& is) {
  std::vector<TrafficPath> out;
  const auto add = [&](const char* name, Traffic (*traffic)(const Values&)) {
    const std::optional<double> before = traffic(was).time_between(), after = traffic(is).time_between();
    if (before && after) out.push_back({name, *before, *after});
  };
  add("interconnect between first-level caches and L2", between_l1_and_l2);
  add("path between L2 and memory", between_l2_and_memory);
  return out;
}

/// Returns the time that misses waited in queues, which does not depend on the latency of the path.
double queue_time(const Values& values) {
  using Port = hw::CorePort;
  return time_of<Port>(values, &Port::Stats::request_wait, Port::kCachePort) +
         time_of<Port>(values, &Port::Stats::line_wait, Port::kCachePort);
}

/// Describes the cycles of a reason in both runs, in the unit's clock, summed over all units of the kind.
std::string moved_text(const Values& was, const Values& is, std::string_view unit, const std::string& reason) {
  const std::string path = fmt::format("units.{}.why.{}", unit, reason);
  const double before = value_or_zero(was, path), after = value_or_zero(is, path);
  return fmt::format("why.{} {} -> {} cycles ({:+})", reason, before, after, after - before);
}

/// Change of the working time of a unit, and its reason that moved most.
struct Own {
  std::string_view unit;
  double difference = 0;
  const Move* most = nullptr;
};

std::vector<Own> own_work(const std::vector<Move>& moves) {
  std::vector<Own> out;
  for (const Move& move : moves) {
    if (move.kind != sim::ReasonKind::kWorking || move.difference() == 0) continue;
    if (out.empty() || out.back().unit != move.unit) out.push_back({move.unit, 0, &move});
    Own& own = out.back();
    own.difference += move.difference();
    if (std::abs(move.difference()) > std::abs(own.most->difference())) own.most = &move;
  }
  return out;
}

}  // namespace

std::optional<LocatedRegression> locate_regression(const Values& was, const Values& is) {
  const auto units = was.lower_bound("units.");
  if (units == was.end() || !units->first.starts_with("units.")) return std::nullopt;  // counters of units are not kept
  const std::vector<Move> moves = all_moves(was, is);
  const std::vector<Own> owns = own_work(moves);
  constexpr double kNoticeable = 0.1;  // share of the largest other move
  const double cycles = std::abs(value_or_zero(is, "totals.cycles") - value_or_zero(was, "totals.cycles"));
  double all = 0;
  for (const Own& own : owns) all += std::abs(own.difference);
  const auto most = std::ranges::max_element(owns, {}, [](const Own& own) { return std::abs(own.difference); });
  const double own = most == owns.end() ? 0 : std::abs(most->difference);

  const std::vector<TrafficPath> counted = traffic_paths(was, is);
  const auto way = std::ranges::max_element(counted, {}, [](const TrafficPath& w) { return std::abs(w.difference()); });
  const double on_way = way == counted.end() ? 0 : std::abs(way->difference());
  if (own > 0 && own >= kNoticeable * std::max(cycles, on_way)) {
    return LocatedRegression{std::string(most->unit), moved_text(was, is, most->unit, most->most->reason), own / all};
  }
  if (on_way >= kNoticeable * cycles && on_way > 0) {
    return LocatedRegression{
        way->name,
        fmt::format("misses spent {:.0f} -> {:.0f} T&I cycles there ({:+.0f})", way->was, way->is, way->difference()),
        on_way / (on_way + all + std::abs(queue_time(is) - queue_time(was)))};
  }
  double waited = 0;
  for (const Move& move : moves) {
    if (move.kind == sim::ReasonKind::kWaiting) waited = std::max(waited, std::abs(move.difference()));
  }
  for (const Move& move : moves) {
    if (move.kind != sim::ReasonKind::kWaiting || waited == 0 || std::abs(move.difference()) < waited / 2) continue;
    return LocatedRegression{std::string(move.unit), moved_text(was, is, move.unit, move.reason),
                             waited / (waited + all)};
  }
  return {};
}

std::optional<LocatedRegression> largest_move_in(std::string_view unit, const Values& was, const Values& is) {
  const std::vector<Move> moves = all_moves(was, is);
  const Move* most = nullptr;
  double own = 0, all = 0;  // working time that moved
  for (const Move& move : moves) {
    const bool is_work = move.kind == sim::ReasonKind::kWorking, is_inside = is_part_of(move.unit, unit);
    const double size = std::abs(move.difference());
    if (is_work) all += size;
    if (is_work && is_inside) own += size;
    if (!is_inside || size == 0 || !(is_work || move.kind == sim::ReasonKind::kWaiting)) continue;
    if (most == nullptr || size > std::abs(most->difference())) most = &move;
  }
  if (most == nullptr) return {};
  return LocatedRegression{std::string(most->unit), moved_text(was, is, most->unit, most->reason),
                           all == 0 ? 0 : own / all};
}

}  // namespace tools
