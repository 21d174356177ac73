#include "hw_models/tni/timing_wheel.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "sim/hash.h"

namespace hw::test {
namespace {

TEST(TimingWheel, EachSlotCompletesALatencyLaterInItsPipe) {
  const sim::Clock clock(3);
  for (const std::uint64_t longest : {1U, 2U, 13U, 63U}) {
    TimingWheel<4> wheel(clock, longest);
    struct Inside {
      std::uint64_t at;
      std::uint32_t slot;
      std::size_t way;
    };
    std::vector<Inside> inside;
    for (std::uint64_t number = 1000; number < 3000; ++number) {
      const Cycle cycle(number * clock.period(), clock);
      TimingWheel<4>::Masks expected{}, waiting{};
      std::erase_if(inside, [&](const Inside& one) {
        if (one.at == number) expected[one.way] |= slot_bit(one.slot);
        return one.at == number;
      });
      expected[1] |= waiting[1] = slot_bit(5);  // slots that wait already keep waiting
      wheel.take_completed(number, waiting);
      ASSERT_EQ(waiting, expected) << number;
      for (std::uint64_t some = sim::hash(longest, number) % 3; some > 0; --some) {
        const std::uint64_t latency = 1 + sim::hash(number, some, 1) % longest;
        const auto slot = static_cast<std::uint32_t>(sim::hash(number, some, 2) % 64);
        const std::size_t way = sim::hash(number, some, 3) % 4;
        wheel.schedule_completion(way, slot, number, latency);
        inside.push_back({number + latency, slot, way});
      }
      sim::Time next = sim::kNever;
      for (const Inside& one : inside) next = std::min(next, one.at * clock.period());
      ASSERT_EQ(wheel.next_completion(cycle), next) << number;
      ASSERT_EQ(wheel.completion_bit_at(number + 1) != 0, next == cycle.next) << number;
    }
  }
}

}  // namespace
}  // namespace hw::test
