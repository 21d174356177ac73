#include "hw_models/srp/schedule.h"

#include <algorithm>
#include <array>
#include <optional>

#include "hw_models/srp/schedule_graph.h"
#include "hw_models/srp/schedule_units.h"

namespace hw {
namespace {

using kernels::GraphNode;
using kernels::Op;

constexpr std::uint32_t kNone = GraphNode::kNone;
/// Placements tried per operation before the interval is given up.
constexpr std::size_t kPatience = 32;

/// Iterative modulo scheduling at one interval. An operation that finds no free slot pushes others out of theirs.
class Placer {
 public:
  Placer(const ScheduleGraph& graph, const SrpConfig& config, std::uint32_t ii)
      : graph_(graph),
        config_(config),
        ii_(ii),
        height_(graph.heights(ii)),
        starts_(graph.operations().size()),
        units_(starts_.size(), 0),
        last_(starts_.size(), -1),
        incoming_(starts_.size()),
        outgoing_(starts_.size()) {
    for (std::size_t p = 0; p < kPools; ++p) {
      table_[p].assign(std::size_t{pool_size(static_cast<Pool>(p), config.array)} * ii, kNone);
    }
    for (const Dependence& d : graph.dependences()) {
      incoming_[d.to].push_back(d);
      outgoing_[d.from].push_back(d);
    }
  }

  /// True if every operation has found a slot.
  bool place_all() {
    if (height_.size() != starts_.size()) return false;
    for (std::size_t budget = kPatience * starts_.size(); budget > 0; --budget) {
      const std::uint32_t op = most_urgent();
      if (op == kNone) return true;
      place(op);
    }
    return most_urgent() == kNone;
  }
  std::int64_t start(std::uint32_t op) const { return *starts_[op]; }
  std::uint32_t unit(std::uint32_t op) const { return units_[op]; }

 private:
  std::uint32_t most_urgent() const {
    std::uint32_t best = kNone;
    for (std::uint32_t op = 0; op < starts_.size(); ++op) {
      if (!starts_[op] && (best == kNone || height_[op] > height_[best])) best = op;
    }
    return best;
  }

  std::uint32_t& slot(std::uint32_t op, std::uint32_t unit, std::int64_t cycle) {
    const Pool pool = pool_of(graph_.operations()[op].kind);
    return table_[static_cast<std::size_t>(pool)][std::size_t{unit} * ii_ + static_cast<std::size_t>(cycle) % ii_];
  }

  bool free(std::uint32_t op, std::uint32_t unit, std::int64_t start) {
    for (std::uint32_t c = 0; c < graph_.operations()[op].occupancy; ++c) {
      if (slot(op, unit, start + c) != kNone) return false;
    }
    return true;
  }

  void place(std::uint32_t op) {
    const std::int64_t earliest = earliest_start(op);
    // The units that can do least are asked first.
    const std::uint32_t units = capable_units(graph_.operations()[op].kind, config_.array);
    for (std::int64_t start = earliest; start < earliest + ii_; ++start) {
      for (std::uint32_t unit = units; unit-- > 0;) {
        if (free(op, unit, start)) return settle(op, unit, start);
      }
    }
    const std::int64_t start = std::max(earliest, last_[op] + 1);
    settle(op, least_urgent_unit(op, units, start), start);
  }

  std::int64_t earliest_start(std::uint32_t op) const {
    std::int64_t earliest = 0;
    for (const Dependence& d : incoming_[op]) {
      if (d.from != op && starts_[d.from]) earliest = std::max(earliest, ready(d));
    }
    return earliest;
  }
  std::int64_t ready(const Dependence& d) const {
    return *starts_[d.from] + graph_.operations()[d.from].latency - std::int64_t{d.distance} * ii_;
  }

  std::uint32_t least_urgent_unit(std::uint32_t op, std::uint32_t units, std::int64_t start) {
    std::uint32_t best = units - 1;
    std::optional<std::int64_t> least;
    for (std::uint32_t unit = units; unit-- > 0;) {
      std::int64_t urgency = 0;
      for (std::uint32_t c = 0; c < graph_.operations()[op].occupancy; ++c) {
        const std::uint32_t other = slot(op, unit, start + c);
        if (other != kNone) urgency = std::max(urgency, height_[other]);
      }
      if (least && urgency >= *least) continue;
      least = urgency;
      best = unit;
    }
    return best;
  }

  /// Takes the slot and pushes out every operation that holds it or would now use a result too early.
  void settle(std::uint32_t op, std::uint32_t unit, std::int64_t start) {
    const Operation& operation = graph_.operations()[op];
    for (std::uint32_t c = 0; c < operation.occupancy; ++c) {
      const std::uint32_t other = slot(op, unit, start + c);
      if (other != kNone) push_out(other);
      slot(op, unit, start + c) = op;
    }
    starts_[op] = start;
    units_[op] = unit;
    last_[op] = start;
    for (const Dependence& d : outgoing_[op]) {
      if (d.to != op && starts_[d.to] && *starts_[d.to] < ready(d)) push_out(d.to);
    }
  }

  void push_out(std::uint32_t op) {
    for (std::uint32_t c = 0; c < graph_.operations()[op].occupancy; ++c) {
      slot(op, units_[op], *starts_[op] + c) = kNone;
    }
    starts_[op].reset();
  }

  const ScheduleGraph& graph_;
  const SrpConfig& config_;
  const std::uint32_t ii_;
  std::vector<std::int64_t> height_;
  std::vector<std::optional<std::int64_t>> starts_;
  std::vector<std::uint32_t> units_;
  std::vector<std::int64_t> last_;  ///< start when last placed
  std::vector<std::vector<Dependence>> incoming_, outgoing_;
  std::array<std::vector<std::uint32_t>, kPools> table_;  ///< reservation table: the operation at unit * ii + row
};

void count(const kernels::Graph& graph, const ScheduleGraph& parts, KernelSchedule& s) {
  for (const Operation& op : parts.operations()) s.ops[static_cast<std::size_t>(op.kind)] += 1;
  s.local_reads = s.ops[static_cast<std::size_t>(OpClass::kLocalRead)];
  s.local_writes = s.ops[static_cast<std::size_t>(OpClass::kLocalWrite)];
  const auto made = [&](std::uint32_t id) {
    const GraphNode& node = graph.nodes[id];
    return node.op != Op::kConstant && (node.op != Op::kInput || node.inputs[0] != kNone);
  };
  for (const GraphNode& node : graph.nodes) {
    const OpClass kind = class_of(node.op);
    if (kind == OpClass::kFree) continue;
    kernels::for_each_input(node, [&](std::uint32_t input) {
      s.rf_reads += 1;
      s.route_hops += made(input) ? 1 : 0;
    });
    const bool store = kind == OpClass::kLocalWrite;
    if (!is_memory(kind)) s.fu_ops += 1;
    if (kind == OpClass::kCachedRead) s.cached_loads += 1;
    s.rf_writes += is_memory(kind) ? (store ? 0 : node.bytes / 4) : 1;
  }
}

}  // namespace

KernelSchedule schedule(const kernels::Graph& graph, const SrpConfig& config) {
  const ScheduleGraph parts(graph, config.latency);
  KernelSchedule s;
  s.kernel = graph.kernel;
  count(graph, parts, s);
  s.res_mii = resource_interval(parts.operations(), config.array);
  s.rec_mii = parts.recurrence_interval();
  for (s.ii = std::max({1U, s.res_mii, s.rec_mii});; ++s.ii) {
    Placer placer(parts, config, s.ii);
    if (!placer.place_all()) continue;
    const auto operations = static_cast<std::uint32_t>(parts.operations().size());
    std::int64_t first = operations == 0 ? 0 : placer.start(0);
    for (std::uint32_t op = 0; op < operations; ++op) first = std::min(first, placer.start(op));
    for (std::uint32_t op = 0; op < operations; ++op) {
      const Operation& operation = parts.operations()[op];
      const auto start = static_cast<std::uint32_t>(placer.start(op) - first);
      s.placements.push_back({operation.node, operation.part, start, placer.unit(op)});
      s.depth = std::max(s.depth, start + operation.latency);
    }
    break;
  }
  s.config_reads = s.ii * config.array.units();
  return s;
}

}  // namespace hw
