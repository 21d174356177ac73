#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/temp_folder.h"
#include "tools/studies/sweep/results/collect.h"
#include "tools/studies/sweep/results/results.h"

namespace test {

/// Returns a minimal report.json with a number of cycles. Host and command line differ between any two reports.
nlohmann::ordered_json minimal_report(double cycles);

/// A sweep folder and its result store, written without simulation.
class MadeSweep {
 public:
  using Axes = std::vector<std::pair<std::string, std::string>>;

  /// Adds a point without a result and returns its number.
  std::size_t add(const Axes& axes, const std::string& program = "full:1");
  /// Adds a finished point for each combination of values of two axes.
  void add_grid(const std::string& a, const std::vector<std::string>& values_of_a, const std::string& b,
                const std::vector<std::string>& values_of_b,
                const std::function<double(std::size_t a, std::size_t b)>& cycles);

  /// Sets the result of point `n`, replacing an earlier result.
  void finish(std::size_t n, const std::string& report) const;
  void finish(std::size_t n, const nlohmann::ordered_json& report) const;
  void finish(std::size_t n, double cycles) const;
  void fail(std::size_t n, const std::string& error) const;
  /// Overwrites the report file of a point without using the store.
  void damage(std::size_t n, const std::string& report) const;
  void remove(std::size_t n) const;
  /// Writes the sweep folder. collect() calls this, too.
  tools::sweep::SweepFolder write() const;

  tools::results::Collected collect() const;
  /// Collects the results and opens the collected table.
  tools::results::Results results() const;
  std::string csv() const { return read_bytes(folder() / "results.csv"); }

  std::filesystem::path folder() const { return temporary_.path() / "sweep"; }
  tools::sweep::Store store() const { return tools::sweep::Store(temporary_.path() / "store"); }
  std::filesystem::path point(std::size_t n) const { return store().folder_of(id(n)); }
  const std::string& id(std::size_t n) const { return points_.at(n).id; }
  const std::vector<tools::sweep::Point>& points() const { return points_; }

 private:
  TempFolder temporary_;
  std::vector<tools::sweep::Point> points_;
};

/// Returns the cells of a CSV text, which must not contain quotes.
std::vector<std::vector<std::string>> cells_of(const std::string& csv);

}  // namespace test
