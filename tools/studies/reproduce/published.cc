#include "tools/studies/reproduce/published.h"

#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "sim/config/yaml_tree.h"
#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/printable.h"
#include "tools/host/paths.h"

namespace tools::reproduce {
namespace {

constexpr std::uint64_t kMostPublishedBytes = 1 << 20;

using Entry = sim::YamlNode::Entry;
using Kind = sim::YamlNode::Kind;

/// Goes down the levels of a file and remembers where.
class Reader {
 public:
  explicit Reader(const std::string& name) : name_(name) {}

  Published read(const sim::YamlNode& root) {
    for (const Entry& experiment : root.entries) {
      for (const Entry& scene : mapping(experiment, "scenes")) {
        for (const Entry& setting : mapping(scene, "settings")) {
          for (const Entry& metric : mapping(setting, "figures")) {
            out_.emplace(FigureKey{experiment.key, scene.key, setting.key, metric.key}, range(metric));
          }
        }
      }
    }
    return std::move(out_);
  }

 private:
  [[noreturn]] void refuse(const Entry& at, std::string_view what) const {
    throw sim::InputError(
        fmt::format("{}:{}:{}: '{}' {}", name_, at.key_at.line, at.key_at.column, sim::printable(at.key), what));
  }

  const std::vector<Entry>& mapping(const Entry& entry, std::string_view of) const {
    if (entry.value->kind != Kind::kMapping) refuse(entry, fmt::format("must be a mapping of {}", of));
    return entry.value->entries;
  }

  double number(const Entry& entry) const {
    const std::string& text = entry.value->scalar;
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (entry.value->kind != Kind::kScalar || error != std::errc{} || end != text.data() + text.size() ||
        !std::isfinite(value)) {
      refuse(entry, "must be a number");
    }
    return value;
  }

  Range range(const Entry& entry) const {
    if (entry.value->kind == Kind::kScalar) return {number(entry), number(entry)};
    const std::vector<Entry>& ends = mapping(entry, "low and high, or a number");
    const Entry* low = entry.value->find("low");
    const Entry* high = entry.value->find("high");
    if (low == nullptr || high == nullptr || ends.size() != 2 || number(*low) > number(*high)) {
      refuse(entry, "must be a number, or {low: number, high: a greater number}");
    }
    return {number(*low), number(*high)};
  }

  const std::string& name_;
  Published out_;
};

}  // namespace

Published parse_published(const std::string& text, const std::string& name) {
  return Reader(name).read(*sim::parse_yaml_mapping(text, name));
}

Published load_published(const std::string& paper) {
  const std::string name = paper + ".yaml";
  for (const std::filesystem::path& folder : search_folders()) {
    for (const std::filesystem::path& file :
         {folder / "tests" / "validation" / "published" / name, folder / "published" / name}) {
      std::error_code missing;
      if (std::filesystem::exists(file, missing))
        return parse_published(sim::read_file(file, kMostPublishedBytes), file);
    }
  }
  throw sim::InputError(
      fmt::format("the published figures of {} are neither in the source tree nor installed; "
                  "$RAYWATT_PATH may name a folder that has published/{}",
                  paper, name));
}

}  // namespace tools::reproduce
