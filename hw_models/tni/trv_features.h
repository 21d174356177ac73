#pragma once

namespace hw {

/// Features of a traversal unit that it asks about in every cycle.
struct TrvFeatures {
  bool instances = false;   ///< a visit may carry the ray into an instance instead
  bool plain = true;        ///< a visit is one pass that reads one line and tests two boxes in floating point
  bool one_pipe = false;    ///< passes, pops and leaves share a pipe
  bool ideal = false;       ///< any number of operations a cycle
  bool prefetches = false;  ///< far nodes are asked for ahead of need
  bool reorders = true;     ///< misses are reordered, and there are some
  bool stack = true;        ///< a ray's stack keeps at least one entry

  friend bool operator==(const TrvFeatures&, const TrvFeatures&) = default;
};

/// The features of the default machine, which Trv::tick knows while it is compiled.
inline constexpr TrvFeatures kDefaultTrvFeatures{};

}  // namespace hw
