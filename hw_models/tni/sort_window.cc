#include "hw_models/tni/sort_window.h"

#include <algorithm>
#include <cassert>

namespace hw {

std::uint64_t SortWindow::insert_ray(const RayJob& job, std::uint64_t cycle) {
  assert(!is_full());
  if (entries_.empty()) oldest_ = cycle;
  const auto at = std::upper_bound(entries_.begin(), entries_.end(), job.key,
                                   [](std::uint32_t key, const Entry& entry) { return key < entry.job.key; });
  const auto moved = static_cast<std::uint64_t>(entries_.end() - at);
  entries_.insert(at, {job, cycle, arrivals_++});
  return moved;
}

SortWindow::Sent SortWindow::remove_next(std::uint64_t cycle) {
  assert(!is_empty());
  auto next = entries_.end();
  if (cycle - oldest_ >= timeout_) {
    next = std::ranges::min_element(entries_, {}, &Entry::number);
    oldest_ = next->arrived;
    if (cycle - oldest_ < timeout_) next = entries_.end();
  }
  Sent sent;
  sent.timed_out = next != entries_.end();
  if (!sent.timed_out) {
    next = std::lower_bound(entries_.begin(), entries_.end(), last_key_,
                            [](const Entry& entry, std::uint32_t key) { return entry.job.key < key; });
    if (next == entries_.end()) next = entries_.begin();
    last_key_ = next->job.key;
  }
  sent.job = next->job;
  sent.moved = static_cast<std::uint64_t>(entries_.end() - next) - 1;
  entries_.erase(next);
  return sent;
}

}  // namespace hw
