#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tools/analysis/report_file.h"
#include "tools/studies/report/report.h"

namespace tools::pages {

/// A ray-tracing counter of a vendor's GPU, and how it follows from a report's counters.
struct VendorCounter {
  std::string_view name;    ///< the vendor's public name
  std::uint32_t id = 0;     ///< the vendor's number of the counter
  std::string_view unit;    ///< what it counts: "rays", "cycles"
  std::string_view source;  ///< a formula of a report's counters, or why the model has none if it begins with kMissing
};
/// Begins the source of a counter that the model lacks.
inline constexpr std::string_view kMissing = "no counterpart: ";

/// The GPUs whose counters are known: values of the option --counters.
inline constexpr std::string_view kVendorGpus[] = {"mali_g1", "mali_g715", "adreno7xx"};

/// Returns the counters of a GPU in the vendor's order. Throws InputError for an unknown GPU.
std::vector<VendorCounter> vendor_counters(std::string_view gpu);

/// Returns the value of a counter in a report; nothing if the model lacks it. Formulas have + - * /, max(a, b),
/// brackets, numbers and counters, which are sums over all units of a kind:
///   trv.X, ist.X, dispatcher.X, srp.X   a counter; `why.X` are cycles by reason, `elapsed` all cycles
///   rays.X                              rays of `totals`
/// Throws InputError if the report lacks a counter of the formula.
std::optional<double> vendor_value(const VendorCounter& counter, const ReportFile& report);

/// Returns a table of the counters of the GPU `options.counters` for the only input, a run. Writes them to
/// `options.out` as CSV, unless it is empty. Throws InputError for several inputs, for other folders, and for an output
/// file that may not be replaced.
std::string report_counters(const Options& options);

}  // namespace tools::pages
