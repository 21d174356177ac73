#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/config/yaml_tree.h"
#include "tools/studies/sweep/spec/condition.h"

namespace tools::sweep {

/// A value of a YAML file with its position and its path for error messages. The member functions throw InputError for
/// a value of another kind.
class YamlValue {
 public:
  /// The root mapping. `root` must outlive all values.
  YamlValue(const sim::YamlNode& root, std::string file) : node_(&root), file_(std::move(file)) {}

  bool is_mapping() const { return node_->kind == sim::YamlNode::Kind::kMapping; }
  bool is_list() const { return node_->kind == sim::YamlNode::Kind::kSequence; }
  bool is_text() const { return node_->kind == sim::YamlNode::Kind::kScalar; }

  const std::string& text() const;
  std::uint64_t whole_number(std::uint64_t least, std::uint64_t most) const;
  bool boolean() const;
  std::vector<std::string> list_of_texts() const;
  std::vector<YamlValue> items() const;    ///< elements of a list
  std::vector<YamlValue> entries() const;  ///< entries of a mapping
  /// Entries of a mapping. Throws InputError, with the nearest allowed key, for a key that is not among `keys`.
  std::vector<YamlValue> entries(std::span<const std::string_view> keys) const;

  const std::string& key() const { return key_; }
  std::string where() const;  ///< "file:line:column"
  [[noreturn]] void refuse(std::string_view problem) const;

 private:
  YamlValue(const YamlValue& parent, const sim::YamlNode::Entry& entry, std::string path)
      : node_(entry.value.get()),
        key_at_(entry.key_at),
        at_(entry.value_at),
        key_(entry.key),
        path_(std::move(path)),
        file_(parent.file_) {}

  const sim::YamlNode* node_;
  sim::TextPosition key_at_, at_;
  std::string key_, path_, file_;
};

/// What a sweep varies: one key of the configuration, several keys together, or what is rendered.
struct Axis {
  struct Value {
    std::string label;
    std::vector<std::string> settings;  ///< one for each key
  };
  std::string name;
  std::string at;  ///< "file:line:column" of its values
  std::vector<std::string> keys;
  std::vector<Value> values;
};

/// A combination: for each axis the index of its value.
using Choice = std::vector<std::uint32_t>;

/// True for axis keys that are not keys of the configuration: scene, camera, frames, resolution, program.
bool is_work_key(const std::string& key);
/// True if the axis changes what is rendered: scene, camera, frames or resolution.
bool changes_workload(const Axis& axis);

/// A condition on a combination of axis values. It holds if all its terms hold.
struct AxisCondition {
  struct Side {
    std::size_t axis = 0;
    /// Which of the axis's keys is compared, as an index in Axis::keys; without it the value's label is compared.
    std::optional<std::size_t> key;
  };
  using Operands = std::shared_ptr<const std::vector<Operand>>;  ///< all values of an axis
  struct Term {
    Side left;
    Comparison comparison = Comparison::kEqual;
    std::vector<Operand> values;  ///< right side: one of these, or
    std::optional<Side> right;    ///< another axis
    std::string at;
    Operands lefts, rights;
    std::vector<std::optional<bool>> outcomes{};  ///< outcome_of() for each left value, compared with `values`
  };
  std::vector<Term> terms;
};
/// True if the operand `left` compares with at least one of `rights` as the term requires. Returns nothing if an
/// operand before that one cannot be ordered relative to `left`.
std::optional<bool> outcome_of(const AxisCondition::Term& term, const Operand& left, std::span<const Operand> rights);

inline constexpr std::uint64_t kMostPoints = 1'000'000;

struct Subset {
  enum class Kind : std::uint8_t { kGrid, kRandom, kLatinHypercube, kSobol } kind = Kind::kGrid;
  std::uint64_t count = 0;
  std::uint64_t seed = 1;
};

/// Contents of a sweep's file (docs/sweeps.md).
struct Spec {
  std::string question;  ///< what the sweep answers, for readers
  std::string config = "sgrt-2016";
  std::string scene, camera, frames, resolution, program = "full:1", reference, tile_sampling;
  bool image = false;
  std::uint32_t replicates = 1;  ///< perturbed repetitions of each point (docs/noise.md)
  std::uint32_t slices = 0;      ///< slices of each frame (docs/slices.md); 0: frames are played whole
  std::vector<std::string> sets;
  std::vector<Axis> axes;  ///< axes of the sweep; the last one varies fastest
  std::vector<AxisCondition> exclude, where;
  Subset subset;
  std::vector<std::string> slurm;                    ///< arguments for sbatch
  std::map<std::string, std::string> key_positions;  ///< "file:line:column" of the value of each key
};

/// Reads a sweep's file. Throws InputError of one line: file, line, column, key, what is wrong, what is allowed.
Spec read_spec(const std::filesystem::path& file);
/// Reads those members of another kind of file that describe a sweep. `other_keys`: keys that the caller reads.
Spec read_spec(const YamlValue& root, std::string_view schema, std::span<const std::string_view> other_keys);

}  // namespace tools::sweep
