#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "sim/config/field.h"
#include "sim/named.h"
#include "traces/accel/memory_image.h"
#include "traces/ray.h"

namespace traces {

/// Configuration of the ray predictor (Liu et al., MICRO 2021): a table of nodes below which any-hit rays of the same
/// origin and direction have found an occluder.
struct PredictorConfig {
  bool enabled = false;
  std::uint32_t entries = 1024;
  std::uint32_t ways = 4;
  std::uint32_t entry_bits = 44;
  std::uint32_t origin_bits = 5;
  std::uint32_t go_up = 3;
  std::uint32_t lag = 8;
  std::uint32_t ray_lag = 128;
  std::uint32_t latency = 2;

  static void describe(auto& c, auto&& field) {
    using sim::Affects;
    field(NAMED(c.enabled), "", "any-hit rays first visit the subtree in which a similar ray found an occluder",
          sim::any(), Affects::kFunction);
    field(NAMED(c.entries), "entries", "entries of the table, one node each", sim::power_of_two(1, 65536),
          Affects::kFunction);
    field(NAMED(c.ways), "ways", "associativity of the table, replaced by least recent use", sim::power_of_two(1, 16),
          Affects::kFunction);
    field(NAMED(c.entry_bits), "bits", "storage of an entry, for leakage and area", sim::between(32, 128),
          Affects::kEnergy);
    field(NAMED(c.origin_bits), "bits", "bits per axis of the cell of a ray's origin, in a grid over the scene",
          sim::between(1, 8), Affects::kFunction);
    field(NAMED(c.go_up), "levels", "levels from the leaf with the occluder up to the stored node", sim::between(1, 16),
          Affects::kFunction);
    field(NAMED(c.lag), "tiles", "tiles until a look-up finds another tile's updates; 1: the next tile does",
          sim::between(1, 64), Affects::kFunction);
    field(NAMED(c.ray_lag), "rays", "any-hit rays of a tile until a look-up finds the update of an earlier one",
          sim::between(1, 65536), Affects::kFunction);
    field(NAMED(c.latency), "cycles", "latency of a look-up, which every ray passes", sim::between(1, 16),
          Affects::kTiming);
  }
  void check(auto&& complain) const {
    if (ways > entries) {
      complain("ways", "is " + std::to_string(ways) + "; allowed: 1 to entries, which is " + std::to_string(entries));
    }
  }
  std::uint64_t sram_bytes() const { return std::uint64_t{entries} * entry_bits / 8; }
};

/// Computes the hashes of rays and the nodes that their hits store in a predictor's table.
///
/// 1. The hash is the cell of the ray's origin XOR the sector of its direction: 8 sectors by the angle to the y axis
/// times 16 around it.
/// 2. A hit that was not predicted stores the inner node `go_up` levels above its leaf, but not the root.
class RayPredictor {
 public:
  /// `image`: a tree of one level.
  RayPredictor(const MemoryImage& image, const PredictorConfig& config);

  const PredictorConfig& config() const { return config_; }
  std::uint32_t hash_of(const Ray& ray) const;
  /// Returns the node that a hit of `triangle` stores; kNone if the triangle's leaf is a child of the root.
  std::uint32_t node_to_store(std::uint32_t triangle) const;

 private:
  const PredictorConfig config_;
  const glm::vec3 lower_;
  glm::vec3 cells_per_unit_{};
  std::vector<std::uint32_t> parents_;       ///< parent of each inner node
  std::vector<std::uint32_t> leaf_parents_;  ///< for each triangle, the parent of its leaf
};

/// An update of a predictor's table: a ray with this hash found an occluder below this node. Node kNone: a look-up
/// found the entry with this hash.
struct PredictorUpdate {
  std::uint32_t hash = 0, node = 0;
  friend bool operator==(const PredictorUpdate&, const PredictorUpdate&) = default;
};

/// The table of a ray predictor. A set is selected by the XOR of parts of the hash; its entries have the whole hash as
/// tag and are ordered from the most to the least recently used, by a look-up or an update.
class PredictorTable {
 public:
  explicit PredictorTable(const PredictorConfig& config);

  /// Returns the node stored for a hash, or kNone.
  std::uint32_t find_node(std::uint32_t hash) const;
  /// Stores a node as the most recent entry of its set; replaces the entry with the same hash, else the oldest. Without
  /// a node, makes the entry with the hash the most recent, if there is one.
  void apply_update(const PredictorUpdate& update);

 private:
  std::size_t set_of(std::uint32_t hash) const;

  std::uint32_t ways_, set_bits_;
  std::vector<PredictorUpdate> entries_;  ///< node kNone: empty
};

/// A tile's view of the predictor table. Within the tile, the node stored by ray i is visible to rays i + `ray_lag` and
/// later; the order of use changes with each look-up.
class TilePredictions {
 public:
  /// `table`: the table at the start of the tile, which is copied.
  TilePredictions(const RayPredictor& predictor, const PredictorTable& table)
      : predictor_(predictor), table_(table), ray_lag_(predictor.config().ray_lag) {}

  const RayPredictor& predictor() const { return predictor_; }
  /// Returns the node that the tile's next any-hit ray finds, or kNone.
  std::uint32_t look_up(std::uint32_t hash);
  /// Adds an update by the ray that was looked up last.
  void add_update(const PredictorUpdate& update);
  /// Returns the updates of the tile and the look-ups that found an entry, in the order of the rays.
  std::span<const PredictorUpdate> updates() const { return updates_; }

 private:
  const RayPredictor& predictor_;
  PredictorTable table_;
  const std::uint32_t ray_lag_;
  std::vector<PredictorUpdate> updates_;
  std::vector<std::uint32_t> updating_rays_;  ///< number of the ray of each update, from 1
  std::uint32_t rays_ = 0;                    ///< number of look-ups
  std::size_t visible_ = 0;                   ///< number of updates that the table contains
};

/// The tables of a frame program's tiles. Tile number t begins with the table as it is after tile t - lag, so that
/// results do not depend on the number of threads. Before the first update the table is empty.
class PredictorHistory {
 public:
  explicit PredictorHistory(const RayPredictor& predictor);

  /// Returns the end of the range of tiles that may start now.
  std::uint32_t end_of_startable() const { return committed_ + lag_; }
  /// Returns the table of a tile that may start. It does not change before the tile is committed.
  const PredictorTable& table_of(std::uint32_t tile) const;
  /// Applies the updates of the next tile in order.
  void commit_tile(std::span<const PredictorUpdate> updates);

 private:
  const std::uint32_t lag_;
  std::uint32_t committed_ = 0;           ///< number of tiles whose updates have been applied
  std::vector<PredictorTable> versions_;  ///< the table after n tiles, at n modulo `lag_`
};

}  // namespace traces
