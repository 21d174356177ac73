#pragma once
#include <cstdint>

#include "hw_models/srp/messages.h"
#include "sim/time.h"
#include "traces/stream.h"

namespace hw {

/// A loop on the array of a shader core, from switch to drain.
struct ObservedLoop {
  traces::KernelId kernel = 0;
  sim::Time begin = 0, configured = 0, start = 0, end = 0;  ///< switch, bank conflicts, the loop itself
  sim::Time stalled = 0;                                    ///< within the loop, for lines of the data cache
  std::uint64_t cycles = 0;                                 ///< those of the shader core that are charged to the kernel
  std::uint32_t items = 0;
  std::uint32_t launches = 0;  ///< chunks of launches in it
  Owner tile = kNoOwner;       ///< that of the first
};

/// Is told what cores do while they do it, and changes nothing. Tiles are named as their book names them.
class Observer {
 public:
  virtual ~Observer() = default;
  /// A tile takes a slot of a core, and leaves it.
  virtual void tile_begins(std::uint32_t core, std::uint32_t slot, Owner tile, sim::Time now) = 0;
  virtual void tile_ends(std::uint32_t core, std::uint32_t slot, sim::Time now) = 0;
  virtual void loop_ends(std::uint32_t core, const ObservedLoop& loop) = 0;
  /// The first ray of a batch goes into the T&I unit; its last hit is back. `rays`: all that are then in the unit.
  virtual void batch_begins(std::uint32_t core, std::uint32_t slot, std::uint32_t node, std::uint64_t rays,
                            sim::Time now) = 0;
  virtual void batch_ends(std::uint32_t core, std::uint32_t slot, std::uint32_t node, const traces::WorkNode& batch,
                          std::uint64_t rays, sim::Time now) = 0;
  virtual void transfer_ends(std::uint32_t core, const DmaJob& job, sim::Time begin, sim::Time end) = 0;
};

}  // namespace hw
