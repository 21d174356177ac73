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

/// Type-independent access to an enumeration member of a configuration. The names are in the order of the values 0, 1,
/// 2, ...
struct EnumTarget {
  std::vector<std::string_view> names;
  std::function<std::size_t()> get;
  std::function<void(std::size_t)> set;
};

/// Pointer to the member of a configuration struct to which a field is bound. FieldKind lists the alternatives in this
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

/// Callback for each rule that a configuration struct's check() finds violated, with the key and the problem.
using Complain = std::function<void(std::string_view key, std::string_view problem)>;

inline constexpr std::string_view kSetOrigin = "--set ";
inline constexpr std::size_t kNearestFile = 16;  ///< ConfigNode::nearness of values in a file that no other file
                                                 ///< extends

/// One field or group of a configuration, bound to a struct with its values. The struct must outlive the node.
struct ConfigNode {
  // Defined in config_tree.cc because the functions of `target` are slow to compile.
  ConfigNode();
  ~ConfigNode();
  ConfigNode(const ConfigNode&);
  ConfigNode(ConfigNode&&) noexcept;
  ConfigNode& operator=(const ConfigNode&);
  ConfigNode& operator=(ConfigNode&&) noexcept;

  std::string key;
  std::string path;  ///< keys from the root to this node, joined by dots
  std::string unit;
  std::string meaning;
  Limits limits;
  Affects affects = Affects::kTiming;
  std::optional<Target> target;                ///< the member to which a field is bound; empty for a group
  std::vector<ConfigNode> children;            ///< fields and subgroups of a group, in the order of declaration
  std::function<void(const Complain&)> check;  ///< function that checks the rules of a group, if it has any
  std::vector<std::string> bundle;             ///< sibling groups that extend the files named by this field
  std::map<std::string, std::string, std::less<>>
      not_modelled;    ///< reason for each key of a mechanism that is not modelled
  std::string origin;  ///< where the value was set last: a file, or a --set argument; empty for a default
  std::size_t nearness =
      0;  ///< how near the origin is to the user: least for files extended by others, greatest for --set

  bool is_group() const { return !target.has_value(); }
  FieldKind kind() const { return static_cast<FieldKind>(target->index()); }
  const ConfigNode* find_child(std::string_view name) const;
  ConfigNode* find_child(std::string_view name);
};

/// Visitor for describe() of a configuration struct. It adds each declared field and group to a ConfigNode.
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

  /// Declares a text field whose value makes several sibling groups extend files of that name: `process: 5nm` makes
  /// `energy` extend energy/5nm and `area` extend area/5nm. All other settings of these groups override the files.
  void bundle_choice(std::string& member, std::string_view key, std::string_view meaning,
                     std::vector<std::string> groups, Affects affects) {
    (*this)(member, key, "", meaning, any(), affects);
    group_.children.back().bundle = std::move(groups);
  }

  /// Declares a key of a mechanism that is not modelled. Setting the key is an error whose text contains the reason.
  void not_modelled(std::string_view key, std::string_view reason) { group_.not_modelled.emplace(key, reason); }

  /// Adds a child node for each field and group of the configuration struct `config` to `node`.
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

/// Checks a configuration. Throws InputError for the first value outside its limits, or else the first violated rule.
/// `origin`: name of the configuration, for errors about keys with default values.
void check_tree(const ConfigNode& root, std::string_view origin = {});

/// Throws InputError("<origin>: <path>: <problem>"). An empty origin or path is left out.
[[noreturn]] void refuse(std::string_view origin, std::string_view path, std::string_view problem);

/// Returns a hint for an unknown configuration key in a group: "did you mean 'x'?", with the same key in another group
/// or the nearest key of this group, or otherwise a list of the allowed keys.
std::string suggest_keys(const ConfigNode& root, const ConfigNode& group, std::string_view key);

/// Combines several callables into one visitor for std::visit.
template <class... Cases>
struct Overloaded : Cases... {
  using Cases::operator()...;
};
template <class... Cases>
Overloaded(Cases...) -> Overloaded<Cases...>;

}  // namespace sim
