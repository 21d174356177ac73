#include "hw_models/machines/livelock_timeout.h"

#include <algorithm>

namespace hw {
namespace {

/// Safety factor of the livelock timeout, for effects that its formula ignores. The value is an assumption.
constexpr sim::Time kMargin = 8;
/// Upper limit of the livelock timeout: longer than any frame, and small enough for arithmetic without overflow.
constexpr sim::Time kLongest = 1000 * sim::kFemtosecondsPerSecond;
/// Upper bound of the memory lines that a unit reads one after another for one item, such as a ray's visit to a BVH
/// node. No record in memory has more lines.
constexpr sim::Time kLines = 16;

sim::Time longest_chunk_time(const GpuConfig& config, std::span<const KernelSchedule> kernels,
                             std::span<const BankConflicts> conflicts) {
  sim::Time cycles = 0;
  for (std::size_t k = 0; k < kernels.size(); ++k) {
    const sim::Time items = config.srp.chunk;
    cycles = std::max(cycles, items * kernels[k].ii + kernels[k].depth + conflicts[k].stall_cycles(config.srp.chunk) +
                                  config.srp.load_cycles(kernels[k].ii));
  }
  return (cycles + config.srp.switch_cycles) * config.clocks.srp.clock().period();
}

/// Returns the latency from a core to a DRAM channel and back when all queues are empty.
sim::Time round_trip_latency(const GpuConfig& config) {
  const sim::Time crossings = 8, synchroniser = config.clocks.synchroniser + 1;
  const sim::Time l2 = 2 * config.interconnect.latency + config.l2.lookup_cycles + config.l2.cache.hit_cycles +
                       2 * config.interconnect.cycles_of(kLineBytes) + crossings * synchroniser;
  const sim::Time slice = config.slc.is_present() ? config.slc.lookup_cycles + config.slc.cache.hit_cycles : 0;
  const sim::Time tni = config.direct_interface.interval + crossings * synchroniser;
  return (l2 + slice) * config.clocks.l2.clock().period() + tni * config.clocks.tni.clock().period() +
         config.dram.fabric.time;
}

/// Returns the worst-case latency of a line in a DRAM channel that serves no other request.
sim::Time worst_line_latency(const DramConfig& dram) {
  const DramTiming& t = dram.timing;
  const sim::Time cycles = std::max(t.rfc_ab, t.rfc_pb) + t.xp + t.rp_ab + t.rc + t.rcd + t.rl + t.dqsck + t.wr +
                           t.wtr_l + t.faw + dram.bursts_per_line() * t.ccd_l;
  return cycles * t.ck.time;
}

/// Returns the maximum number of memory requests in flight in the GPU.
sim::Time max_requests(const GpuConfig& config) {
  const sim::Time core = config.tni.trvs * config.tni.trv.l1.mshrs + config.tni.ist.l1.mshrs +
                         config.srp.data_cache.mshrs + config.dma.depth +
                         2 * (config.tni.trvs + 4) * config.interconnect.link_depth;
  const sim::Time channel = config.dram.controller.read_queue + config.dram.controller.write_queue;
  const sim::Time slices = config.slc.is_present() ? config.slc.cache.mshrs : 0;
  return config.cores * core + config.dram.channels * channel + config.l2.cache.mshrs + slices;
}

}  // namespace

sim::Time livelock_timeout(const GpuConfig& config, std::span<const KernelSchedule> kernels,
                           std::span<const BankConflicts> conflicts) {
  if (config.watchdog != 0) return config.watchdog * config.clocks.tni.clock().period();
  const sim::Time memory =
      kLines * (round_trip_latency(config) + max_requests(config) * worst_line_latency(config.dram));
  const sim::Time item = longest_chunk_time(config, kernels, conflicts) + memory;
  return kMargin * std::min(item, kLongest / kMargin);
}

}  // namespace hw
