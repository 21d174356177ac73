#pragma once
#include <array>
#include <cstdint>
#include <string_view>

#include "sim/config/field.h"
#include "sim/named.h"

namespace kernels {

/// At which hits of a path emissive surfaces add their light.
enum class PathEmission : std::uint8_t { kVisible, kAll };
constexpr std::array<std::string_view, 2> names_of(PathEmission) { return {"visible", "all"}; }

/// Configuration keys of the program path:N. All of them change the recorded work.
struct PathConfig {
  std::uint32_t roulette_start = 2;
  double roulette_least = 0.05;
  PathEmission emission = PathEmission::kVisible;

  static void describe(auto& c, auto&& field) {
    using sim::Affects;
    field(NAMED(c.roulette_start), "bounces",
          "first bounce after which a path survives only by Russian roulette, with its largest throughput as "
          "probability",
          sim::between(1, 16), Affects::kFunction);
    field(NAMED(c.roulette_least), "", "smallest probability with which a path survives Russian roulette",
          sim::between(0.001, 1), Affects::kFunction);
    field(NAMED(c.emission), "",
          "hits at which emissive surfaces add light: those seen directly or in mirrors and glass, because scenes have "
          "light sources where lamps are; or all. Scenes without light sources: all",
          sim::any(), Affects::kFunction);
  }
};

}  // namespace kernels
