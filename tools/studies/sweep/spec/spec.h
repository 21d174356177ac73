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

/// A value of a YAML file, with its position and path for error messages. Member functions throw InputError if the
/// value is of another kind than they return.
class YamlValue {
 public:
  /// Makes the value of a file's root mapping. `root` must outlive all values.
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

/// An axis of a sweep. It varies one configuration key, several keys together, or what is rendered.
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

/// A combination of axis values: for each axis the index of the value.
using Choice = std::vector<std::uint32_t>;

/// True for a key of an axis that is not a configuration key: scene, camera, frames, resolution, program.
bool is_work_key(const std::string& key);
/// True if the axis changes what is rendered: scene, camera, frames or resolution.
bool changes_workload(const Axis& axis);

/// A condition on a combination of axis values. It holds if all its terms hold.
struct AxisCondition {
  struct Side {
    std::size_t axis = 0;
    /// Index in Axis::keys of the key whose setting is compared; nothing: the value's label is compared.
    std::optional<std::size_t> key;
  };
  using Operands = std::shared_ptr<const std::vector<Operand>>;  ///< operands of all values of an axis
  struct Term {
    Side left;
    Comparison comparison = Comparison::kEqual;
    std::vector<Operand> values;  ///< right side: the term holds if it holds for one of these
    std::optional<Side> right;    ///< right side if it is another axis
    std::string at;
    Operands lefts, rights;
    std::vector<std::optional<bool>> outcomes{};  ///< by value of the left axis: outcome_of() with `values`
  };
  std::vector<Term> terms;
};
/// Returns whether `left` compares with at least one operand of `rights` as the term requires. Returns nothing if an
/// earlier operand of `rights` cannot be compared with `left`.
std::optional<bool> outcome_of(const AxisCondition::Term& term, const Operand& left, std::span<const Operand> rights);

inline constexpr std::uint64_t kMostPoints = 1'000'000;

struct Subset {
  enum class Kind : std::uint8_t { kGrid, kRandom, kLatinHypercube, kSobol } kind = Kind::kGrid;
  std::uint64_t count = 0;
  std::uint64_t seed = 1;
};

/// Contents of a sweep's file (docs/sweeps.md).
struct Spec {
  std::string question;  ///< the question that the sweep answers, for readers
  std::string config = "sgrt-2016";
  std::string scene, camera, frames, resolution, program = "full:1", reference, tile_sampling, representative;
  bool image = false;
  std::uint32_t replicates = 1;  ///< perturbed repetitions of each point (docs/noise.md)
  std::uint32_t slices = 0;      ///< slices of each frame (docs/slices.md); 0: frames are not cut
  std::vector<std::string> sets;
  std::vector<Axis> axes;  ///< axes of the sweep; the last one varies fastest
  std::vector<AxisCondition> exclude, where;
  Subset subset;
  std::vector<std::string> slurm;                    ///< arguments for sbatch
  std::map<std::string, std::string> key_positions;  ///< "file:line:column" of the value of each key
};

/// Reads a sweep's file. Throws InputError with file, line, column, key, error and allowed values.
Spec read_spec(const std::filesystem::path& file);
/// Reads the keys of another kind of file that describe a sweep. `other_keys`: keys that the caller reads.
Spec read_spec(const YamlValue& root, std::string_view schema, std::span<const std::string_view> other_keys);

}  // namespace tools::sweep
