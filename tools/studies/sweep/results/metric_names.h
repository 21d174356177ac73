#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace tools::results {

/// Numbers the paths of metrics in the order in which they are first met.
class MetricNames {
 public:
  std::uint32_t number_of(std::string_view path) {
    if (const auto found = numbers_.find(path); found != numbers_.end()) return found->second;
    const auto number = static_cast<std::uint32_t>(names_.size());
    numbers_.emplace(path, number);
    names_.emplace_back(path);
    return number;
  }
  const std::vector<std::string>& names() const { return names_; }

 private:
  struct Hash {
    using is_transparent = void;
    std::size_t operator()(std::string_view text) const { return std::hash<std::string_view>()(text); }
  };
  std::unordered_map<std::string, std::uint32_t, Hash, std::equal_to<>> numbers_;
  std::vector<std::string> names_;
};

}  // namespace tools::results
