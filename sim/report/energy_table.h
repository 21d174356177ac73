#pragma once
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "sim/config/field.h"

namespace sim {

/// The events of an EnergyConfig, ready to be asked for.
class EnergyTable {
 public:
  /// Throws InputError for an event whose size ("@16KiB") is none, or that has a figure both with and without sizes.
  explicit EnergyTable(const std::map<std::string, Spread>& events);

  /// pJ of one event that contains() has, in an array of `bytes`, which must be more than 0 if depends_on_size().
  Spread at(std::string_view event, std::uint64_t bytes) const;
  bool contains(std::string_view event) const { return curves_.contains(std::string(event)); }
  bool depends_on_size(std::string_view event) const { return curves_.at(std::string(event)).size() > 1; }
  /// Names without sizes, in alphabetical order.
  std::vector<std::string> names() const;

 private:
  struct Point {
    double bytes;
    Spread pj;
  };
  /// By rising size; one point of size 0 for an event that does not depend on it.
  std::map<std::string, std::vector<Point>> curves_;
};

}  // namespace sim
