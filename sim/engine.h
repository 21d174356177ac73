#pragma once
#include <algorithm>
#include <cstdint>
#include <numeric>
#include <string>
#include <vector>

#include "sim/error.h"
#include "sim/hash.h"
#include "sim/time.h"
#include "sim/wakes.h"

namespace sim {

enum class Skip : std::uint8_t {
  kOn,   ///< jump to the next time at which some unit has something to do
  kOff,  ///< visit every clock edge of every unit: slow, and the oracle that kOn must equal to the last counter
};

/// The units of a machine by their places, each to be ticked through a plain function of its own kind.
class Ticks {
 public:
  template <class Machine>
  Ticks(Machine& machine, std::size_t units) : units_(units) {
    machine.each_unit([&]<class U>(U& unit, std::size_t i) {
      units_[i] = {&unit, [](void* of, Time now) { return static_cast<U*>(of)->tick(now); }};
    });
  }
  Time operator()(std::size_t i, Time now) const { return units_[i].tick(units_[i].unit, now); }

 private:
  struct Unit {
    void* unit = nullptr;
    Time (*tick)(void*, Time) = nullptr;
  };
  std::vector<Unit> units_;
};

/// A machine, as the engine sees it:
///   each_unit(f)   calls f(unit, index) for every unit; unit.tick(now) returns its next own wake-up time,
///                  unit.clock() its clock domain
///   wakes()        the units' wake-up times, which links lower
///   done()         all work has left the machine
///   state()        a line per unit, for a stuck machine
///
/// Runs until done and returns the time of the last visited edge.
template <Skip kSkip = Skip::kOn, class Machine>
Time run(Machine& machine) {
  Wakes& wakes = machine.wakes();
  const Ticks ticks(machine, wakes.size());
  Time now = 0;
  const auto tick = [&](std::size_t i) { return ticks(i, now); };
  for (;;) {
    if constexpr (kSkip == Skip::kOff) {
      machine.each_unit([&](auto& unit, std::size_t i) {
        if (unit.clock().is_edge(now)) wakes.tick_one(i, tick);
      });
    } else {
      wakes.tick_due(now, tick);
    }
    if (machine.done()) return now;
    const Time next = wakes.earliest();
    if (next == kNever) throw Deadlock("the machine is stuck", machine.state());
    if constexpr (kSkip == Skip::kOff) {
      Time edge = kNever;
      machine.each_unit(
          [&](auto& unit, std::size_t) { edge = std::min(edge, unit.clock().edge_at_or_after(now + 1)); });
      now = edge;
    } else {
      now = next;
    }
  }
}

/// As run(), with the units of each step visited in an order drawn by hash from `seed`. For tests: links make the
/// order invisible, and this shows it.
template <class Machine>
Time run_shuffled(Machine& machine, std::uint64_t seed) {
  Wakes& wakes = machine.wakes();
  const Ticks ticks(machine, wakes.size());
  std::vector<std::size_t> order(wakes.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (Time now = 0;;) {
    std::ranges::sort(order, {}, [&](std::size_t i) { return hash(seed, now, i); });
    for (const std::size_t i : order) {
      if (wakes[i] == now) wakes.tick_one(i, [&](std::size_t) { return ticks(i, now); });
    }
    if (machine.done()) return now;
    now = wakes.earliest();
    if (now == kNever) throw Deadlock("the machine is stuck", machine.state());
  }
}

}  // namespace sim
