#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "traces/stream.h"

namespace hw {

/// The configuration memory of the array: kernels whose rows it holds. When those of another do not fit, the kernel
/// that has not run for the longest time makes room. Rows of a kernel may lie anywhere, so that room is never broken
/// up.
class ConfigMemory {
 public:
  ConfigMemory(std::uint64_t bytes, std::size_t kernels) : free_(bytes) { resident_.reserve(kernels); }

  /// The kernel, which takes `bytes`, runs next. True if it is resident; else it is loaded, and stays if the memory can
  /// hold it at all.
  bool use(traces::KernelId kernel, std::uint64_t bytes) {
    const auto found = std::ranges::find(resident_, kernel, &Resident::kernel);
    if (found != resident_.end()) {
      std::rotate(found, found + 1, resident_.end());
      return true;
    }
    std::size_t leave = 0;
    for (; free_ < bytes && leave < resident_.size(); ++leave) free_ += resident_[leave].bytes;
    resident_.erase(resident_.begin(), resident_.begin() + static_cast<std::ptrdiff_t>(leave));
    if (bytes > free_) return false;
    free_ -= bytes;
    resident_.push_back({kernel, bytes});
    return false;
  }

 private:
  struct Resident {
    traces::KernelId kernel = 0;
    std::uint64_t bytes = 0;
  };
  std::uint64_t free_;
  std::vector<Resident> resident_;  ///< the one that ran last, last
};

}  // namespace hw
