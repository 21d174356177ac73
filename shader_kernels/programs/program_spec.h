#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace kernels {

/// A frame program as the user names it.
struct ProgramSpec {
  enum class Kind : std::uint8_t { kFull, kMultirate, kUndersample, kSupersample, kReconstruct, kSraa };
  Kind kind = Kind::kFull;
  std::uint32_t samples = 1;  ///< per pixel, a square; full, multirate
  std::string name() const;
};

/// "full:4", "multirate:under"; "full" alone means full:1. Throws sim::InputError that lists what there is.
ProgramSpec parse_program(std::string_view text);

/// Names that parse_program() knows.
std::vector<std::string> program_names();

}  // namespace kernels
