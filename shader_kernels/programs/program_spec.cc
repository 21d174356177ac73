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
    {"path:1", {ProgramSpec::Kind::kPath, 1}},
    {"multirate:under", {ProgramSpec::Kind::kMultirate, 1}},
    {"multirate:super", {ProgramSpec::Kind::kMultirate, 4}},
    {"reconstruct", {ProgramSpec::Kind::kReconstruct, 16}},
    {"reconstruct:sraa", {ProgramSpec::Kind::kSraa, 16}},
    {"supersample", {ProgramSpec::Kind::kSupersample, 16}},
    {"undersample", {ProgramSpec::Kind::kUndersample, 1}},
});

/// Programs whose names end with a number of samples.
struct Counted {
  std::string_view name;
  ProgramSpec::Kind kind;
};
constexpr auto kCounted = std::to_array<Counted>({
    {"full", ProgramSpec::Kind::kFull},
    {"path", ProgramSpec::Kind::kPath},
});

bool is_square(std::uint32_t n) {
  for (std::uint32_t side = 1; side <= kMaxGrid; ++side) {
    if (side * side == n) return true;
  }
  return false;
}

/// Parses the samples per pixel in the name of program full:N or path:N. `name`: the name before the colon.
ProgramSpec parse_samples(std::string_view text, std::string_view name, ProgramSpec::Kind kind) {
  const std::string_view number = text.size() > name.size() ? text.substr(name.size() + 1) : "";
  std::uint32_t samples = 0;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), samples);
  if (error == std::errc{} && end == number.data() + number.size() && is_square(samples)) return {kind, samples};
  throw sim::InputError(
      fmt::format("program '{}': the N of {}:N, samples per pixel, must be a square from 1 to {} (1, 4, 9, 16, ...)",
                  text, name, kMaxGrid * kMaxGrid));
}

}  // namespace

std::string ProgramSpec::name() const {
  for (const Counted& counted : kCounted) {
    if (counted.kind == kind) return fmt::format("{}:{}", counted.name, samples);
  }
  for (const Named& named : kNamed) {
    if (named.spec.kind == kind && named.spec.samples == samples) return std::string(named.name);
  }
  return {};
}

ProgramSpec parse_program(std::string_view text) {
  for (const Named& named : kNamed) {
    if (named.name == text) return named.spec;
  }
  for (const auto& [name, kind] : kCounted) {
    if (text == name || (text.starts_with(name) && text[name.size()] == ':')) return parse_samples(text, name, kind);
  }
  std::string all = "full:N (N samples per pixel, a square), path:N";
  for (const Named& named : kNamed) {
    const bool is_counted = named.spec.kind == ProgramSpec::Kind::kFull || named.spec.kind == ProgramSpec::Kind::kPath;
    if (!is_counted) all += fmt::format(", {}", named.name);
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
