#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace test {

/// True if this build can count heap allocations. False with sanitizers, which replace the heap.
bool can_count_allocations();

/// Counts all heap allocations of the process, by malloc or by operator new, from start() until the destructor. Only
/// one object may exist at a time.
class CountAllocations {
 public:
  CountAllocations();
  ~CountAllocations();
  CountAllocations(const CountAllocations&) = delete;
  CountAllocations& operator=(const CountAllocations&) = delete;

  void start();
  void stop();
  /// Counts further allocations in group `number`, so that phases of a test are separate. Counting begins in group 0.
  void group(int number);

  std::uint64_t count(int number) const;
  /// Returns the call stacks of the group's first few thousand allocations, one per line. Stacks with a function whose
  /// name contains one of `known` are omitted.
  std::string sites(int number, const std::vector<std::string>& known = {}) const;
};

}  // namespace test
