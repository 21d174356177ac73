#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "sim/config/field.h"

namespace sim {

/// Low, nominal or high of a figure.
using Side = double Spread::*;
inline constexpr std::array<Side, 3> kSides = {&Spread::low, &Spread::nominal, &Spread::high};

/// A curve at one size: a power law between two of its points, or a point. Refers to the table's figures, which may
/// change.
struct EnergyPoint {
  const Spread* left = nullptr;
  const Spread* right = nullptr;  ///< null: left as it is
  double part = 0;                ///< share of the way from left to right in the logarithm of the size
  double at(Side side) const;
  friend bool operator==(const EnergyPoint&, const EnergyPoint&) = default;
};

/// pJ of an event over the size of the array that it accesses.
class EnergyCurve {
 public:
  bool depends_on_size() const { return points_.size() > 1; }
  /// `bytes` of the array, which must be more than 0 if depends_on_size().
  EnergyPoint at(std::uint64_t bytes) const;
  /// Sizes between which it is measured, if depends_on_size(); beyond them at() extrapolates.
  std::uint64_t least_bytes() const { return static_cast<std::uint64_t>(points_.front().bytes); }
  std::uint64_t most_bytes() const { return static_cast<std::uint64_t>(points_.back().bytes); }

 private:
  friend class EnergyTable;
  struct Point {
    double bytes;
    const Spread* pj;
  };
  /// By rising size; one point of size 0 for an event that does not depend on it.
  std::vector<Point> points_;
};

/// The events of an EnergyConfig, ready to be asked for. `events` must outlive the table and keep its entries.
class EnergyTable {
 public:
  /// Throws InputError for an event whose size ("@16KiB") is none, or that has a figure both with and without sizes.
  /// `key`: what errors call the table.
  explicit EnergyTable(const std::map<std::string, Spread>& events, std::string_view key = "energy.events");
  explicit EnergyTable(std::map<std::string, Spread>&&, std::string_view = {}) = delete;  // it keeps pointers to them

  /// pJ of one event that contains() has, in an array of `bytes`.
  Spread at(std::string_view event, std::uint64_t bytes) const;
  bool contains(std::string_view event) const { return curves_.contains(std::string(event)); }
  const EnergyCurve& curve(std::string_view event) const { return curves_.at(std::string(event)); }
  /// Names without sizes, in alphabetical order.
  std::vector<std::string> names() const;

 private:
  std::map<std::string, EnergyCurve> curves_;
};

/// "cache.l1_read@16KiB" -> "cache.l1_read"
inline std::string event_of(std::string_view entry) { return std::string(entry.substr(0, entry.find('@'))); }

}  // namespace sim
