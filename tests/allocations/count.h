#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace test {

/// False where a sanitizer has the heap to itself: nothing is counted there.
bool can_count_allocations();

/// Allocations of the whole process between start() and the end of its life: every malloc, calloc, realloc and aligned
/// kin, and so every operator new. One at a time.
class CountAllocations {
 public:
  CountAllocations();
  ~CountAllocations();
  CountAllocations(const CountAllocations&) = delete;
  CountAllocations& operator=(const CountAllocations&) = delete;

  void start();
  void stop();
  /// Counts go on in another group, to tell who allocates; starts with 0.
  void group(int number);

  std::uint64_t count(int number) const;
  /// Where the first thousands of a group came from, a line each, but for those that passed through a function whose
  /// name holds one of `known`.
  std::string sites(int number, const std::vector<std::string>& known = {}) const;
};

}  // namespace test
