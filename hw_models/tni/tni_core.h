#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "hw_models/memory/core_port.h"
#include "hw_models/tni/ist.h"
#include "hw_models/tni/predictor_stage.h"
#include "hw_models/tni/ray_dispatcher.h"
#include "hw_models/tni/trv.h"
#include "sim/machine.h"
#include "traces/accel/memory_image.h"

namespace hw {

/// Declares an intersection unit (IST) of a core's T&I unit in the machine. The unit is built later, with its links.
/// `number`: its number among tni.ists, which is in its name if there are several.
sim::UnitId declare_ist(sim::Machine& machine, const TniConfig& config, std::uint32_t core, sim::Clock clock,
                        const TreeKind& tree = {}, std::uint32_t number = 0);

/// A core's T&I unit: ray dispatcher, traversal units (TRVs), intersection units (ISTs), and the links between them.
///
///   rays --> [predictor] --> dispatcher --> TRV x n <--> IST x m
///   hits <-----------------  dispatcher <-- TRV x n
///
/// TRV number i sends its leaves to IST number i modulo m.
///
/// The constructor declares the units, so that links can connect to them. build_units() builds them when the links
/// exist.
class TniCore {
 public:
  struct Scene {
    TreeInMemory tree;
    TrianglesInMemory triangles;
  };
  /// Selects the parts of a T&I unit that are ideal (keys ideal.*).
  struct Ideal {
    bool tni = false;  ///< ideal pipes: 64 rays per TRV, 64 leaves in the IST, unlimited one-cycle operations
    bool l1 = false;   ///< ideal L1 caches: every probe hits
  };
  struct Links {
    sim::Link<RayJob>& rays_in;
    sim::Link<RayDone>& hits_out;
    std::span<const MemoryPort> memory;  ///< one port for each of memory_clients(), in that order
  };

  /// `tree`: kind of the trees for which the units are built.
  TniCore(sim::Machine& machine, const TniConfig& config, const Ideal& ideal, std::uint32_t core, sim::Clock clock,
          const TreeKind& tree = {});
  /// Builds the dispatcher, TRVs and ISTs of the T&I unit. `machine`: the one in which they were declared.
  /// `hit_interval`: minimum cycles from one returned hit to the next. Throws InputError if the pipes would be too long
  /// for the trees of the scene.
  void build_units(sim::Machine& machine, const Scene& scene, std::uint32_t hit_interval, const Links& links);

  /// Makes this T&I unit a cluster of the machine (sim/machine.h): the T&I unit, not the engine, ticks its
  /// dispatcher, TRVs and ISTs. The core's cache port belongs to the cluster if it has the same clock.
  void make_cluster(sim::Machine& machine, sim::UnitId port_id, CorePort& port);
  void run(const sim::ClusterTurn& turn, sim::Time now);

  /// Returns the id of the unit that accepts rays: the predictor, or without one the ray dispatcher.
  sim::UnitId rays_in_id() const { return predictor_id_.value_or(dispatcher_id_); }
  /// Returns the ray dispatcher's id: the unit that returns hits.
  sim::UnitId dispatcher_id() const { return dispatcher_id_; }
  /// Returns the memory clients of the T&I unit: the L1 of each TRV, then the L1 of each IST.
  std::vector<MemoryClient> memory_clients() const;

  const RayDispatcher& dispatcher() const { return *dispatcher_; }
  /// Returns the predictor; null if the T&I unit has none.
  const PredictorStage* predictor() const { return predictor_; }
  const std::vector<Trv*>& trvs() const { return trvs_; }
  const std::vector<Ist*>& ists() const { return ists_; }
  /// Returns the intersection unit that tests the leaves of a traversal unit.
  Ist& ist_of(std::size_t trv) const { return *ists_[trv % ists_.size()]; }

 private:
  /// Ticks those ISTs but the first, and the core's cache port, whose bits are set in `due`, and stores their next
  /// wake-up times in `wakes`.
  [[gnu::noinline]] void tick_more_ists_and_port(std::uint64_t due, sim::Time* wakes, const Cycle& cycle);

  TniConfig config_;
  Ideal ideal_;
  sim::UnitId dispatcher_id_;
  std::vector<sim::UnitId> ist_ids_, trv_ids_;
  std::optional<sim::UnitId> predictor_id_;
  RayDispatcher* dispatcher_ = nullptr;
  PredictorStage* predictor_ = nullptr;
  std::vector<Trv*> trvs_;
  std::vector<Ist*> ists_;
  CorePort* port_ = nullptr;  ///< the core's cache port; null if it is not in the cluster
};

/// Returns the addresses of the BVH and triangles in memory, and the links between nodes, for T&I units. `parents`:
/// result of traces::parent_indices(). Both arguments must outlive the result.
inline TniCore::Scene scene_in_memory(const traces::MemoryImage& image, std::span<const std::uint32_t> parents) {
  const traces::Layout& layout = image.layout;
  return {tree_in_memory(image, parents),
          {.base = layout.triangles,
           .bytes = layout.triangle_bytes,
           .places = layout.triangle_places,
           .decoded = image.leaf_format == traces::LeafFormat::kBlock128}};
}

}  // namespace hw
