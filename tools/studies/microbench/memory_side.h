#pragma once
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "hw_models/machines/memory_net.h"
#include "tools/studies/microbench/reader.h"

namespace tools {

/// The memory side of a machine with a Reader in the place of every first-level cache. Readers of a core: one for each
/// traversal unit, one for the intersection unit, one for the shader core.
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
    net_.each_unit(f, i);
  }
  sim::Wakes& wakes() { return wakes_; }
  bool done() const;
  std::string state() const { return net_.state(); }

 private:
  const std::uint32_t clients_;
  sim::Wakes wakes_;
  hw::MemoryNet net_;
  std::deque<Reader> readers_;
};

}  // namespace tools
