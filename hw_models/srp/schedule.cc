#include "hw_models/srp/schedule.h"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "hw_models/srp/schedule_graph.h"

namespace hw {
namespace {

using kernels::GraphNode;
using kernels::Op;

constexpr std::uint32_t kNone = GraphNode::kNone;
/// Number of placements per operation after which the scheduler gives up an initiation interval.
constexpr std::size_t kPatience = 16;
/// Total number of placements after which the scheduler increases the initiation interval in larger steps and tries
/// fewer placements per operation.
constexpr std::size_t kQuick = 10'000;
constexpr std::size_t kLessPatience = 4;

/// Priority by which the kernel scheduler orders the operations to be placed.
enum class Order : std::uint8_t {
  kByHeight,   ///< operations with the longest path to the end of an item first
  kLongFirst,  ///< operations that occupy a unit for several cycles first, because they need long gaps; then by height
};

/// Tries to place all operations of a kernel at one initiation interval, by iterative modulo scheduling. An operation
/// that finds no free unit displaces others, which are placed again later.
class Placer {
 public:
  Placer(const ScheduleGraph& graph, const SrpConfig& config, std::uint32_t ii, Order order)
      : graph_(graph),
        config_(config),
        ii_(ii),
        height_(graph.path_heights(ii)),
        starts_(graph.operations().size()),
        units_(starts_.size(), 0),
        last_(starts_.size(), -1),
        by_urgency_(starts_.size()),
        rank_(starts_.size()),
        waiting_(static_cast<std::uint32_t>(starts_.size())),
        incoming_(starts_.size()),
        outgoing_(starts_.size()) {
    if (height_.size() != starts_.size()) return;
    std::iota(by_urgency_.begin(), by_urgency_.end(), 0U);
    std::ranges::stable_sort(by_urgency_, [&](std::uint32_t a, std::uint32_t b) {
      const bool long_a = order == Order::kLongFirst && graph.operations()[a].occupancy > 1;
      const bool long_b = order == Order::kLongFirst && graph.operations()[b].occupancy > 1;
      return long_a != long_b ? long_a : height_[a] > height_[b];
    });
    for (std::uint32_t rank = 0; rank < rank_.size(); ++rank) {
      rank_[by_urgency_[rank]] = rank;
      waiting_.set(rank, true);
    }
    for (std::size_t p = 0; p < kPools; ++p) {
      const std::uint32_t units = pool_size(static_cast<Pool>(p), config.array);
      table_[p].assign(std::size_t{units} * ii, kNone);
      busy_[p].assign(units, BitVector(ii));
    }
    for (const Dependence& d : graph.dependences()) {
      incoming_[d.to].push_back(d);
      outgoing_[d.from].push_back(d);
    }
  }

  /// Places all operations of the kernel. Returns false if some are unplaced after `tries_per_operation` placements per
  /// operation.
  bool place_all_operations(std::size_t tries_per_operation) {
    if (height_.size() != starts_.size()) return false;
    for (; tried_ < tries_per_operation * starts_.size(); ++tried_) {
      const std::uint32_t op = most_urgent_operation();
      if (op == kNone) return true;
      place_operation(op);
    }
    return most_urgent_operation() == kNone;
  }
  std::size_t placements_tried() const { return tried_; }
  std::uint32_t initiation_interval() const { return ii_; }
  std::int64_t start_of(std::uint32_t op) const { return *starts_[op]; }
  std::uint32_t unit_of(std::uint32_t op) const { return units_[op]; }

 private:
  std::uint32_t most_urgent_operation() const {
    const std::uint32_t rank = waiting_.find_first(0, waiting_.size(), true);
    return rank < waiting_.size() ? by_urgency_[rank] : kNone;
  }

  std::uint32_t& table_entry(std::uint32_t op, std::uint32_t unit, std::int64_t cycle) {
    return reservation_table_of(op)[std::size_t{unit} * ii_ + row_of(cycle)];
  }
  std::vector<std::uint32_t>& reservation_table_of(std::uint32_t op) {
    return table_[static_cast<std::size_t>(pool_of(graph_.operations()[op].kind))];
  }
  std::uint32_t row_of(std::int64_t cycle) const { return static_cast<std::uint32_t>(cycle % ii_); }

  std::vector<BitVector>& busy_rows(std::uint32_t op) {
    return busy_[static_cast<std::size_t>(pool_of(graph_.operations()[op].kind))];
  }

  /// Places an operation in the first cycle in which a unit is free. Of several free units, it takes the least capable
  /// one.
  void place_operation(std::uint32_t op) {
    const std::int64_t earliest = earliest_start(op);
    const Operation& operation = graph_.operations()[op];
    const std::uint32_t units = capable_units(operation.kind, config_.array), row = row_of(earliest);
    const std::vector<BitVector>& rows = busy_rows(op);
    std::uint32_t wait = ii_, best = 0;
    for (std::uint32_t unit = units; unit-- > 0 && wait > 0;) {
      const std::uint32_t here = rows_until_gap(rows[unit], row, operation.occupancy, wait);
      if (here < wait) best = unit;
      wait = here;
    }
    if (wait < ii_) return place_at(op, best, earliest + wait);
    const std::int64_t start = std::max(earliest, last_[op] + 1);
    place_at(op, least_urgent_unit(op, units, start), start);
  }

  std::int64_t earliest_start(std::uint32_t op) const {
    std::int64_t earliest = 0;
    for (const Dependence& d : incoming_[op]) {
      if (d.from != op && starts_[d.from]) earliest = std::max(earliest, earliest_start_after(d));
    }
    return earliest;
  }
  std::int64_t earliest_start_after(const Dependence& dependence) const {
    return *starts_[dependence.from] + graph_.operations()[dependence.from].latency - std::int64_t{dependence.after} -
           std::int64_t{dependence.distance} * ii_;
  }

  /// Returns the unit on which operation `op`, if started at cycle `start`, would displace the least urgent operations.
  /// The search leaves a unit as soon as it is worse than the best unit so far.
  std::uint32_t least_urgent_unit(std::uint32_t op, std::uint32_t unit_count, std::int64_t start) {
    const std::uint32_t occupancy = graph_.operations()[op].occupancy, first = row_of(start);
    const std::vector<BitVector>& rows = busy_rows(op);
    const std::uint32_t* slots = reservation_table_of(op).data() + std::size_t{unit_count} * ii_;
    std::uint32_t best = unit_count - 1;
    std::int64_t least = std::numeric_limits<std::int64_t>::max();
    for (std::uint32_t unit = unit_count; unit-- > 0 && least > 0;) {
      slots -= ii_;
      std::int64_t urgency = 0;
      for (std::uint32_t c = rows_until(rows[unit], first, true); c < occupancy && urgency < least;
           c += 1 + rows_until(rows[unit], first + c + 1, true)) {
        urgency = std::max(urgency, height_[slots[first + c < ii_ ? first + c : first + c - ii_]]);
      }
      if (urgency >= least) continue;
      least = urgency;
      best = unit;
    }
    return best;
  }

  /// Places an operation on a unit at cycle `start`. Displaces operations that overlap it or use its result too early.
  void place_at(std::uint32_t op, std::uint32_t unit, std::int64_t start) {
    const Operation& operation = graph_.operations()[op];
    for (std::uint32_t c = 0; c < operation.occupancy; ++c) {
      const std::uint32_t other = table_entry(op, unit, start + c);
      if (other != kNone) evict_operation(other);
      table_entry(op, unit, start + c) = op;
      busy_rows(op)[unit].set(row_of(start + c), true);
    }
    starts_[op] = start;
    waiting_.set(rank_[op], false);
    units_[op] = unit;
    last_[op] = start;
    for (const Dependence& d : outgoing_[op]) {
      if (d.to != op && starts_[d.to] && *starts_[d.to] < earliest_start_after(d)) evict_operation(d.to);
    }
  }

  void evict_operation(std::uint32_t op) {
    for (std::uint32_t c = 0; c < graph_.operations()[op].occupancy; ++c) {
      table_entry(op, units_[op], *starts_[op] + c) = kNone;
      busy_rows(op)[units_[op]].set(row_of(*starts_[op] + c), false);
    }
    starts_[op].reset();
    waiting_.set(rank_[op], true);
  }

  const ScheduleGraph& graph_;
  const SrpConfig& config_;
  const std::uint32_t ii_;
  std::vector<std::int64_t> height_;
  std::vector<std::optional<std::int64_t>> starts_;
  std::vector<std::uint32_t> units_;
  std::vector<std::int64_t> last_;  ///< start cycle of each operation's last placement; -1: not placed yet
  std::vector<std::uint32_t> by_urgency_,
      rank_;               ///< operations, most urgent first; position of each operation in that order
  BitVector waiting_;      ///< positions in `by_urgency_` of the operations that are not placed
  std::size_t tried_ = 0;  ///< number of placements tried by the scheduler so far
  std::vector<std::vector<Dependence>> incoming_, outgoing_;
  std::array<std::vector<std::uint32_t>, kPools> table_;  ///< reservation table of each pool: the operation at entry
                                                          ///< unit * ii + row
  std::array<std::vector<BitVector>, kPools> busy_;       ///< occupied rows of each unit in the reservation tables
};

/// Tries initiation intervals upwards from `bound`, each with both placement orders, until all operations are placed.
/// The interval grows by 1, and after kQuick placements by larger steps.
std::unique_ptr<Placer> place_at_smallest_interval(const ScheduleGraph& graph, const SrpConfig& config,
                                                   std::uint32_t bound) {
  std::size_t tried = 0;
  std::uint32_t step = 1;
  for (std::uint32_t ii = bound;; ii += step) {
    for (const Order order : {Order::kByHeight, Order::kLongFirst}) {
      if (order == Order::kLongFirst &&
          !std::ranges::any_of(graph.operations(), [](const Operation& op) { return op.occupancy > 1; }))
        continue;
      auto placer = std::make_unique<Placer>(graph, config, ii, order);
      if (placer->place_all_operations(tried > kQuick ? kLessPatience : kPatience)) return placer;
      tried += placer->placements_tried();
    }
    if (tried > kQuick) ++step;
  }
}

void count_events(const kernels::Graph& graph, const ScheduleGraph& parts, KernelSchedule& counted) {
  for (const Operation& op : parts.operations()) counted.ops[static_cast<std::size_t>(op.kind)] += 1;
  counted.local_reads = counted.ops[static_cast<std::size_t>(OpClass::kLocalRead)];
  counted.local_writes = counted.ops[static_cast<std::size_t>(OpClass::kLocalWrite)];
  const auto made = [&](std::uint32_t id) {
    const GraphNode& node = graph.nodes[id];
    return node.op != Op::kConstant && (node.op != Op::kInput || node.inputs[0] != kNone);
  };
  for (std::uint32_t id = 0; id < graph.nodes.size(); ++id) {
    const GraphNode& node = graph.nodes[id];
    const OpClass kind = op_class_of(node.op);
    if (kind == OpClass::kFree) continue;
    kernels::for_each_input(node, [&](std::uint32_t input) {
      if (parts.is_fused(input)) return;
      counted.rf_reads += 1;
      counted.route_hops += made(input) ? 1 : 0;
    });
    if (parts.is_fused(id)) continue;
    const bool store = kind == OpClass::kLocalWrite;
    if (!is_memory_class(kind)) counted.fu_ops += 1;
    if (kind == OpClass::kCachedRead) counted.cached_loads += 1;
    counted.rf_writes += is_memory_class(kind) ? (store ? 0 : node.bytes / 4) : 1;
  }
}

}  // namespace

KernelSchedule schedule_kernel(const kernels::Graph& graph, const SrpConfig& config) {
  const ScheduleGraph parts(graph, config);
  KernelSchedule s;
  s.kernel = graph.kernel;
  count_events(graph, parts, s);
  s.res_mii = resource_interval(parts.operations(), config.array);
  s.rec_mii = parts.recurrence_interval();
  const auto placed = place_at_smallest_interval(parts, config, std::max({1U, s.res_mii, s.rec_mii}));
  s.ii = placed->initiation_interval();
  const auto operations = static_cast<std::uint32_t>(parts.operations().size());
  std::int64_t first = operations == 0 ? 0 : placed->start_of(0);
  for (std::uint32_t op = 0; op < operations; ++op) first = std::min(first, placed->start_of(op));
  for (std::uint32_t op = 0; op < operations; ++op) {
    const Operation& operation = parts.operations()[op];
    const auto start = static_cast<std::uint32_t>(placed->start_of(op) - first);
    s.placements.push_back({operation.node, operation.part, start, placed->unit_of(op)});
    s.depth = std::max(s.depth, start + operation.latency);
  }
  s.config_reads = s.ii * config.array.unit_count();
  if (config.latency.load_queue > 0) s.queued_loads = s.ops[static_cast<std::size_t>(OpClass::kCachedRead)];
  return s;
}

using kernels::GraphNode;
using kernels::Op;

namespace {

/// A local memory access that every item of a loop makes. `slot`: cycle of the access within the initiation interval.
/// `behind`: number of younger items that have started before the access.
struct LocalAccess {
  std::uint32_t slot = 0, behind = 0;
  std::uint32_t words = 1;  ///< length of the accessed record in 16-byte words
  std::uint32_t part = 0;   ///< bank of the accessed word if the record's index is 0 (modulo the number of banks)
  bool constant = false;
  std::uint32_t index = 0;  ///< index of the accessed record, if it is constant
};

bool is_local(const GraphNode& node) { return node.op == Op::kLoadLocal || node.op == Op::kStoreLocal; }
std::uint32_t word_count_of(const GraphNode& node) { return std::max(1U, (node.bytes + kPortBytes - 1) / kPortBytes); }

std::vector<LocalAccess> accesses_of(const KernelSchedule& schedule, const kernels::Graph& graph) {
  std::map<std::string, std::uint32_t> begins;  // first bank of each array
  std::uint32_t end = 0;
  for (const GraphNode& node : graph.nodes) {
    if (!is_local(node) || !begins.emplace(node.label, end).second) continue;
    end += word_count_of(node);
  }
  std::vector<LocalAccess> accesses;
  for (const Placement& p : schedule.placements) {
    const GraphNode& node = graph.nodes[p.node];
    if (!is_local(node)) continue;
    LocalAccess a{p.start % schedule.ii, p.start / schedule.ii, word_count_of(node), begins.at(node.label) + p.part};
    if (node.inputs[0] != GraphNode::kNone && graph.nodes[node.inputs[0]].op == Op::kConstant) {
      a.constant = true;
      a.index = graph.nodes[node.inputs[0]].value;
    }
    accesses.push_back(a);
  }
  return accesses;
}

}  // namespace

BankConflicts bank_conflicts(const KernelSchedule& schedule, const kernels::Graph& graph, std::uint32_t bank_count) {
  const std::vector<LocalAccess> accesses = accesses_of(schedule, graph);
  BankConflicts conflicts{0, bank_count};
  std::vector<std::uint32_t> used(bank_count);
  for (std::uint32_t item = 0; item < bank_count; ++item) {  // the conflicts repeat every `bank_count` items
    for (std::uint32_t slot = 0; slot < schedule.ii; ++slot) {
      std::ranges::fill(used, 0);
      std::uint32_t most = 0;
      for (const LocalAccess& a : accesses) {
        if (a.slot != slot) continue;
        // A negative difference wraps modulo 2^32, which is a multiple of `bank_count`.
        const std::uint32_t record = a.constant ? a.index : item - a.behind;
        most = std::max(most, ++used[(record * a.words + a.part) % bank_count]);
      }
      conflicts.cycles += most > 1 ? most - 1 : 0;
    }
  }
  return conflicts;
}

}  // namespace hw
