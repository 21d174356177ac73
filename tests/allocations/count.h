#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace test {

/// False under sanitizers, which replace the heap: nothing is counted there.
bool can_count_allocations();

/// Counts the allocations of the whole process from start() until its destruction: every malloc, calloc, realloc and
/// aligned variant, so also operator new. Only one may exist at a time.
class CountAllocations {
 public:
  CountAllocations();
  ~CountAllocations();
  CountAllocations(const CountAllocations&) = delete;
  CountAllocations& operator=(const CountAllocations&) = delete;

  void start();
  void stop();
  /// Continues counting in another group, to separate callers; the first group is 0.
  void group(int number);

  std::uint64_t count(int number) const;
  /// Returns the call stacks of the first thousands of allocations of a group, one per line. Those through a function
  /// whose name contains one of `known` are omitted.
  std::string sites(int number, const std::vector<std::string>& known = {}) const;
};

}  // namespace test
