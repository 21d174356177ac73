#pragma once
#include <cstdint>
#include <string>

#include "sim/config/field.h"
#include "sim/named.h"

namespace hw {

/// Configuration of the path of rays and hits between shader core and T&I unit: the direct interface, or the path
/// through memory that replaces it.
struct DirectInterfaceConfig {
  bool enabled = true;
  std::uint32_t depth = 64;
  std::uint32_t interval = 2;
  std::uint32_t ray_bytes = 64;
  std::uint32_t hit_bytes = 32;
  std::uint32_t ring = 16384;

  static void describe(auto& c, auto&& field) {
    using sim::Affects;
    field(NAMED(c.enabled), "", "off: rays and hits are written to memory and read back", sim::any(), Affects::kTiming);
    field(NAMED(c.depth), "records", "FIFO slots, each way; off: records that are read ahead, too",
          sim::between(1, 4096), Affects::kTiming);
    field(NAMED(c.interval), "cycles", "T&I cycles from one record to the next, each way", sim::between(1, 64),
          Affects::kTiming);
    field(NAMED(c.ray_bytes), "bytes", "of a ray in memory, if off", sim::between(8, 256), Affects::kTiming);
    field(NAMED(c.hit_bytes), "bytes", "of a hit in memory, if off", sim::between(8, 256), Affects::kTiming);
    field(NAMED(c.ring), "records", "room in memory for rays, and for as many hits, of each core, if off",
          sim::between(1, 65536), Affects::kTiming);
  }
  void check(auto&& complain) const {
    const auto pieces = [&](const char* key, std::uint32_t bytes) {
      if (bytes % 8 != 0)
        complain(key, "records are made of 8-byte pieces; " + std::to_string(bytes) + " is no multiple");
    };
    pieces("ray_bytes", ray_bytes);
    pieces("hit_bytes", hit_bytes);
  }
};

}  // namespace hw
