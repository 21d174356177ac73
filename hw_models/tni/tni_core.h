#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "hw_models/memory/core_port.h"
#include "hw_models/tni/ist.h"
#include "hw_models/tni/ray_dispatcher.h"
#include "hw_models/tni/trv.h"
#include "sim/error.h"
#include "sim/machine.h"
#include "traces/accel/memory_image.h"

namespace hw {

/// Declares the intersection unit (IST) of a core's T&I unit in the machine. The unit is built later, with its links.
sim::UnitId declare_ist(sim::Machine& machine, const TniConfig& config, std::uint32_t core, sim::Clock clock);

/// A core's T&I unit: ray dispatcher, traversal units (TRVs), intersection unit (IST), and the links between them.
///
///   rays --> dispatcher --> TRV x n <--> IST
///   hits <-- dispatcher <-- TRV x n
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

  TniCore(sim::Machine& machine, const TniConfig& config, const Ideal& ideal, std::uint32_t core, sim::Clock clock);
  /// Builds the dispatcher, TRVs and IST of the T&I unit. `machine`: the one in which they were declared.
  /// `hit_interval`: minimum cycles from one returned hit to the next.
  void build_units(sim::Machine& machine, const Scene& scene, std::uint32_t hit_interval, const Links& links);

  /// Makes this T&I unit a cluster of the machine (sim/machine.h): the T&I unit, not the engine, ticks its
  /// dispatcher, TRVs and IST. The core's cache port belongs to the cluster if it has the same clock.
  void make_cluster(sim::Machine& machine, sim::UnitId port_id, CorePort& port);
  void run(const sim::ClusterTurn& turn, sim::Time now);

  /// Returns the ray dispatcher's id: the unit that accepts rays and returns hits.
  sim::UnitId dispatcher_id() const { return dispatcher_id_; }
  /// Returns the memory clients of the T&I unit: the L1 of each TRV, then the L1 of the IST.
  std::vector<MemoryClient> memory_clients() const;

  const RayDispatcher& dispatcher() const { return *dispatcher_; }
  const std::vector<Trv*>& trvs() const { return trvs_; }
  Ist& ist() const { return *ist_; }

 private:
  TniConfig config_;
  Ideal ideal_;
  sim::UnitId dispatcher_id_, ist_id_;
  std::vector<sim::UnitId> trv_ids_;
  RayDispatcher* dispatcher_ = nullptr;
  std::vector<Trv*> trvs_;
  Ist* ist_ = nullptr;
  CorePort* port_ = nullptr;  ///< the core's cache port; null if it is not in the cluster
};

/// Returns the addresses of the BVH and triangles in memory, and the links between nodes, for T&I units. `parents`:
/// result of traces::parent_indices(). Both arguments must outlive the result. Throws InputError for trees that T&I
/// units cannot traverse.
inline TniCore::Scene scene_in_memory(const traces::MemoryImage& image, std::span<const std::uint32_t> parents) {
  if (image.is_wide() || image.leaf_format != traces::LeafFormat::kTriangles) {
    throw sim::InputError(
        "bvh: T&I units traverse binary nodes and leaves of single triangles only; allowed in a simulation: "
        "bvh.width=2, bvh.format=fp32 or hybrid, bvh.leaf=triangles");
  }
  const traces::Layout& layout = image.layout;
  return {{.nodes = layout.nodes,
           .node_bytes = layout.node_bytes,
           .parents = parents,
           .single_boxes = layout.single_boxes,
           .hybrid = image.grid.has_value(),
           .links = image.nodes,
           .instances = layout.instances,
           .placed = image.instances},
          {layout.triangles, layout.triangle_bytes}};
}

}  // namespace hw
