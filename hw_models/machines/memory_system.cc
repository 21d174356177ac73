#include "hw_models/machines/memory_system.h"

#include <string>

namespace hw {
namespace {

constexpr std::uint32_t kIdealDepth = 256;  // capacity of a link of an ideal interconnect: more messages than can be in
                                            // flight

}  // namespace

MemorySystem::MemorySystem(sim::Machine& machine, const GpuConfig& config, Dma dma, const DramPerturbation& shift,
                           Observer* observer)
    : machine_(machine),
      config_(config),
      dma_(dma),
      shift_(shift),
      observer_(observer),
      clock_(config.clocks.l2.clock()),
      distance_(config.ideal.interconnect ? 1 : config.interconnect.latency),
      link_depth_(config.ideal.interconnect ? kIdealDepth : config.interconnect.link_depth) {
  const std::uint64_t bytes = config.l2.cache.size.bytes;
  for (std::uint32_t b = 0; b < config.l2.banks; ++b) {
    declared_banks_.push_back(
        {machine.unit({L2Bank::kName + std::to_string(b), clock_, 0, bytes / config.l2.banks, bytes})});
  }
  const sim::Clock dram(config.dram.timing.ck.time);
  for (std::uint32_t k = 0; k < config.dram.channels; ++k) {
    declared_channels_.push_back({machine.unit({.name = DramChannel::kName + std::to_string(k),
                                                .clock = dram,
                                                .data_lines = config.dram.organisation.width})});
  }
  const std::uint64_t system_bytes = config.slc.cache.size.bytes;
  for (std::uint32_t k = 0; config.slc.is_present() && k < config.dram.channels; ++k) {
    declared_slices_.push_back({machine.unit(
        {SystemCacheSlice::kName + std::to_string(k), clock_, 0, system_bytes / config.dram.channels, system_bytes})});
  }
  for (Bank& bank : declared_banks_) link_to_memory(bank);
  link_slices_to_channels();
}

void MemorySystem::declare_ports() {
  const auto core = static_cast<std::uint32_t>(cache_ports_.size());
  cache_ports_.push_back({machine_.unit({unit_name_in_core(CorePort::kCachePort, core), clock_, core + 1})});
  link_to_banks(cache_ports_.back());
  if (dma_ == Dma::kNo) return;
  dma_ports_.push_back({machine_.unit({unit_name_in_core(CorePort::kDmaPort, core), clock_, core + 1})});
  link_to_channels(dma_ports_.back());
}

/// Links an L2 bank to the slices of the system cache, or to the DRAM channels if there is no system cache.
void MemorySystem::link_to_memory(Bank& bank) {
  const auto link = [&](sim::UnitId target, auto& requests, auto& lines) {
    auto& up = machine_.link<MemRequest>(link_depth_ + 1, 1, bank.unit, target);
    auto& down = machine_.link<MemResponse>(link_depth_ + 1, 1, target, bank.unit);
    bank.links.channels_out.push_back(&up);
    bank.links.channels_in.push_back(&down);
    requests.push_back(&up);
    lines.push_back(&down);
  };
  for (Bank& slice : declared_slices_) link(slice.unit, slice.links.cores_in, slice.links.cores_out);
  if (has_slices()) return;
  for (Channel& channel : declared_channels_) link(channel.unit, channel.links.ports_in, channel.links.ports_out);
}

void MemorySystem::link_slices_to_channels() {
  for (std::size_t k = 0; k < declared_slices_.size(); ++k) {
    Bank& slice = declared_slices_[k];
    Channel& channel = declared_channels_[k];
    auto& up = machine_.link<MemRequest>(link_depth_ + 1, 1, slice.unit, channel.unit);
    auto& down = machine_.link<MemResponse>(link_depth_ + 1, 1, channel.unit, slice.unit);
    slice.links.channels_out.push_back(&up);
    slice.links.channels_in.push_back(&down);
    channel.links.ports_in.push_back(&up);
    channel.links.ports_out.push_back(&down);
  }
}

std::vector<sim::Link<Flush>*> MemorySystem::add_background_sources(sim::UnitId from) {
  std::vector<sim::Link<Flush>*> ends;
  if (config_.background.rate == 0) return ends;
  const sim::Clock clock(config_.dram.timing.ck.time);
  for (Channel& channel : declared_channels_) {
    const auto number = std::to_string(declared_sources_.size());
    const sim::UnitId unit = machine_.unit({BackgroundSource::kName + number, clock});
    auto& up = machine_.link<MemRequest>(link_depth_ + 1, 1, unit, channel.unit);
    auto& down = machine_.link<MemResponse>(link_depth_ + 1, 1, channel.unit, unit);
    auto& end = machine_.link<Flush>(1, 1, from, unit);
    channel.links.ports_in.push_back(&up);
    channel.links.ports_out.push_back(&down);
    declared_sources_.push_back({unit, {up, down, end}});
    ends.push_back(&end);
  }
  return ends;
}

void MemorySystem::build_background_sources() {
  const DramConfig& dram = config_.dram;
  const std::uint64_t bytes =
      std::uint64_t{dram.organisation.all_banks()} * dram.organisation.rows * dram.organisation.page.bytes;
  const bool by_page = dram.controller.mapping == DramMapping::kRowBankChannelColumn;
  for (std::uint32_t k = 0; k < declared_sources_.size(); ++k) {
    const BackgroundSource::ChannelMapping place{.channel = k,
                                                 .channels = dram.channels,
                                                 .line_bytes = dram.line.bytes,
                                                 .granule = by_page ? dram.organisation.page.bytes : dram.line.bytes,
                                                 .lines = bytes / dram.line.bytes};
    machine_.build<BackgroundSource>(declared_sources_[k].unit, config_.background, place, declared_sources_[k].links,
                                     sim::Clock(dram.timing.ck.time));
  }
}

void MemorySystem::link_to_banks(Port& cache) {
  const std::uint32_t depth = link_depth_ + distance_;
  const auto by_latency = sim::Lookahead::kByLatency;
  const std::size_t requests = config_.ideal.interconnect ? depth : 1,
                    lines = config_.ideal.l2 ? depth : L2Bank::kMaxLinesPerTick;
  for (Bank& bank : declared_banks_) {
    auto& up = machine_.link<MemRequest>(depth, distance_, cache.unit, bank.unit, by_latency, requests);
    auto& down = machine_.link<MemResponse>(depth, distance_, bank.unit, cache.unit, by_latency, lines);
    cache.links.targets_out.push_back(&up);
    cache.links.targets_in.push_back(&down);
    bank.links.cores_in.push_back(&up);
    bank.links.cores_out.push_back(&down);
  }
}

/// Links a core's DMA port to the DRAM channels. Both directions have the same latency; towards the core it is rounded
/// up to whole DRAM cycles.
void MemorySystem::link_to_channels(Port& dma) {
  const sim::Time cycle = config_.dram.timing.ck.time;
  const auto down_distance = static_cast<std::uint32_t>((distance_ * clock_.period() + cycle - 1) / cycle);
  const std::uint32_t depth = link_depth_ + distance_;
  const auto by_latency = sim::Lookahead::kByLatency;
  const std::size_t requests = config_.ideal.interconnect ? depth : 1;
  for (Bank& slice : declared_slices_) {
    auto& up = machine_.link<MemRequest>(depth, distance_, dma.unit, slice.unit, by_latency, requests);
    auto& down =
        machine_.link<MemResponse>(depth, distance_, slice.unit, dma.unit, by_latency, L2Bank::kMaxLinesPerTick);
    dma.links.targets_out.push_back(&up);
    dma.links.targets_in.push_back(&down);
    slice.links.cores_in.push_back(&up);
    slice.links.cores_out.push_back(&down);
  }
  if (has_slices()) return;
  const std::size_t lines = config_.ideal.dram ? depth : DramChannel::kMaxLinesPerTick;
  for (Channel& channel : declared_channels_) {
    auto& up = machine_.link<MemRequest>(depth, distance_, dma.unit, channel.unit, by_latency, requests);
    auto& down = machine_.link<MemResponse>(depth, down_distance, channel.unit, dma.unit, by_latency, lines);
    dma.links.targets_out.push_back(&up);
    dma.links.targets_in.push_back(&down);
    channel.links.ports_in.push_back(&up);
    channel.links.ports_out.push_back(&down);
  }
}

MemoryPort MemorySystem::add_client(Port& port, const MemoryClient& client, std::uint32_t request_depth) {
  auto& up = machine_.link<MemRequest>(request_depth, 1, client.unit, port.unit);
  auto& down = machine_.link<MemResponse>(client.lines, 1, port.unit, client.unit);
  port.links.clients_in.push_back(&up);
  port.links.clients_out.push_back(&down);
  port.links.requesters.push_back(client.requester);
  return {up, down, static_cast<std::uint16_t>(port.links.clients_in.size() - 1)};
}

MemoryPort MemorySystem::add_cache_client(std::uint32_t core, const MemoryClient& one) {
  return add_client(cache_ports_[core], one, config_.ideal.interconnect ? kIdealDepth : kRequestDepth);
}

std::vector<MemoryPort> MemorySystem::add_cache_clients(std::uint32_t core, std::span<const MemoryClient> clients) {
  std::vector<MemoryPort> all;
  for (const MemoryClient& one : clients) all.push_back(add_cache_client(core, one));
  return all;
}

MemoryPort MemorySystem::add_dma_client(std::uint32_t core, sim::UnitId dma) {
  return add_client(dma_ports_[core], {dma, config_.dma.depth, RequesterKind::kTransfers}, config_.dma.depth);
}

std::vector<sim::Link<Flush>*> MemorySystem::create_flush_links(sim::UnitId from) {
  std::vector<sim::Link<Flush>*> all;
  for (Bank& bank : declared_banks_) all.push_back(bank.links.flush_in = &machine_.link<Flush>(1, 1, from, bank.unit));
  return all;
}

CorePort& MemorySystem::build_ports(std::uint32_t core) {
  const auto build = [&](Port& port, Interleave targets) -> CorePort& {
    port.links.observer = observer_;
    return *built_ports_.emplace_back(&machine_.build<CorePort>(port.unit, config_.interconnect, port.links, targets,
                                                                clock_, config_.l2.cache.line.bytes,
                                                                config_.ideal.interconnect));
  };
  CorePort& caches = build(cache_ports_[core], config_.l2.bank_interleave());
  if (dma_ == Dma::kYes) build(dma_ports_[core], config_.dram.channel_interleave());
  return caches;
}

void MemorySystem::build_banks_and_channels() {
  for (Bank& bank : declared_banks_) {
    bank.links.observer = observer_;
    banks_.push_back(&machine_.build<L2Bank>(bank.unit, config_.l2, static_cast<std::uint16_t>(banks_.size()),
                                             bank.links, config_.dram.channel_interleave(), clock_,
                                             config_.interconnect.arbitration, config_.ideal.l2));
  }
  // Slices have no observer: they are L2 banks, and observers would count their look-ups as those of the L2.
  for (std::uint32_t k = 0; k < declared_slices_.size(); ++k) {
    slices_.push_back(&machine_.build<SystemCacheSlice>(
        declared_slices_[k].unit, config_.slc.slice_config(config_.dram.channels), static_cast<std::uint16_t>(k),
        declared_slices_[k].links, Interleave(config_.dram.line.bytes, 1), clock_, config_.interconnect.arbitration));
  }
  build_background_sources();
  for (Channel& channel : declared_channels_) {
    channel.links.observer = observer_;
    channels_.push_back(
        &machine_.build<DramChannel>(channel.unit, config_.dram, channel.links, config_.ideal.dram, shift_));
  }
}

}  // namespace hw
