#pragma once
#include <cstdlib>

namespace test {

/// True if tests use all scenes, machines and seeds, not a few. Set by `tools/validate full` ($RAYWATT_FULL).
inline bool is_full_size() { return std::getenv("RAYWATT_FULL") != nullptr; }

/// Returns `full` if is_full_size(), otherwise `few`.
template <class T>
T full_or(T full, T few) {
  return is_full_size() ? full : few;
}

}  // namespace test
