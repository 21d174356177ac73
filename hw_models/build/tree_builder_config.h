#pragma once
#include <bit>
#include <cstdint>
#include <string>
#include <vector>

#include "hw_models/memory/cache_config.h"
#include "hw_models/srp/srp_config.h"
#include "sim/config/field.h"
#include "sim/named.h"
#include "sim/unit_report.h"

namespace hw {

/// Configuration of the tree builder.
struct TreeBuilderConfig {
  std::uint32_t clocks = 12;
  std::uint32_t merge_interval = 1;
  std::uint32_t run = 2048;
  std::uint32_t ways = 128;
  std::uint32_t record_bytes = 8;
  DataCacheConfig buffer{{.size = {8 * 1024}, .mshrs = 16}};
  std::uint32_t lookups = 2;
  std::uint32_t window = 32;
  std::uint32_t write_buffer = 8;
  std::uint32_t comparators = 0;
  std::uint32_t invalidate = 16;

  static void describe(auto& c, auto&& field) {
    using sim::Affects;
    field(NAMED(c.clocks), "cycles",
          "cycles per triangle of a build without intermediate merges; half of them for a refit", sim::between(2, 1024),
          Affects::kTiming);
    field(NAMED(c.merge_interval), "cycles", "cycles per record of an intermediate merge", sim::between(1, 1024),
          Affects::kTiming);
    field(NAMED(c.run), "triangles", "triangles sorted on chip into a run", sim::between(1, 1 << 20), Affects::kTiming);
    field(NAMED(c.ways), "runs", "runs merged at the same time", sim::between(2, 4096), Affects::kTiming);
    field(NAMED(c.record_bytes), "bytes",
          "bytes of a sorted record: 8 for key and number, 12 with keys of 63 bits, 24 more with the triangle's box",
          sim::between(8, 36), Affects::kTiming);
    field.group(NAMED(c.buffer), "input buffer of vertices, vertex numbers and nodes");
    field(NAMED(c.lookups), "lines", "lines looked up in the input buffer per cycle", sim::between(1, 8),
          Affects::kTiming);
    field(NAMED(c.window), "triangles", "triangles whose lines are fetched at the same time", sim::between(1, 64),
          Affects::kTiming);
    field(NAMED(c.write_buffer), "lines", "lines of each output that wait to be written", sim::between(2, 256),
          Affects::kTiming);
    field(NAMED(c.comparators), "",
          "clusters of PLOC compared per cycle (bvh.builder: ploc); 0: the unit builds no trees of PLOC",
          sim::between(0, 1024), Affects::kTiming);
    field(NAMED(c.invalidate), "cycles", "cycles to invalidate all first-level caches after a tree",
          sim::between(1, 1024), Affects::kTiming);
  }
  void check(auto&& complain) const {
    buffer.check(
        [&](const char* key, const std::string& what) { complain((std::string("buffer.") + key).c_str(), what); });
    if (record_bytes != 8 && record_bytes != 12 && record_bytes != 32 && record_bytes != 36) {
      complain("record_bytes", "is " + std::to_string(record_bytes) + "; allowed: 8, 12, 32, 36");
    }
  }

  /// Returns the words of 8 bytes that a sorted record takes on chip.
  std::uint32_t record_words() const { return (record_bytes + 7) / 8; }
  /// Returns the levels of the tournament that merges runs.
  std::uint32_t merge_levels() const { return static_cast<std::uint32_t>(std::bit_width(ways - 1)); }

  /// Returns the parts of the tree builder whose number is configurable, for its area.
  std::vector<sim::UnitPart> parts() const { return {{"comparator", comparators}}; }
  /// Returns the bytes of on-chip storage: the run being sorted, a line of each merged run, input and write buffers.
  std::uint64_t sram_bytes() const {
    return std::uint64_t{run} * record_bytes + std::uint64_t{ways} * kLineBytes + buffer.size.bytes +
           3 * std::uint64_t{write_buffer} * kLineBytes;
  }
};

}  // namespace hw
