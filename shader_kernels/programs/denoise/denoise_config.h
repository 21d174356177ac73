#pragma once
#include <array>
#include <cstdint>
#include <string_view>

#include "sim/config/field.h"
#include "sim/named.h"

namespace kernels {

/// What filters a frame's noise: nothing, the a-trous kernels, or a unit that is not modelled.
enum class DenoiseFilter : std::uint8_t { kOff, kAtrous, kExternal };
constexpr std::array<std::string_view, 3> names_of(DenoiseFilter) { return {"off", "atrous", "external"}; }

enum class HistoryPrecision : std::uint8_t { kHalf, kFloat };
constexpr std::array<std::string_view, 2> names_of(HistoryPrecision) { return {"half", "float"}; }

/// Keys of the denoiser. The keys `external_...` are the costs of a unit outside the model.
struct DenoiseConfig {
  DenoiseFilter filter = DenoiseFilter::kOff;
  std::uint32_t iterations = 4;
  HistoryPrecision history = HistoryPrecision::kHalf;
  double alpha = 0.05, moments_alpha = 0.2;
  std::uint32_t history_cap = 32;
  double phi_colour = 4, phi_normal = 128, phi_depth = 1;
  double depth_tolerance = 0.05, normal_tolerance = 0.9;
  double external_time = 2.6, external_bytes = 13.6, external_energy = 2950;
  double external_upscaling = 1;

  bool has_kernels() const { return filter == DenoiseFilter::kAtrous; }

  static void describe(auto& c, auto&& field) {
    using sim::Affects;
    field(NAMED(c.filter), "",
          "denoiser after the frame: none, kernels (temporal accumulation, a-trous filter), or an external unit of "
          "given costs that leaves the picture as it is",
          sim::any(), Affects::kFunction);
    field(NAMED(c.iterations), "", "iterations of the a-trous filter; 0: temporal accumulation only",
          sim::between(0, 5), Affects::kFunction);
    field(NAMED(c.history), "", "precision of light and its moments in memory: 20 (half) or 32 bytes a pixel",
          sim::any(), Affects::kFunction);
    field(NAMED(c.alpha), "", "least weight of a frame's light in its history", sim::between(0, 1), Affects::kFunction);
    field(NAMED(c.moments_alpha), "", "least weight of a frame in the moments of luminance", sim::between(0, 1),
          Affects::kFunction);
    field(NAMED(c.history_cap), "frames", "length from which a history grows no longer", sim::between(1, 255),
          Affects::kFunction);
    field(NAMED(c.phi_colour), "", "luminance difference, in standard deviations, at which a weight falls to 1/e",
          sim::between(0.01, 1000), Affects::kFunction);
    field(NAMED(c.phi_normal), "", "exponent of the normals' dot product", sim::between(0, 1000), Affects::kFunction);
    field(NAMED(c.phi_depth), "", "depth difference, in differences of a plane, at which a weight falls to 1/e",
          sim::between(0.01, 1000), Affects::kFunction);
    field(NAMED(c.depth_tolerance), "", "largest relative difference of depth between a pixel and its history",
          sim::between(0, 1), Affects::kFunction);
    field(NAMED(c.normal_tolerance), "", "least dot product of normals of a pixel and its history", sim::between(-1, 1),
          Affects::kFunction);
    field(NAMED(c.external_time), "ns", "time of the external unit per output pixel, after the frame",
          sim::between(0, 1e6), Affects::kEnergy);
    field(NAMED(c.external_bytes), "bytes", "DRAM traffic of the external unit per output pixel", sim::between(0, 1e6),
          Affects::kEnergy);
    field(NAMED(c.external_energy), "pJ", "energy of the external unit per output pixel, with its DRAM traffic",
          sim::between(0, 1e9), Affects::kEnergy);
    field(NAMED(c.external_upscaling), "", "pixels of the external unit's output for one of the frame, along each side",
          sim::between(1, 16), Affects::kEnergy);
  }
};

}  // namespace kernels
