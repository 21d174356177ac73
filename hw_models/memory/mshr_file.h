#pragma once
#include <cassert>
#include <cstdint>
#include <numeric>
#include <vector>

#include "hw_models/memory/messages.h"

namespace hw {

/// Miss status holding registers (MSHRs, Kroft 1981): the lines on their way, and for each what waits for it. They are
/// few and dense, so a search compares them all. Payloads stay where they are while their lines move up.
template <class Payload>
class MshrFile {
 public:
  explicit MshrFile(std::uint32_t capacity) : lines_(capacity), payloads_(capacity + 1), slots_(capacity + 1) {
    std::iota(slots_.begin(), slots_.end(), 0U);
  }

  std::uint32_t size() const { return size_; }
  std::uint32_t capacity() const { return static_cast<std::uint32_t>(lines_.size()); }
  bool empty() const { return size_ == 0; }
  bool full() const { return size_ == lines_.size(); }

  /// The payload of the line's MSHR, or nullptr if the line is not on its way.
  Payload* find(Addr line) {
    const std::uint32_t i = index_of(line);
    return i == size_ ? nullptr : &payloads_[slots_[i]];
  }

  /// Allocates an MSHR for a line that has none yet; its payload is as an earlier line left it.
  Payload& allocate(Addr line) {
    assert(!full() && find(line) == nullptr);
    lines_[size_] = line;
    return payloads_[slots_[size_++]];
  }

  /// Calls f(payload) for each line on its way.
  void each(auto&& f) const {
    for (std::uint32_t i = 0; i < size_; ++i) f(payloads_[slots_[i]]);
  }

  /// Frees the line's MSHR; its payload stays as it is until the next release.
  const Payload& release(Addr line) {
    const std::uint32_t i = index_of(line);
    assert(i < size_ && "a line came back that nobody asked for");
    const std::uint32_t freed = slots_[i];
    size_ -= 1;
    lines_[i] = lines_[size_];
    slots_[i] = slots_[size_];
    slots_[size_] = slots_.back();
    slots_.back() = freed;
    return payloads_[freed];
  }

 private:
  std::uint32_t index_of(Addr line) const {
    std::uint32_t i = 0;
    while (i < size_ && lines_[i] != line) ++i;
    return i;
  }

  std::vector<Addr> lines_;
  std::vector<Payload> payloads_;
  std::vector<std::uint32_t> slots_;  ///< by line: its payload; behind all of them that of the last release
  std::uint32_t size_ = 0;
};

}  // namespace hw
