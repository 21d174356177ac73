#include "tests/fuzz/common.h"
#include "tests/fuzz/seed_report.h"
#include "tools/studies/compare/compare.h"

// Fuzz target: a report.json, as `raywatt compare` reads it and compares it with another one.

namespace {

void compare_with(const tools::ReportFile& other, const tools::ReportFile& report) {
  const std::vector<tools::ReportFile> both = {other, report};
  const std::vector<tools::Comparison> against = {tools::compare(other, report)};
  tools::comparison_warnings(both, against);
  tools::comparison_text(both, against);
  sim::json_lines(tools::comparison_json(both, against));
}

}  // namespace

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed) {
  return fuzz::mutate_json(data, size, most, seed);
}

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const tools::ReportFile other = tools::load_report(fuzz::file_of(fuzz::seed_report().dump(), "other.json"));
  const std::filesystem::path file = fuzz::file_of(fuzz::text_of(data, size), "input.json");
  fuzz::ignore_input_errors([&] { compare_with(other, tools::load_report(file)); });
  return 0;
}
