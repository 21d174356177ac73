#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace kernels {

/// A frame program and its number of samples, as the user names it.
struct ProgramSpec {
  enum class Kind : std::uint8_t { kFull, kMultirate, kUndersample, kSupersample, kReconstruct, kSraa, kPath };
  Kind kind = Kind::kFull;
  std::uint32_t samples = 1;  ///< samples per pixel, a square number; used by full, path and multirate
  /// True if no tile needs results of other tiles.
  bool has_independent_tiles() const { return kind == Kind::kFull || kind == Kind::kPath; }
  std::string name() const;
};

/// Parses the name of a frame program, such as "full:4" or "multirate:under". Throws
/// sim::InputError with the allowed programs.
ProgramSpec parse_program(std::string_view text);

/// Returns the program names that parse_program() accepts.
std::vector<std::string> program_names();

}  // namespace kernels
