#pragma once
#include <cstdint>
#include <string>

#include "sim/config/field.h"
#include "sim/named.h"

namespace hw {

/// Configuration of the path of rays and hits between shader core and T&I unit: direct, or through memory.
struct DirectInterfaceConfig {
  bool enabled = true;
  std::uint32_t depth = 64;
  std::uint32_t interval = 2;
  std::uint32_t ray_bytes = 64;
  std::uint32_t hit_bytes = 32;
  std::uint32_t ring = 16384;

  static void describe(auto& c, auto&& field) {
    using sim::Affects;
    field(NAMED(c.enabled), "", "false: rays and hits are written to memory and read back", sim::any(),
          Affects::kTiming);
    field(NAMED(c.depth), "records", "FIFO slots in each direction; if disabled, also records read ahead from memory",
          sim::between(1, 4096), Affects::kTiming);
    field(NAMED(c.interval), "cycles", "T&I cycles from one ray, or hit, to the next", sim::between(1, 64),
          Affects::kTiming);
    field(NAMED(c.ray_bytes), "bytes", "bytes of a ray in memory, if disabled", sim::between(8, 256), Affects::kTiming);
    field(NAMED(c.hit_bytes), "bytes", "bytes of a hit in memory, if disabled", sim::between(8, 256), Affects::kTiming);
    field(NAMED(c.ring), "records", "rays, and hits, of each core that fit in memory, if disabled",
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
