#include "shader_kernels/programs/program_spec.h"

#include <charconv>

#include <fmt/format.h>

#include "sim/error.h"

namespace kernels {
namespace {

constexpr std::uint32_t kMaxGrid = 32;

bool is_square(std::uint32_t n) {
  for (std::uint32_t side = 1; side <= kMaxGrid; ++side) {
    if (side * side == n) return true;
  }
  return false;
}

}  // namespace

ProgramSpec parse_program(std::string_view text) {
  constexpr std::string_view kFull = "full";
  if (text == kFull) return {};
  if (text.starts_with("full:")) {
    const std::string_view number = text.substr(kFull.size() + 1);
    std::uint32_t samples = 0;
    const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), samples);
    if (error == std::errc{} && end == number.data() + number.size() && is_square(samples)) {
      return {.samples = samples};
    }
    throw sim::InputError(fmt::format(
        "program '{}': the N of full:N, samples per pixel, must be a square from 1 to {} (1, 4, 9, 16, ...)", text,
        kMaxGrid * kMaxGrid));
  }
  throw sim::InputError(
      fmt::format("program '{}' does not exist; there is: full:N (N samples per pixel, a square)", text));
}

}  // namespace kernels
