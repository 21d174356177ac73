#include "tests/hw_models/frame/random_config.h"

#include <algorithm>
#include <array>
#include <bit>

#include "sim/config/config.h"
#include "sim/config/overloaded.h"
#include "sim/error.h"
#include "sim/hash.h"

namespace hw::testing {

namespace {

constexpr std::array<const char*, 4> kGrades = {"configs/dram/lpddr3-1600.yaml", "configs/dram/lpddr4-3200.yaml",
                                                "configs/dram/lpddr4-4266.yaml", "configs/dram/lpddr5-6400.yaml"};

class Drawing {
 public:
  Drawing(std::uint64_t seed, sim::ConfigNode& root) : seed_(seed), root_(root) {}

  void draw(sim::ConfigNode& node) {
    for (sim::ConfigNode& child : node.children) draw(child);
    const bool of_grade = node.path.starts_with("dram.timing.") || node.path.starts_with("dram.organisation.");
    const bool wanted = node.affects == sim::Affects::kTiming || node.affects == sim::Affects::kWalk;
    if (!node.is_group() && wanted && !of_grade) draw_field(node);
  }

 private:
  std::uint64_t below(std::uint64_t n) { return sim::hash(seed_, field_, draws_++) % n; }

  /// From the field's least to `most`; every other time a power of two.
  std::uint64_t number(const sim::Limits& limits, std::uint64_t most) {
    const auto low = static_cast<std::uint64_t>(limits.min);
    const auto high = static_cast<std::uint64_t>(std::min(limits.max, static_cast<double>(most)));
    if (below(4) == 0) return low;
    const std::uint64_t drawn = low + below(high - low + 1);
    return limits.power_of_two || below(2) == 0 ? std::max(low, std::bit_floor(drawn)) : drawn;
  }

  /// Gives the member a new value, and its old one back if that breaks a rule.
  template <class T>
  void change(T& member, T value) {
    const T before = member;
    member = value;
    try {
      sim::check_tree(root_);
    } catch (const sim::InputError&) {
      member = before;
    }
  }

  void draw_field(sim::ConfigNode& field) {
    const sim::Limits& limits = field.limits;
    field_ = 0;
    draws_ = 0;
    for (const char letter : field.path) field_ = sim::hash(field_, letter);
    std::visit(sim::Overloaded{
                   [&](bool* member) { change(*member, below(2) == 1); },
                   [&](std::uint32_t* member) {
                     const std::uint64_t most = field.path == "cores" ? 4 : 3 * std::uint64_t{*member} + 2;
                     change(*member, static_cast<std::uint32_t>(number(limits, most)));
                   },
                   [&](sim::Frequency* member) { change(*member, {100'000'000 + below(1'900'000'000)}); },
                   [&](sim::ByteSize* member) { change(*member, {std::bit_floor(number(limits, 2 * member->bytes))}); },
                   [&](sim::Duration* member) { change(*member, {number(limits, 3 * member->time)}); },
                   [&](sim::EnumTarget& member) { member.set(below(member.names.size())); },
                   [](auto&) {},
               },
               *field.target);
  }

  std::uint64_t seed_;
  std::uint64_t field_ = 0;  ///< hash of the field's path: a field more in the machine changes no other
  std::uint64_t draws_ = 0;  ///< for this field
  sim::ConfigNode& root_;
};

}  // namespace

GpuConfig random_config(std::uint64_t seed) {
  GpuConfig config;
  config.dram = sim::load_config<DramConfig>(kGrades[sim::hash(seed) % kGrades.size()]);
  sim::ConfigNode root = sim::config_tree(config);
  Drawing(seed, root).draw(root);
  sim::check_config(config);
  return config;
}

}  // namespace hw::testing
