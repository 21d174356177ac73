#include "tests/hw_models/machines/random_config.h"

#include <algorithm>
#include <array>
#include <bit>

#include "sim/config/config.h"
#include "sim/config/config_tree.h"
#include "sim/error.h"
#include "sim/hash.h"

namespace hw::test {

namespace {

constexpr std::array<const char*, 4> kGrades = {"configs/dram/lpddr3-1600.yaml", "configs/dram/lpddr4-3200.yaml",
                                                "configs/dram/lpddr4-4266.yaml", "configs/dram/lpddr5-6400.yaml"};

/// Distance of a field's value from its default.
enum class Range : std::uint8_t {
  kWild,  ///< anywhere within its limits, up to about three times the default
  kSane,  ///< half to double the default; nothing is ideal
};

/// Trees for which a machine is drawn. With binary trees a machine has one or two box testers and one intersection
/// unit.
enum class Trees : std::uint8_t { kBinary, kWide };

bool is_drawn(const sim::ConfigNode& field, Range range, Trees trees) {
  const auto within = [&](const char* group) { return field.path.starts_with(group); };
  if (trees == Trees::kBinary && field.path == "tni.ists") return false;
  if (field.affects != sim::Affects::kTiming && field.affects != sim::Affects::kWalk) return false;
  if (range == Range::kSane && within("ideal.")) return false;
  const bool of_grade = within("dram.timing.") || within("dram.organisation.");
  return !of_grade || field.path == "dram.organisation.ranks" || field.path == "dram.organisation.bl32";
}

class Drawing {
 public:
  Drawing(std::uint64_t seed, Range range, Trees trees, sim::ConfigNode& root)
      : seed_(seed), range_(range), trees_(trees), root_(root) {}

  void draw(sim::ConfigNode& node) {
    for (sim::ConfigNode& child : node.children) draw(child);
    if (!node.is_group() && is_drawn(node, range_, trees_)) draw_field(node);
  }

 private:
  std::uint64_t below(std::uint64_t n) { return sim::hash(seed_, field_, draws_++) % n; }

  /// Returns a value from the field's minimum to `most`. Half of all values are powers of two.
  std::uint64_t number(const sim::Limits& limits, std::uint64_t most) {
    const auto low = static_cast<std::uint64_t>(limits.min);
    const auto high = static_cast<std::uint64_t>(std::min(limits.max, static_cast<double>(most)));
    if (below(4) == 0) return low;
    const std::uint64_t drawn = low + below(high - low + 1);
    return limits.power_of_two || below(2) == 0 ? std::max(low, std::bit_floor(drawn)) : drawn;
  }

  /// Returns half, once or twice the default, within the field's limits. Once is twice as likely.
  std::uint64_t near(const sim::Limits& limits, std::uint64_t usual) {
    const std::uint64_t drawn = usual << below(2) >> below(2);
    return static_cast<std::uint64_t>(std::clamp(static_cast<double>(drawn), limits.min, limits.max));
  }

  /// Returns how many of the last names of an enum are not drawn: parent links for binary trees; mechanisms of the
  /// T&I unit that are not always faster, for sane machines.
  std::size_t undrawn_names(const std::string& path) const {
    if (trees_ == Trees::kBinary && path == "tni.trv.stack") return 1;
    if (range_ != Range::kSane) return 0;
    if (path == "tni.trv.prefetch") return 2;
    return path == "tni.trv.gather" || path == "tni.dispatcher.sort" ? 1 : 0;
  }

  /// Sets a field to a new value, and restores the old one if the new one violates a rule.
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
    const bool sane = range_ == Range::kSane;
    std::visit(sim::Overloaded{
                   [&](bool* member) { change(*member, below(2) == 1); },
                   [&](std::uint32_t* member) {
                     const bool two = trees_ == Trees::kBinary && field.path == "tni.trv.box_testers";
                     const std::uint64_t most = field.path == "cores" ? 4 : two ? 2 : 3 * std::uint64_t{*member} + 2;
                     const std::uint64_t drawn = sane ? near(limits, *member) : number(limits, most);
                     change(*member, static_cast<std::uint32_t>(drawn));
                   },
                   [&](sim::AutoCount* member) {
                     const std::uint64_t most = 3 * std::uint64_t{member->value} + 2;
                     const std::uint64_t drawn = sane ? near(limits, member->value) : number(limits, most);
                     change(*member, sim::AutoCount(static_cast<std::uint32_t>(drawn)));
                   },
                   [&](sim::Frequency* member) {
                     change(*member, {sane ? near(limits, member->hz) : 100'000'000 + below(1'900'000'000)});
                   },
                   [&](sim::ByteSize* member) {
                     change(*member,
                            {std::bit_floor(sane ? near(limits, member->bytes) : number(limits, 2 * member->bytes))});
                   },
                   [&](sim::Duration* member) {
                     change(*member, {sane ? near(limits, member->time) : number(limits, 3 * member->time)});
                   },
                   [&](sim::EnumTarget& member) {
                     const std::size_t before = member.get();
                     member.set(below(member.names.size() - undrawn_names(field.path)));
                     try {
                       sim::check_tree(root_);
                     } catch (const sim::InputError&) {
                       member.set(before);
                     }
                   },
                   [](auto&) {},
               },
               *field.target);
  }

  std::uint64_t seed_;
  Range range_;
  Trees trees_;
  std::uint64_t field_ = 0;  ///< hash of the field's path; values therefore do not depend on other fields
  std::uint64_t draws_ = 0;  ///< number of values drawn for this field
  sim::ConfigNode& root_;
};

GpuConfig drawn(std::uint64_t seed, Range range, Trees trees = Trees::kBinary) {
  GpuConfig config;
  config.dram = sim::load_config<DramConfig>(kGrades[sim::hash(seed) % kGrades.size()]);
  sim::ConfigNode root = sim::config_tree(config);
  Drawing(seed, range, trees, root).draw(root);
  // Groups of rays exclude values of other keys, so that one in eight of the wild machines has them.
  const bool has_groups = range == Range::kWild && sim::hash(seed, 1U) % 8 == 0;
  config.tni.trv.gather = has_groups ? Gather::kNode : Gather::kOff;
  if (has_groups) {
    config.tni.miss_handling = MissHandling::kReorder;
    config.tni.trv.box_testers = std::max(2U, config.tni.trv.box_testers);
  }
  sim::check_config(config);
  return config;
}

}  // namespace

GpuConfig random_config(std::uint64_t seed) { return drawn(seed, Range::kWild); }
GpuConfig random_wide_config(std::uint64_t seed) {
  GpuConfig config = drawn(seed, Range::kWild, Trees::kWide);
  TrvConfig& trv = config.tni.trv;
  const TreeKind slowest{.wide = true, .format = traces::NodeFormat::kQ8, .slots = traces::kMaxWidth};
  const std::uint32_t pipe = trv.l1.hit_cycles + trv.visit_latency(slowest) + trv.most_passes(slowest) - 1;
  trv.box_latency -= std::min(trv.box_latency - 1, pipe > kLongestPipe ? pipe - kLongestPipe : 0);
  return config;
}
GpuConfig sane_config(std::uint64_t seed) { return drawn(seed, Range::kSane); }

}  // namespace hw::test
