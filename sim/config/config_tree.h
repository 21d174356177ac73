#pragma once
#include <array>
#include <cassert>
#include <concepts>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "sim/config/field.h"

namespace sim {

/// An enum member without its type: its names in the order of its values 0, 1, 2, ...
struct EnumTarget {
  std::vector<std::string_view> names;
  std::function<std::size_t()> get;
  std::function<void(std::size_t)> set;
};

/// The member a field is bound to. FieldKind names the alternatives, in this order.
using Target = std::variant<bool*, std::uint32_t*, std::uint64_t*, double*, std::string*, Frequency*, ByteSize*,
                            Duration*, AutoCount*, Triple*, Spread*, std::map<std::string, Spread>*, EnumTarget>;
enum class FieldKind : std::uint8_t {
  kBool,
  kUint32,
  kUint64,
  kDouble,
  kString,
  kFrequency,
  kByteSize,
  kDuration,
  kAutoCount,
  kTriple,
  kSpread,
  kSpreadMap,
  kEnum,
};
constexpr std::array<std::string_view, 13> names_of(FieldKind) {
  return {"bool",     "uint32",     "uint64", "double", "string",     "frequency", "byte_size",
          "duration", "auto_count", "triple", "spread", "spread_map", "enum"};
}

static_assert(std::variant_size_v<Target> == names_of(FieldKind{}).size());

/// Receives a rule that a struct's check() finds broken.
using Complain = std::function<void(std::string_view key, std::string_view problem)>;

inline constexpr std::string_view kSetOrigin = "--set ";
inline constexpr std::size_t kNearestFile = 16;  ///< ConfigNode::nearness of a file that no other extends

/// One field or group of a configuration, bound to one instance of its struct, which must outlive it.
struct ConfigNode {
  // Defined once, in config_tree.cc: those of `target` take long to compile.
  ConfigNode();
  ~ConfigNode();
  ConfigNode(const ConfigNode&);
  ConfigNode(ConfigNode&&) noexcept;
  ConfigNode& operator=(const ConfigNode&);
  ConfigNode& operator=(ConfigNode&&) noexcept;

  std::string key;
  std::string path;  ///< from the root, keys joined by dots
  std::string unit;
  std::string meaning;
  Limits limits;
  Affects affects = Affects::kTiming;
  std::optional<Target> target;                                  ///< a field's member; none for a group
  std::vector<ConfigNode> children;                              ///< a group's fields and groups, as declared
  std::function<void(const Complain&)> check;                    ///< a group's own rules; empty if it has none
  std::map<std::string, std::string, std::less<>> not_modelled;  ///< a group's keys that do not exist, and why
  std::string origin;        ///< where its value was given last (kSetOrigin); empty for a default
  std::size_t nearness = 0;  ///< origin, as the user sees it: a file is nearer than those it extends, --set nearest

  bool is_group() const { return !target.has_value(); }
  FieldKind kind() const { return static_cast<FieldKind>(target->index()); }
  const ConfigNode* child(std::string_view name) const;
  ConfigNode* child(std::string_view name);
};

/// The visitor that describe() is given: hangs each declared field and group into a ConfigNode.
class TreeBuilder {
 public:
  explicit TreeBuilder(ConfigNode& group) : group_(group) {}

  template <class T>
  void operator()(T& member, std::string_view key, std::string_view unit, std::string_view meaning, Limits limits,
                  Affects affects) {
    ConfigNode& node = add(key, meaning);
    node.unit = unit;
    node.limits = limits;
    node.affects = affects;
    if constexpr (std::is_enum_v<T>) {
      const auto names = names_of(T{});
      node.target = EnumTarget{{names.begin(), names.end()},
                               [&member] { return static_cast<std::size_t>(member); },
                               [&member](std::size_t i) { member = static_cast<T>(i); }};
    } else {
      node.target = Target(&member);
    }
  }

  template <class Group>
  void group(Group& member, std::string_view key, std::string_view meaning) {
    bind(add(key, meaning), member);
  }

  /// Declares a key of a mechanism that the model lacks: its use is refused with `reason`.
  void not_modelled(std::string_view key, std::string_view reason) { group_.not_modelled.emplace(key, reason); }

  /// Fills `node` with the fields of `config`.
  template <class Config>
  static void bind(ConfigNode& node, Config& config) {
    TreeBuilder builder(node);
    Config::describe(config, builder);
    if constexpr (requires(const Config& c, const Complain& complain) { c.check(complain); }) {
      node.check = [&config](const Complain& complain) { std::as_const(config).check(complain); };
    }
  }

 private:
  ConfigNode& add(std::string_view key, std::string_view meaning);

  ConfigNode& group_;
};

template <class Config>
ConfigNode config_tree(Config& config) {
  ConfigNode root;
  TreeBuilder::bind(root, config);
  return root;
}

/// Throws InputError for the first value outside its field's limits, then for the first rule broken that joins several.
/// `origin` is where the configuration as a whole comes from, for keys that nobody has given.
void check_tree(const ConfigNode& root, std::string_view origin = {});

/// Throws InputError("<origin>: <path>: <problem>"), leaving out what is empty.
[[noreturn]] void refuse(std::string_view origin, std::string_view path, std::string_view problem);

/// "did you mean 'x'?" for keys of the same name elsewhere in the tree, if they are few, or the nearest key here; else
/// the list of what is allowed here.
std::string suggest(const ConfigNode& root, const ConfigNode& group, std::string_view key);

}  // namespace sim
