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

/// Access to a configuration member of any enumeration type. The names are in the order of the values 0, 1, 2, ...
struct EnumTarget {
  std::vector<std::string_view> names;
  std::function<std::size_t()> get;
  std::function<void(std::size_t)> set;
};

/// Pointer to the member of a configuration struct that a field is bound to. FieldKind names the alternatives in this
/// order.
using Target = std::variant<bool*, std::uint32_t*, std::uint64_t*, double*, std::string*, Frequency*, ByteSize*,
                            Duration*, AutoCount*, Triple*, Band*, std::map<std::string, Band>*, EnumTarget>;
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
  kBand,
  kBandMap,
  kEnum,
};
constexpr std::array<std::string_view, 13> names_of(FieldKind) {
  return {"bool",     "uint32",     "uint64", "double", "string",     "frequency", "byte_size",
          "duration", "auto_count", "triple", "spread", "spread_map", "enum"};
}

static_assert(std::variant_size_v<Target> == names_of(FieldKind{}).size());

/// Receives each rule that a configuration struct's check() finds violated: the key and the problem.
using Complain = std::function<void(std::string_view key, std::string_view problem)>;

inline constexpr std::string_view kSetOrigin = "--set ";
inline constexpr std::size_t kNearestFile = 16;  ///< ConfigNode::nearness of a file that no other file extends

/// One field or group of a configuration, bound to an instance of its struct. The instance must outlive the node.
struct ConfigNode {
  // Defined in config_tree.cc because the functions of `target` are slow to compile.
  ConfigNode();
  ~ConfigNode();
  ConfigNode(const ConfigNode&);
  ConfigNode(ConfigNode&&) noexcept;
  ConfigNode& operator=(const ConfigNode&);
  ConfigNode& operator=(ConfigNode&&) noexcept;

  std::string key;
  std::string path;  ///< keys from the root, joined by dots
  std::string unit;
  std::string meaning;
  Limits limits;
  Affects affects = Affects::kTiming;
  std::optional<Target> target;                ///< the member that a field is bound to; empty for a group
  std::vector<ConfigNode> children;            ///< fields and groups of a group, as declared
  std::function<void(const Complain&)> check;  ///< rules of a group, if it has any
  std::vector<std::string> bundle;             ///< groups that extend the file which this field names
  std::map<std::string, std::string, std::less<>>
      not_modelled;    ///< keys of mechanisms that the model lacks, each with the reason
  std::string origin;  ///< where the value was set last (kSetOrigin); empty for a default
  std::size_t nearness =
      0;  ///< distance of the origin from the user: files that are extended are farther, --set is nearest

  bool is_group() const { return !target.has_value(); }
  FieldKind kind() const { return static_cast<FieldKind>(target->index()); }
  const ConfigNode* find_child(std::string_view name) const;
  ConfigNode* find_child(std::string_view name);
};

/// The visitor that describe() of a configuration struct receives: adds each declared field and group to a ConfigNode.
class TreeBuilder {
 public:
  explicit TreeBuilder(ConfigNode& group) : group_(group) {}

  template <class T>
  void operator()(T& member, std::string_view key, std::string_view unit, std::string_view meaning, Limits limits,
                  Affects affects) {
    ConfigNode& node = add_node(key, meaning);
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
    bind(add_node(key, meaning), member);
  }

  /// Declares a text that makes each of the sibling groups extend the file of that name: `process: 5nm` extends
  /// energy/5nm in `energy`, area/5nm in `area`. All other settings of these groups override the files.
  void bundle(std::string& member, std::string_view key, std::string_view meaning, std::vector<std::string> groups,
              Affects affects) {
    (*this)(member, key, "", meaning, any(), affects);
    group_.children.back().bundle = std::move(groups);
  }

  /// Declares a key of a mechanism that the model lacks. A configuration that sets the key is an error with this
  /// reason.
  void not_modelled(std::string_view key, std::string_view reason) { group_.not_modelled.emplace(key, reason); }

  /// Adds a node for each field of the configuration struct `config` to `node`.
  template <class Config>
  static void bind(ConfigNode& node, Config& config) {
    TreeBuilder builder(node);
    Config::describe(config, builder);
    if constexpr (requires(const Config& c, const Complain& complain) { c.check(complain); }) {
      node.check = [&config](const Complain& complain) { std::as_const(config).check(complain); };
    }
  }

 private:
  ConfigNode& add_node(std::string_view key, std::string_view meaning);

  ConfigNode& group_;
};

template <class Config>
ConfigNode config_tree(Config& config) {
  ConfigNode root;
  TreeBuilder::bind(root, config);
  return root;
}

/// Checks a configuration. Throws InputError for the first value outside its limits, otherwise for the first violated
/// rule. `origin`: name of the whole configuration in errors about keys that keep their default.
void check_tree(const ConfigNode& root, std::string_view origin = {});

/// Throws InputError("<origin>: <path>: <problem>"); empty parts are left out.
[[noreturn]] void refuse(std::string_view origin, std::string_view path, std::string_view problem);

/// Returns a hint for an unknown key: "did you mean 'x'?" with the same key elsewhere in the tree or the nearest key of
/// the group, otherwise the keys that are allowed.
std::string suggest_keys(const ConfigNode& root, const ConfigNode& group, std::string_view key);

/// Combines several callables into one, for std::visit.
template <class... Cases>
struct Overloaded : Cases... {
  using Cases::operator()...;
};
template <class... Cases>
Overloaded(Cases...) -> Overloaded<Cases...>;

}  // namespace sim
