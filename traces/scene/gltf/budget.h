#pragma once
#include <cstdint>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "sim/config/quantity.h"
#include "sim/error.h"

namespace traces::gltf {

/// The memory that a glTF file may still use, so that a small file cannot demand a huge scene.
class Budget {
 public:
  Budget(std::string file, std::uint64_t bytes) : file_(std::move(file)), limit_(bytes), left_(bytes) {}

  /// Takes memory from the budget. Call before allocating. Throws InputError if not enough is left.
  void take_memory(std::uint64_t count, std::uint64_t bytes_each, std::string_view what) {
    if (count != 0 && bytes_each > left_ / count) {
      throw sim::InputError(
          fmt::format("{}: {} would take {} x {} bytes, more than is left of the limit of {}; allowed: a larger "
                      "limits.memory",
                      file_, what, count, bytes_each, sim::quantity_text(limit_, sim::byte_units())));
    }
    left_ -= count * bytes_each;
  }

  std::uint64_t bytes_left() const { return left_; }

 private:
  std::string file_;
  std::uint64_t limit_, left_;
};

}  // namespace traces::gltf
