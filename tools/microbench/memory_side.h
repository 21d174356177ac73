#pragma once
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "hw_models/frame/gpu_config.h"
#include "hw_models/memory/core_port.h"
#include "hw_models/memory/dram_channel.h"
#include "hw_models/memory/l2_bank.h"
#include "tools/microbench/reader.h"

namespace tools {

/// The memory side of a machine as Gpu wires it, with a Reader in the place of every first-level cache.
///
///   readers x n of each core --> core port --> L2 banks --> channels
///
/// Readers of a core: one for each traversal unit, one for the intersection unit, one for the shader core.
/// Not there: the DMA and its ports.
class MemorySide {
 public:
  explicit MemorySide(const hw::GpuConfig& config);
  MemorySide(const MemorySide&) = delete;
  MemorySide& operator=(const MemorySide&) = delete;

  Reader& reader(std::uint32_t core, std::uint32_t client) { return readers_[core * clients_ + client]; }
  std::deque<Reader>& readers() { return readers_; }
  /// Plays all reads. sim::Deadlock if they do not end.
  void run();

  // The machine, as the engine sees it.
  void each_unit(auto&& f) {
    std::size_t i = 0;
    for (Reader& unit : readers_) f(unit, i++);
    for (hw::CorePort& unit : ports_) f(unit, i++);
    for (hw::L2Bank& unit : banks_) f(unit, i++);
    for (hw::DramChannel& unit : channels_) f(unit, i++);
  }
  sim::Wakes& wakes() { return wakes_; }
  bool done() const;
  std::string state() const;

 private:
  struct Wiring;
  void add_core(Wiring& wiring, const hw::GpuConfig& config, std::uint32_t core);

  const std::uint32_t clients_;
  std::deque<sim::Link<hw::MemRequest>> requests_;
  std::deque<sim::Link<hw::MemResponse>> responses_;
  std::deque<Reader> readers_;
  std::deque<hw::CorePort> ports_;
  std::deque<hw::L2Bank> banks_;
  std::deque<hw::DramChannel> channels_;
  sim::Wakes wakes_;
};

}  // namespace tools
