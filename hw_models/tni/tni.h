#pragma once
#include <deque>
#include <memory>
#include <vector>

#include "hw_models/tni/ist.h"
#include "hw_models/tni/ray_dispatcher.h"
#include "hw_models/tni/trv.h"

namespace hw {

/// A whole traversal & intersection unit: dispatcher, TRVs, IST and the links between them.
///
///   rays --> dispatcher --> TRV x n <--> IST
///   hits <-- dispatcher <-- TRV x n
///
/// It needs one pair of memory links per L1: one for each TRV, then one for the IST.
class Tni {
 public:
  struct Scene {
    TreeInMemory tree;
    TrianglesInMemory triangles;
  };
  /// Made ideal, for bounds (ideal.*).
  struct Ideal {
    bool tni = false;  ///< 64 rays a TRV, 64 leaves, any number of operations a cycle, each in one cycle
    bool l1 = false;   ///< every probe hits
  };
  struct Links {
    sim::Link<RayJob>& rays_in;
    sim::Link<RayDone>& hits_out;
    std::vector<sim::Link<MemRequest>*> memory_out;
    std::vector<sim::Link<MemResponse>*> memory_in;
  };

  Tni(const TniConfig& config, const Ideal& ideal, const Scene& scene, std::uint32_t hit_interval, const Links& links,
      sim::Clock clock);
  Tni(const Tni&) = delete;
  Tni& operator=(const Tni&) = delete;

  RayDispatcher& dispatcher() { return *dispatcher_; }
  std::deque<Trv>& trvs() { return trvs_; }
  Ist& ist() { return *ist_; }
  const RayDispatcher& dispatcher() const { return *dispatcher_; }
  const std::deque<Trv>& trvs() const { return trvs_; }
  const Ist& ist() const { return *ist_; }

  /// Connects the inner links to the engine's wake array, given each unit's entry.
  void wakes(sim::Waker dispatcher, sim::Waker ist, const std::vector<sim::Waker>& trvs);

 private:
  std::deque<sim::Link<RayJob>> to_trv_;
  std::deque<sim::Link<RayDone>> from_trv_;
  std::deque<sim::Link<LeafJob>> to_ist_;
  std::deque<sim::Link<LeafDone>> from_ist_;
  std::deque<Trv> trvs_;
  std::unique_ptr<Ist> ist_;
  std::unique_ptr<RayDispatcher> dispatcher_;
};

}  // namespace hw
