#pragma once
#include <cstdint>
#include <vector>

#include "hw_models/machines/memory_system.h"
#include "tools/studies/microbench/reader.h"

namespace tools {

/// The memory side of a machine with a Reader in the place of every first-level cache. Readers of a core: one for each
/// traversal unit, one for the intersection unit, one for the shader core.
class MemorySide {
 public:
  /// `config` must outlive it.
  explicit MemorySide(const hw::GpuConfig& config);
  MemorySide(const MemorySide&) = delete;
  MemorySide& operator=(const MemorySide&) = delete;

  Reader& reader(std::uint32_t core, std::uint32_t client) { return *readers_[core * clients_ + client]; }
  const std::vector<Reader*>& readers() const { return readers_; }
  /// Plays all reads. sim::Deadlock if they do not end.
  void run();

  // As the engine sees it.
  sim::Machine& machine() { return machine_; }
  bool done() const;

 private:
  const std::uint32_t clients_;
  sim::Machine machine_;
  hw::MemorySystem memory_;
  std::vector<Reader*> readers_;
};

}  // namespace tools
