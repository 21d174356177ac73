#include "shader_kernels/programs/program_spec.h"

#include <array>
#include <charconv>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "sim/error.h"
#include "traces/scene/did_you_mean.h"

namespace kernels {
namespace {

constexpr std::uint32_t kMaxGrid = 32;

struct Named {
  std::string_view name;
  ProgramSpec spec;
};
constexpr auto kNamed = std::to_array<Named>({
    {"full:1", {ProgramSpec::Kind::kFull, 1}},
    {"multirate:under", {ProgramSpec::Kind::kMultirate, 1}},
    {"multirate:super", {ProgramSpec::Kind::kMultirate, 4}},
    {"reconstruct", {ProgramSpec::Kind::kReconstruct, 16}},
    {"reconstruct:sraa", {ProgramSpec::Kind::kSraa, 16}},
    {"supersample", {ProgramSpec::Kind::kSupersample, 16}},
    {"undersample", {ProgramSpec::Kind::kUndersample, 1}},
});

bool is_square(std::uint32_t n) {
  for (std::uint32_t side = 1; side <= kMaxGrid; ++side) {
    if (side * side == n) return true;
  }
  return false;
}

ProgramSpec parse_full(std::string_view text, std::string_view number) {
  std::uint32_t samples = 0;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), samples);
  if (error == std::errc{} && end == number.data() + number.size() && is_square(samples)) return {.samples = samples};
  throw sim::InputError(
      fmt::format("program '{}': the N of full:N, samples per pixel, must be a square from 1 to {} (1, 4, 9, 16, ...)",
                  text, kMaxGrid * kMaxGrid));
}

}  // namespace

std::string ProgramSpec::name() const {
  if (kind == Kind::kFull) return fmt::format("full:{}", samples);
  for (const Named& named : kNamed) {
    if (named.spec.kind == kind && named.spec.samples == samples) return std::string(named.name);
  }
  return {};
}

ProgramSpec parse_program(std::string_view text) {
  for (const Named& named : kNamed) {
    if (named.name == text) return named.spec;
  }
  constexpr std::string_view kFull = "full:";
  if (text == "full") return parse_full(text, "");
  if (text.starts_with(kFull)) return parse_full(text, text.substr(kFull.size()));
  std::string all = "full:N (N samples per pixel, a square)";
  for (const Named& named : kNamed) {
    if (named.spec.kind != ProgramSpec::Kind::kFull) all += fmt::format(", {}", named.name);
  }
  throw sim::InputError(fmt::format("program '{}' does not exist{}; there is: {}", text,
                                    traces::did_you_mean(text, program_names()), all));
}

std::vector<std::string> program_names() {
  std::vector<std::string> names;
  for (const Named& named : kNamed) names.emplace_back(named.name);
  return names;
}

}  // namespace kernels
