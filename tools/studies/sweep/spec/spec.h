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

#include "tools/studies/sweep/spec/magnitude.h"

namespace tools::sweep {

/// Something that is varied: one key of the configuration, or several that move together; or what is rendered.
struct Axis {
  struct Value {
    std::string label;
    std::vector<std::string> settings;  ///< one for each key
  };
  std::string name;
  std::string at;  ///< "file:line:column" of its values, for messages
  std::vector<std::string> keys;
  std::vector<Value> values;
};

/// The keys of an axis that are no keys of the configuration.
bool is_work_key(const std::string& key);
/// True if points of the axis render different pictures: it moves the scene, camera, frames or resolution.
bool moves_workload(const Axis& axis);

enum class Comparison : std::uint8_t { kEqual, kUnequal, kLess, kLessEqual, kGreater, kGreaterEqual };

/// Something that holds for some combinations of values: all its terms do.
struct Condition {
  struct Side {
    std::size_t axis = 0;
    std::optional<std::size_t> key;  ///< one of its keys; none: its label
  };
  /// A value, read once.
  struct Operand {
    std::string text;
    std::optional<Magnitude> magnitude;
  };
  using Operands = std::shared_ptr<const std::vector<Operand>>;  ///< all values of an axis
  struct Term {
    Side left;
    Comparison comparison = Comparison::kEqual;
    std::vector<std::string> values;  ///< one of which, or
    std::optional<Side> right;        ///< another axis in this combination
    std::string at;
    Operands lefts, rights;                       ///< values of the axes
    std::vector<std::optional<bool>> outcomes{};  ///< outcome for each value of the left axis, if it compares
  };
  std::vector<Term> terms;
};

struct Subset {
  enum class Kind : std::uint8_t { kGrid, kRandom, kLatinHypercube, kSobol } kind = Kind::kGrid;
  std::uint64_t count = 0;
  std::uint64_t seed = 1;
};

/// Contents of a sweep's file (docs/sweeps.md).
struct Spec {
  std::string question;  ///< that it answers, for people
  std::string config = "sgrt-2016";
  std::string scene, camera, frames, resolution, program = "full:1", reference, tile_sampling;
  bool image = false;
  std::uint32_t replicates = 1;  ///< plays of each point (docs/noise.md)
  std::uint32_t slices = 0;      ///< that frames are cut into (docs/slices.md); 0: they are played whole
  std::vector<std::string> sets;
  std::vector<Axis> axes;  ///< the last varies fastest
  std::vector<Condition> exclude, where;
  Subset subset;
  std::vector<std::string> slurm;                    ///< arguments for sbatch
  std::map<std::string, std::string> key_positions;  ///< where its keys stand, "file:line:column", for messages
};

class YamlValue;

/// InputError of one line: file, line, column, key, what is wrong, what is allowed.
Spec read_spec(const std::filesystem::path& file);
/// The part of another kind of file that is a sweep. `others`: keys of that kind, which are left to the caller.
Spec read_spec(const YamlValue& root, std::string_view schema, std::span<const std::string_view> others);

}  // namespace tools::sweep
