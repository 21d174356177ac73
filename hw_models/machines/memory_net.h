#pragma once
#include <cstdint>
#include <deque>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "hw_models/machines/gpu_config.h"
#include "hw_models/memory/core_port.h"
#include "hw_models/memory/dram_channel.h"
#include "hw_models/memory/l2_bank.h"
#include "sim/wakes.h"

namespace hw {

/// The memory side of a machine as Gpu wires it, for clients of any kind.
///
///   clients x n of each core --> core port --> L2 banks --> channels
///
/// Not there: the DMA and its ports.
class MemoryNet {
 public:
  /// Who asks for lines: its clock, and the lines that may be on their way to it.
  struct Client {
    sim::Clock clock;
    std::uint32_t lines = 1;
  };
  /// The net's units() units have the places from `first` on in `wakes`, in the order of each_unit;
  /// `wake_of(core, client)`: of a client.
  MemoryNet(const GpuConfig& config, std::span<const Client> clients, sim::Wakes& wakes, std::size_t first,
            const std::function<sim::Waker(std::uint32_t, std::uint32_t)>& wake_of);
  MemoryNet(const MemoryNet&) = delete;
  MemoryNet& operator=(const MemoryNet&) = delete;

  static std::size_t units(const GpuConfig& config) {
    return std::size_t{config.cores} + config.l2.banks + config.dram.channels;
  }
  sim::Link<MemRequest>& requests(std::uint32_t core, std::uint32_t client) {
    return *requests_of_[core * clients_ + client];
  }
  sim::Link<MemResponse>& responses(std::uint32_t core, std::uint32_t client) {
    return *responses_of_[core * clients_ + client];
  }
  const std::deque<CorePort>& ports() const { return ports_; }
  const std::deque<L2Bank>& banks() const { return banks_; }
  const std::deque<DramChannel>& channels() const { return channels_; }
  /// Nothing is under way.
  bool quiet() const;
  std::string state() const;

  /// As the engine sees it, from place `i` on.
  void each_unit(auto&& f, std::size_t i) {
    for (CorePort& unit : ports_) f(unit, i++);
    for (L2Bank& unit : banks_) f(unit, i++);
    for (DramChannel& unit : channels_) f(unit, i++);
  }

 private:
  struct Wiring;

  const std::uint32_t clients_;
  std::deque<sim::Link<MemRequest>> requests_;
  std::deque<sim::Link<MemResponse>> responses_;
  std::vector<sim::Link<MemRequest>*> requests_of_;
  std::vector<sim::Link<MemResponse>*> responses_of_;
  std::deque<CorePort> ports_;
  std::deque<L2Bank> banks_;
  std::deque<DramChannel> channels_;
};

}  // namespace hw
