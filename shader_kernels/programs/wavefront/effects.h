#pragma once
#include <array>
#include <cstdint>
#include <string_view>

namespace kernels {

/// Effects that cast rays from the surfaces of first and later hits (docs/design/effects.md).
enum class Effect : std::uint8_t { kShadows, kReflections, kRefractions, kOcclusion, kSoftShadows, kCount };
constexpr std::array<std::string_view, static_cast<std::size_t>(Effect::kCount)> names_of(Effect) {
  return {"shadows", "reflections", "refractions", "occlusion", "soft_shadows"};
}

class Effects {
 public:
  bool has(Effect effect) const { return (bits_ >> static_cast<std::uint32_t>(effect) & 1U) != 0; }
  void add(Effect effect) { bits_ |= 1U << static_cast<std::uint32_t>(effect); }

 private:
  std::uint32_t bits_ = 0;
};

/// Parses "shadows, occlusion" or "none". Throws sim::InputError with the allowed effects.
Effects parse_effects(std::string_view text);

}  // namespace kernels
