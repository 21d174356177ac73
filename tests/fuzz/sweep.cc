#include <algorithm>

#include "tests/fuzz/common.h"
#include "tools/studies/sweep/spec/plan.h"

// Fuzz target: a sweep file, as `raywatt sweep run FILE --dry-run` reads it, and its first points. Further points are
// not generated, because the time grows with their number.

namespace {

constexpr std::uint64_t kMostCombinations = 4096, kMostValues = 256;
constexpr std::size_t kMostPoints = 4;

bool is_small(const tools::sweep::Spec& spec) {
  std::uint64_t combinations = 1, values = 0;
  for (const tools::sweep::Axis& axis : spec.axes) {
    combinations = std::min(combinations * axis.values.size(), kMostCombinations + 1);
    values += axis.values.size() * axis.keys.size();
  }
  return combinations <= kMostCombinations && values <= kMostValues && spec.subset.count <= kMostCombinations;
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::filesystem::path file = fuzz::file_of(fuzz::text_of(data, size), "input.yaml");
  fuzz::ignore_input_errors([&] {
    const tools::sweep::Spec spec = tools::sweep::read_spec(file);
    if (!is_small(spec)) return;
    tools::sweep::Planner planner(spec, fuzz::folder());
    const auto is_wanted = [&](const tools::sweep::Choice& choice) { return planner.is_wanted(choice); };
    const std::vector<tools::sweep::Choice> choices = choose_combinations(spec.subset, planner.axis_sizes(), is_wanted);
    for (std::size_t i = 0; i < std::min(choices.size(), kMostPoints); ++i) {
      const std::string line = format_point_line(planner.make_point(choices[i]));
      tools::sweep::parse_point_line(line, "points");
    }
  });
  return 0;
}
