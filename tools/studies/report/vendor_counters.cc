#include "tools/studies/report/vendor_counters.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <charconv>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/printable.h"
#include "sim/report/table.h"
#include "tools/studies/sweep/results/results.h"

namespace tools::pages {

namespace {

constexpr std::string_view kCsvHeader = "counter,id,value,unit,formula";
constexpr std::string_view kBoxTests = "trv.box_tests + trv.hybrid_box_tests + trv.q8_box_tests + trv.q12_box_tests";
constexpr std::string_view kHitsOfFirstProbes =
    "trv.l1_hits + trv.rau_reads - trv.l1_late + ist.l1_hits + ist.rau_reads - ist.l1_late";
constexpr std::string_view kIssueCycles = "max(trv.why.visiting, ist.why.testing)";
constexpr std::string_view kUtilisation =
    "100 * max(trv.why.visiting / trv.elapsed, ist.why.testing / ist.elapsed) / (1 - srp.why.starved / srp.elapsed)";
constexpr std::string_view kNoWarps = "no counterpart: rays are traced one by one, without warps";
constexpr std::string_view kNoOpacity = "no counterpart: hits are not divided by the opacity of triangles";
constexpr std::string_view kNoClients = "no counterpart: L2 misses are not divided by client";
constexpr std::string_view kNoMessages = "no counterpart: rays are counted, not the messages that carry them";
constexpr std::string_view kNoQueue = "no counterpart: the unit has no such queue";
constexpr std::string_view kNoOperands = "no counterpart: operands are part of the ray in the input buffer";

// Names and numbers of Mali's counters: ARM-software/libGPUCounters, file Mali-CounterInfo-08a-ShaderCore-
// RayTracingUnit.xml. A beat of Mali's bus has 16 bytes, a line four beats.
enum MaliGpus : std::uint8_t { kG715 = 1, kG1 = 2, kBoth = 3 };
struct MaliCounter {
  MaliGpus gpus;
  VendorCounter counter;
};
constexpr auto kMaliCounters = std::to_array<MaliCounter>({
    {kBoth, {"RT_RAYS_STARTED", 312, "rays", "dispatcher.rays_in"}},
    {kG1, {"RT_ACTIVE", 553, "cycles", "srp.fed"}},
    {kG715, {"RT_RAY_BOX", 246, "boxes", kBoxTests}},
    {kG715, {"RT_RAY_TRI", 210, "nodes", "ist.leaves_in"}},
    {kG715, {"RT_RAY_BOX_BIN_1_4", 304, "nodes", kNoWarps}},
    {kG715, {"RT_RAY_BOX_BIN_5_8", 305, "nodes", kNoWarps}},
    {kG715, {"RT_RAY_BOX_BIN_9_12", 306, "nodes", kNoWarps}},
    {kG715, {"RT_RAY_BOX_BIN_13_16", 307, "nodes", kNoWarps}},
    {kG715, {"RT_RAY_TRI_BIN_1_4", 265, "nodes", kNoWarps}},
    {kG715, {"RT_RAY_TRI_BIN_5_8", 266, "nodes", kNoWarps}},
    {kG715, {"RT_RAY_TRI_BIN_9_12", 269, "nodes", kNoWarps}},
    {kG715, {"RT_RAY_TRI_BIN_13_16", 303, "nodes", kNoWarps}},
    {kG715, {"RT_RAY_BOX_ISSUED", 313, "cycles", "trv.why.visiting"}},
    {kG715, {"RT_RAY_TRI_ISSUED", 314, "cycles", "ist.why.testing"}},
    {kG1, {"RT_BOX_ISSUE_CYCLES", 313, "cycles", "trv.why.visiting"}},
    {kG1, {"RT_TRI_ISSUE_CYCLES", 314, "cycles", "ist.why.testing"}},
    {kG1, {"RT_BOX_ISSUE_COUNT", 430, "boxes", kBoxTests}},
    {kG1, {"RT_TRI_ISSUE_COUNT", 433, "triangles", "ist.tests"}},
    {kG1, {"RT_RAY_BOX_TLAS", 434, "boxes", "no counterpart: box tests are not divided by level of the tree"}},
    {kG1, {"RT_RAY_INSTANCE", 435, "instances", "trv.transforms"}},
    {kG1, {"RT_RAY_INSTANCE_CULL", 436, "instances", "no counterpart: instances are not counted by result"}},
    {kG1, {"RT_RAY_TRI_CULL", 437, "tests", "no counterpart: boxes that a ray misses are not counted"}},
    {kBoth, {"RT_OPAQUE_HIT + RT_NON_OPAQUE_HIT", 0, "tests", "ist.hits"}},
    {kBoth, {"RT_OPAQUE_HIT", 308, "tests", kNoOpacity}},
    {kBoth, {"RT_NON_OPAQUE_HIT", 309, "tests", kNoOpacity}},
    {kBoth, {"RT_TERM_FIRST_HIT", 310, "rays", "no counterpart: any-hit rays are not counted by result"}},
    {kBoth, {"RT_MISS", 311, "tests", "ist.tests - ist.hits"}},
    {kG1, {"RT_CACHE_READ_HIT", 431, "requests", kHitsOfFirstProbes}},
    {kG1, {"RT_CACHE_READ_MISS", 432, "requests", "trv.l1_late + ist.l1_late"}},
    {kG1, {"RT_TRACE_MSG_NEW", 438, "requests", kNoMessages}},
    {kG1, {"RT_TRACE_MSG_RESUME", 439, "requests", kNoMessages}},
    {kG1, {"RT_TRACE_RESUME", 440, "rays", "rays.continued"}},
    {kG1,
     {"RT_TRAVERSAL_STACK_OVERFLOW", 441, "rays", "no counterpart: dropped stack entries are counted, not their rays"}},
    {kG1, {"EXEC_MSG_STALLED_RTU", 0, "cycles", "srp.why.no_slots"}},
    {kBoth, {"BEATS_RD_RTU", 56, "beats of 16 bytes", "4 * (trv.l1_fills + ist.l1_fills)"}},
    {kBoth, {"BEATS_RD_RTU_EXT", 57, "beats of 16 bytes", kNoClients}},
    {kBoth, {"MaliRTUIssueCy", 429, "cycles", kIssueCycles}},
    {kBoth, {"MaliRTUUtil", 321, "%", kUtilisation}},
});

// Prefetched lines and lines of the map of treelets are not missed by rays.
constexpr const char* kDemandMisses = "trv.l1_fills - trv.prefetches - trv.map_fills? + ist.l1_fills - ist.prefetches?";

// Names and numbers of Adreno's counters of the shader processor: the a7xx table derived from freedreno. The meanings
// are inferred from the names.
constexpr auto kAdrenoCounters = std::to_array<VendorCounter>({
    {"SP_RAY_QUERY_INSTRUCTIONS", 122, "node tests", "trv.visits + trv.leaves"},
    {"SP_RBRT_KICKOFF_FIBERS", 123, "node tests", "trv.visits + trv.leaves"},
    {"SP_RBRT_KICKOFF_DQUADS", 124, "quads", kNoWarps},
    {"SP_RTU_BUSY_CYCLES", 125, "cycles", "trv.why.visiting + ist.why.testing"},
    {"SP_RTU_L0_HITS", 126, "requests", kHitsOfFirstProbes},
    {"SP_RTU_L0_MISSES", 127, "requests", kDemandMisses},
    {"SP_RTU_L0_HIT_ON_MISS", 128, "requests",
     "max(0, trv.l1_late + ist.l1_late - (trv.l1_fills - trv.prefetches - trv.map_fills? + ist.l1_fills - "
     "ist.prefetches?))"},
    {"SP_RTU_STALL_CYCLES_WAVE_QUEUE", 129, "cycles", "trv.why.output_full"},
    {"SP_RTU_STALL_CYCLES_L0_HIT_QUEUE", 130, "cycles", kNoQueue},
    {"SP_RTU_STALL_CYCLES_L0_MISS_QUEUE", 131, "cycles", "trv.why.mshr_full + ist.why.mshr_full"},
    {"SP_RTU_STALL_CYCLES_L0D_IDX_QUEUE", 132, "cycles", kNoQueue},
    {"SP_RTU_STALL_CYCLES_L0DATA", 133, "cycles", kNoQueue},
    {"SP_RTU_STALL_CYCLES_REPLACE_CNT", 134, "cycles", "no counterpart: a line is replaced without a wait"},
    {"SP_RTU_STALL_CYCLES_MRG_CNT", 135, "cycles", "trv.why.rau_full + ist.why.rau_full"},
    {"SP_RTU_STALL_CYCLES_UCHE", 136, "cycles", "trv.why.l1_miss + ist.why.l1_miss"},
    {"SP_RTU_OPERAND_FETCH_STALL_CYCLES_L0", 137, "cycles", kNoOperands},
    {"SP_RTU_OPERAND_FETCH_STALL_CYCLES_INS_FIFO", 138, "cycles", kNoOperands},
    {"SP_RTU_BVH_FETCH_LATENCY_CYCLES", 139, "cycles", "trv.l1_miss_cycles + ist.l1_miss_cycles"},
    {"SP_RTU_BVH_FETCH_LATENCY_SAMPLES", 140, "lines", "trv.l1_fills + ist.l1_fills"},
    {"SP_RTU_RAY_BOX_INTERSECTIONS", 148, "boxes", kBoxTests},
    {"SP_RTU_RAY_TRIANGLE_INTERSECTIONS", 149, "triangles", "ist.tests"},
    {"SP_SCH_STALL_CYCLES_RTU", 150, "cycles", "srp.why.no_slots"},
});

/// Converts a counter's name in a formula ("trv.visits") into the path of its value in report.json.
std::string report_path(std::string_view name) {
  const std::size_t dot = name.find('.');
  assert(dot != std::string_view::npos);
  const std::string_view unit = name.substr(0, dot), rest = name.substr(dot + 1);
  if (unit == "rays") return fmt::format("totals.{}", name);
  const std::string_view parent = unit == "srp" ? "core" : "core.tni";
  const bool is_counter = !rest.starts_with("why.") && rest != "elapsed";
  return fmt::format("units.{}.{}.{}{}", parent, unit, is_counter ? "counters." : "", rest);
}

/// Computes the value of a formula. `X?` is 0 in reports without the counter `X`.
class Formula {
 public:
  Formula(std::string_view text, const ReportFile& report) : text_(text), report_(report) {}
  double value() {
    const double value = sum();
    assert(text_.empty());
    return value;
  }

 private:
  bool skip(std::string_view token) {
    text_.remove_prefix(std::min(text_.find_first_not_of(' '), text_.size()));
    if (!text_.starts_with(token)) return false;
    text_.remove_prefix(token.size());
    return true;
  }
  double sum() {
    double value = product();
    for (;;) {
      if (skip("+")) {
        value += product();
      } else if (skip("-")) {
        value -= product();
      } else {
        return value;
      }
    }
  }
  double product() {
    double value = atom();
    for (;;) {
      if (skip("*")) {
        value *= atom();
      } else if (skip("/")) {
        const double divisor = atom();
        value = divisor == 0 ? 0 : value / divisor;
      } else {
        return value;
      }
    }
  }
  double atom() {
    if (skip("max(")) {
      const double first = sum();
      skip(",");
      const double second = sum();
      skip(")");
      return std::max(first, second);
    }
    if (skip("(")) {
      const double value = sum();
      skip(")");
      return value;
    }
    const std::size_t end = std::min(text_.find_first_of(" ,)"), text_.size());
    const std::string_view word = text_.substr(0, end);
    text_.remove_prefix(end);
    double number = 0;
    if (std::from_chars(word.data(), word.data() + word.size(), number).ec == std::errc()) return number;
    const bool may_lack = word.ends_with('?');
    const std::string path = report_path(may_lack ? word.substr(0, word.size() - 1) : word);
    if (report_.has(path)) return report_.number(path);
    if (may_lack) return 0;
    throw sim::InputError(fmt::format("{}: has no {}; allowed: reports of this version of the program",
                                      sim::printable(report_.file.string()), path));
  }

  std::string_view text_;
  const ReportFile& report_;
};

/// Returns a value without rounding, as an integer if it is one.
std::string exact_text(double value) {
  return value == std::floor(value) ? fmt::format("{:.0f}", value) : fmt::format("{}", value);
}

}  // namespace

std::vector<VendorCounter> vendor_counters(std::string_view gpu) {
  if (gpu == "adreno7xx") return {kAdrenoCounters.begin(), kAdrenoCounters.end()};
  if (gpu != "mali_g1" && gpu != "mali_g715") {
    throw sim::InputError(fmt::format("--counters: no counters of '{}' are known; allowed: {}", sim::printable(gpu),
                                      fmt::join(kVendorGpus, ", ")));
  }
  std::vector<VendorCounter> out;
  for (const auto& [gpus, counter] : kMaliCounters) {
    if ((gpus & (gpu == "mali_g1" ? kG1 : kG715)) != 0) out.push_back(counter);
  }
  return out;
}

std::optional<double> vendor_value(const VendorCounter& counter, const ReportFile& report) {
  if (counter.source.starts_with(kMissing)) return std::nullopt;
  return Formula(counter.source, report).value();
}

std::string report_counters(const Options& options) {
  if (options.inputs.size() != 1) {
    throw sim::InputError(
        fmt::format("--counters: got {} folders; allowed: the folder of one run", options.inputs.size()));
  }
  if (!options.out.empty()) {
    sim::check_output(options.out, {.mark = kCsvHeader, .kind = "table of counters", .any = options.force});
  }
  const ReportFile report = load_report(options.inputs.front());
  sim::Table table({"counter", "value", "unit", "formula"});
  std::string csv = fmt::format("{}\n", kCsvHeader);
  for (const VendorCounter& counter : vendor_counters(options.counters)) {
    const std::optional<double> value = vendor_value(counter, report);
    const std::string name(counter.name), unit(counter.unit), source(counter.source);
    table.add_row({name, value ? sim::four_digit_text(*value) : "-", unit, source});
    csv += results::csv_line(
        {name, counter.id == 0 ? "" : fmt::format("{}", counter.id), value ? exact_text(*value) : "", unit, source});
  }
  if (!options.out.empty()) sim::write_file_atomically(options.out, csv);
  return table.text();
}

}  // namespace tools::pages
