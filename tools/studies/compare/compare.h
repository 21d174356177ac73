#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/analysis/replicated.h"
#include "tools/analysis/report_file.h"
#include "tools/host/progress.h"
#include "tools/pricing/energy_study.h"

namespace tools {

/// A figure of two runs.
struct Pair {
  std::string name;
  double a = 0, b = 0;
  std::optional<NoisyDifference> noise{};  ///< that of figures that have some
  std::string shown{};                     ///< what people call a figure of `totals`
  double difference() const { return b - a; }
};

/// A key of the configuration in which two runs differ; empty where one has no such key.
struct KeyPair {
  std::string key, a, b;
};

/// Energy of a run over that of the other as the tables' figures move in their bands.
struct EnergyBands {
  EnergyRatio gpu, tni;
  std::vector<TornadoBar> tornado;  ///< bars of the GPU with memory
};

/// A run beside another.
struct Comparison {
  std::vector<std::string> other_work;  ///< why the two did not have the same work to do; empty: they had
  std::vector<KeyPair> config;
  bool other_clock = false;   ///< T&I cycles of the two are of different length: a difference of cycles means nothing
  std::vector<Pair> figures;  ///< what people look at first, in this order
  // Explanations, largest difference first; equal figures are left out.
  std::vector<Pair> time;      ///< T&I cycles of an average core, by the parts of totals.top_down
  std::vector<Pair> reasons;   ///< T&I cycles by unit and reason, of an average unit of its kind; without idle ones
  std::vector<Pair> blocks;    ///< nominal mJ by block
  std::vector<Pair> events;    ///< nominal mJ by block and event, and of clock and leakage
  std::vector<Pair> counters;  ///< sums over units of a kind, by relative change; all that moved by more than 1 % of
                               ///< the rays
  std::vector<Pair> ratios;    ///< hit rates and mean times, in the order of the memory hierarchy
  std::optional<EnergyBands> energy;  ///< none if one of the two cannot be priced
  std::string no_energy;              ///< why there is no `energy`
  // The first frame's pictures.
  std::optional<double> squared_error;
  std::string no_picture;  ///< why there is no squared_error

  /// Is a difference of the figure none of the designs, because the clocks differ that it counts?
  bool says_nothing_of(std::string_view figure) const { return other_clock && figure == "cycles"; }
};

/// Plays the run of a report so many times (docs/noise.md) and puts the figures' statistics into the report, which is
/// left as it is if it has as many replicates. InputError for a report whose run cannot be had again.
void add_replicates(ReportFile& report, std::uint32_t count, std::uint32_t threads, Progress* progress);

/// `b` against `a`.
Comparison compare(const ReportFile& a, const ReportFile& b);

/// Reports side by side, the first against each other one: schema raywatt-compare/1.
sim::Json comparison_json(const std::vector<ReportFile>& reports, const std::vector<Comparison>& against);

/// The same for a terminal.
std::string comparison_text(const std::vector<ReportFile>& reports, const std::vector<Comparison>& against);

// Words of it, for whoever shows a comparison.
/// A change: "+1.4 %", "x2.08", "new", "gone", "=".
std::string change_text(const Pair& pair);
/// Names of the runs, those of their folders; with letters before them where two are alike.
std::vector<std::string> short_names(const std::vector<ReportFile>& reports);
/// Names of `Comparison::time` in words: "tree misses: DRAM".
std::vector<Pair> in_words(std::vector<Pair> times);

/// Warnings on what should be read with care: one line each.
std::vector<std::string> comparison_warnings(const std::vector<ReportFile>& reports,
                                             const std::vector<Comparison>& against);

/// Compares the first frame's pictures beside two reports, linear floats if both have them and else 8 bits, and writes
/// down the mean squared difference of their sRGB values, or why there is none.
void compare_pictures(const ReportFile& a, const ReportFile& b, Comparison& out);

/// Prices both runs under all tables, and writes down how their energies compare, or why they cannot be priced.
void compare_energy(const ReportFile& a, const ReportFile& b, Comparison& out);

/// Quotients of counters, such as hit rates, that differ between two reports.
std::vector<Pair> ratios(const ReportFile& a, const ReportFile& b);

}  // namespace tools
