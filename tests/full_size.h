#pragma once
#include <cstdlib>

namespace test {

/// True if tests run all their scenes, machines and seeds ($RAYWATT_FULL, set by `tools/validate full`) and not a few.
inline bool is_full_size() { return std::getenv("RAYWATT_FULL") != nullptr; }

/// Returns `full` at full size, otherwise `few`.
template <class T>
T full_or(T full, T few) {
  return is_full_size() ? full : few;
}

}  // namespace test
