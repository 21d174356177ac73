#include "tools/studies/baseline/regression_locator.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include <fmt/format.h>

#include "hw_models/machines/unit_kinds.h"
#include "tools/analysis/units.h"
#include "tools/studies/baseline/changed_keys.h"

namespace tools {
namespace {

double value(const Values& values, const std::string& path) {
  const auto found = values.find(path);
  return found == values.end() ? 0 : found->second;
}

/// A cycle of an average unit of a kind, in T&I cycles.
double scale(const Values& values, std::string_view unit) {
  const double elapsed = value(values, fmt::format("units.{}.elapsed", unit));
  return elapsed == 0 ? 0 : value(values, "totals.cycles") / elapsed;
}

/// A unit's reason in both runs.
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
                     value(was, prefix + reason) * scale(was, unit), value(is, prefix + reason) * scale(is, unit)});
    }
  }
  return out;
}

/// A counter's sum over all units of a kind.
template <class Unit>
double sum_of(const Values& values, std::uint64_t Unit::Stats::*counter, std::string_view kind = Unit::kName) {
  return value(values, counter_path<Unit>(counter, kind));
}

/// A counter of cycles, in T&I cycles of all units of the kind together.
template <class Unit>
double time_of(const Values& values, std::uint64_t Unit::Stats::*counter, std::string_view kind = Unit::kName) {
  return sum_of<Unit>(values, counter, kind) * scale(values, kind) * value(values, fmt::format("units.{}.units", kind));
}

/// Lines requested by one level and served by the next, and the time of all of them together in T&I cycles, as counted
/// on each side.
struct Traffic {
  double requested = 0, served = 0;
  double request_time = 0, service_time = 0;
  /// Time spent between the two levels. None if the next level also served other requesters: their time is only in
  /// `service_time`, so that the difference of the sums would be meaningless. The same holds if it would be negative.
  std::optional<double> between() const {
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

/// The time of misses between two levels in both runs.
struct Way {
  const char* name;
  double was = 0, is = 0;
  double difference() const { return is - was; }
};

/// Ways whose time both runs counted.
std::vector<Way> ways(const Values& was, const Values& is) {
  std::vector<Way> out;
  const auto add = [&](const char* name, Traffic (*traffic)(const Values&)) {
    const std::optional<double> before = traffic(was).between(), after = traffic(is).between();
    if (before && after) out.push_back({name, *before, *after});
  };
  add("interconnect between first-level caches and L2", between_l1_and_l2);
  add("way between L2 and memory", between_l2_and_memory);
  return out;
}

/// Time that misses waited in queues on their way, which says nothing of the way.
double queued(const Values& values) {
  using Port = hw::CorePort;
  return time_of<Port>(values, &Port::Stats::request_wait, Port::kCachePort) +
         time_of<Port>(values, &Port::Stats::line_wait, Port::kCachePort);
}

/// Text of a reason's time in both runs, in the unit's own cycles, all units of the kind together.
std::string moved_text(const Values& was, const Values& is, std::string_view unit, const std::string& reason) {
  const std::string path = fmt::format("units.{}.why.{}", unit, reason);
  const double before = value(was, path), after = value(is, path);
  return fmt::format("why.{} {} -> {} cycles ({:+})", reason, before, after, after - before);
}

/// Own work that moved, summed by unit, and the reason that moved most.
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
  if (units == was.end() || !units->first.starts_with("units.")) return std::nullopt;  // not kept
  const std::vector<Move> moves = all_moves(was, is);
  const std::vector<Own> owns = own_work(moves);
  constexpr double kNoticeable = 0.1;  // share of what else moved
  const double cycles = std::abs(value(is, "totals.cycles") - value(was, "totals.cycles"));
  double all = 0;
  for (const Own& own : owns) all += std::abs(own.difference);
  const auto most = std::ranges::max_element(owns, {}, [](const Own& own) { return std::abs(own.difference); });
  const double own = most == owns.end() ? 0 : std::abs(most->difference);

  const std::vector<Way> counted = ways(was, is);
  const auto way = std::ranges::max_element(counted, {}, [](const Way& w) { return std::abs(w.difference()); });
  const double on_way = way == counted.end() ? 0 : std::abs(way->difference());
  if (own > 0 && own >= kNoticeable * std::max(cycles, on_way)) {
    return LocatedRegression{std::string(most->unit), moved_text(was, is, most->unit, most->most->reason), own / all};
  }
  if (on_way >= kNoticeable * cycles && on_way > 0) {
    return LocatedRegression{
        way->name,
        fmt::format("misses spent {:.0f} -> {:.0f} T&I cycles there ({:+.0f})", way->was, way->is, way->difference()),
        on_way / (on_way + all + std::abs(queued(is) - queued(was)))};
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
  double own = 0, all = 0;  // work that moved
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
