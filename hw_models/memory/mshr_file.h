#pragma once
#include <cassert>
#include <cstdint>
#include <utility>
#include <vector>

#include "hw_models/memory/messages.h"

namespace hw {

/// Miss status holding registers (MSHRs, Kroft 1981): the lines on their way, and for each what waits for it. They are
/// few and dense, so a search compares them all.
template <class Payload>
class MshrFile {
 public:
  explicit MshrFile(std::uint32_t capacity) : lines_(capacity), payloads_(capacity) {}

  std::uint32_t size() const { return size_; }
  std::uint32_t capacity() const { return static_cast<std::uint32_t>(lines_.size()); }
  bool empty() const { return size_ == 0; }
  bool full() const { return size_ == lines_.size(); }

  /// The payload of the line's MSHR, or nullptr if the line is not on its way.
  Payload* find(Addr line) {
    const std::uint32_t i = index_of(line);
    return i == size_ ? nullptr : &payloads_[i];
  }

  /// Allocates an MSHR for a line that has none yet; its payload starts afresh.
  Payload& allocate(Addr line) {
    assert(!full() && find(line) == nullptr);
    lines_[size_] = line;
    payloads_[size_] = Payload{};
    return payloads_[size_++];
  }

  /// Frees the line's MSHR and returns its payload.
  Payload release(Addr line) {
    const std::uint32_t i = index_of(line);
    assert(i < size_ && "a line came back that nobody asked for");
    Payload payload = std::move(payloads_[i]);
    size_ -= 1;
    lines_[i] = lines_[size_];
    payloads_[i] = std::move(payloads_[size_]);
    return payload;
  }

 private:
  std::uint32_t index_of(Addr line) const {
    std::uint32_t i = 0;
    while (i < size_ && lines_[i] != line) ++i;
    return i;
  }

  std::vector<Addr> lines_;
  std::vector<Payload> payloads_;
  std::uint32_t size_ = 0;
};

}  // namespace hw
