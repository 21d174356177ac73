#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "tools/studies/optimise/task.h"

namespace tools::worth {

/// The two sides of a comparison: machines without the feature and machines with it.
enum class Side : std::uint8_t { kWithout, kWith };
inline constexpr std::array<Side, 2> kSides = {Side::kWithout, Side::kWith};
constexpr std::array<std::string_view, 2> names_of(Side) { return {"without", "with"}; }

/// A search, and the text of a search's file that describes it.
struct SideSearch {
  optimise::Task task;
  std::string text;
};

/// Contents of a worth file (docs/worth.md).
struct WorthFile {
  std::string feature;  ///< name of the feature, as it is written within a sentence
  std::string question;
  std::array<SideSearch, 2> sides;  ///< by Side

  const SideSearch& operator[](Side side) const { return sides.at(static_cast<std::size_t>(side)); }
};

/// Reads a worth file: a search's file with `feature`, `without` and `with`.
///   1. Both sides start from the search. Without `objectives` it minimises area_mm2.
///   2. A value in `without` or `with` replaces the search's. Items of lists are added, axes are added or replaced.
/// Throws InputError with file, line, column, key, error and allowed values.
WorthFile read_worth_file(const std::filesystem::path& file);

}  // namespace tools::worth
