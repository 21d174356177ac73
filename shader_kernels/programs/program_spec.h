#pragma once
#include <cstdint>
#include <string>
#include <string_view>

namespace kernels {

/// A frame program as the user names it.
struct ProgramSpec {
  enum class Kind : std::uint8_t { kFull };
  Kind kind = Kind::kFull;
  std::uint32_t samples = 1;  ///< full: per pixel, a square
  std::string name() const { return "full:" + std::to_string(samples); }
};

/// "full:4"; "full" alone means full:1. Throws sim::InputError that lists what there is.
ProgramSpec parse_program(std::string_view text);

}  // namespace kernels
