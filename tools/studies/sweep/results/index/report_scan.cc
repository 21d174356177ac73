#include "tools/studies/sweep/results/index/report_scan.h"

#include <algorithm>
#include <cstdint>
#include <limits>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"

namespace tools::results {
namespace {

using sim::Json;

// Levels of nesting: the report's own is the first.
constexpr std::size_t kInHost = 2, kInFrames = 2, kInFrame = 3, kDeepest = 32;

/// Follows the paths of a report while it is read: "totals.top_down.cores[2].boxes".
class Scanner : public sim::JsonReader {
 public:
  Scanner(MetricNames& names, ReportScan& scan) : names_(names), scan_(scan) {}

  bool null() override { return value({}); }
  bool boolean(bool is_true) override {
    if (section_ == Section::kPartial) partial_ = is_true;
    return value(std::string(is_true ? "true" : "false"));
  }
  bool integer(std::int64_t number) override { return value(number); }
  bool natural(std::uint64_t number) override {
    if (number > std::uint64_t{std::numeric_limits<std::int64_t>::max()}) return value(static_cast<double>(number));
    return value(static_cast<std::int64_t>(number));
  }
  bool real(double number) override { return value(number); }
  bool text(std::string& text) override {
    if (section_ == Section::kSchema) schema_ = text;
    return section_ == Section::kNone || value(text);
  }
  bool begin_object() override { return open(false); }
  bool begin_array() override { return open(true); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }
  bool key(std::string& name) override {
    if (levels_.size() == 1) begin_section(name);
    if (section_ == Section::kNone) return true;
    path_.resize(levels_.back().path);
    if (levels_.size() > 1) path_ += '.';
    path_ += name;
    return true;
  }

  std::optional<std::string> problem() const {
    if (!problem_.empty()) return problem_;
    if (!schema_.starts_with("raywatt-")) return "it is no report: it has no schema";
    if (partial_) return "it is of an interrupted run";
    if (scan_.metrics.empty()) return "it has no totals";
    return std::nullopt;
  }

 private:
  enum class Section { kNone, kSchema, kPartial, kTotals, kFrames, kHost };
  struct Level {
    std::size_t path;      ///< length of the path so far
    std::int64_t element;  ///< the next one's number; -1: an object
  };

  bool fail(std::string problem) {
    problem_ = std::move(problem);
    return false;
  }

  void begin_section(std::string_view name) {
    section_ = name == "totals"    ? Section::kTotals
               : name == "frames"  ? Section::kFrames
               : name == "host"    ? Section::kHost
               : name == "schema"  ? Section::kSchema
               : name == "partial" ? Section::kPartial
                                   : Section::kNone;
  }

  /// Before a value or a container: the path of an element of an array.
  void begin_element() {
    if (section_ == Section::kNone || levels_.empty() || levels_.back().element < 0) return;
    if (section_ == Section::kFrames && levels_.size() == kInFrames) scan_.frames.emplace_back();
    path_.resize(levels_.back().path);
    path_ += fmt::format("[{}]", levels_.back().element++);
  }

  bool open(bool is_array) {
    if (levels_.size() == kDeepest) return fail("it is nested more deeply than any report");
    begin_element();
    levels_.push_back({path_.size(), is_array ? 0 : -1});
    return true;
  }
  bool close() {
    levels_.pop_back();
    return true;
  }

  bool value(Value value) {
    begin_element();
    if (is_absent(value)) return true;
    if (section_ == Section::kTotals) scan_.metrics.emplace_back(names_.number_of(path_), std::move(value));
    if (section_ == Section::kHost) keep(kHostFacts, kInHost, scan_.host, std::move(value));
    if (section_ == Section::kFrames && !scan_.frames.empty()) {
      keep(kFrameFigures, kInFrame, scan_.frames.back(), std::move(value));
    }
    return true;
  }

  /// Keeps a value whose path below a level is one of `names`.
  template <class Names, class Values>
  void keep(const Names& names, std::size_t level, Values& values, Value value) const {
    if (levels_.size() < level) return;
    const auto found = std::ranges::find(names, std::string_view(path_).substr(levels_[level - 1].path + 1));
    if (found != names.end()) values[static_cast<std::size_t>(found - names.begin())] = std::move(value);
  }

  MetricNames& names_;
  ReportScan& scan_;
  Section section_ = Section::kNone;
  std::vector<Level> levels_;
  std::string path_, schema_, problem_;
  bool partial_ = false;
};

}  // namespace

std::optional<std::string> scan_report(std::string_view json, MetricNames& names, ReportScan& scan) {
  Scanner scanner(names, scan);
  try {
    sim::scan_json(json, scanner);
  } catch (const sim::JsonError& error) {
    const std::string_view text = error.what();
    const std::size_t head = text.find("] ");  // the end of "[json.exception.parse_error.101] "
    return sim::printable(text.substr(head == std::string_view::npos ? 0 : head + 2));
  } catch (const sim::InputError& error) {
    return error.what();
  }
  return scanner.problem();
}

}  // namespace tools::results
