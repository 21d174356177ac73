#include "tools/studies/sweep/spec/yaml_value.h"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/config/config_tree.h"
#include "sim/io/printable.h"
#include "traces/scene/did_you_mean.h"

namespace tools::sweep {
namespace {

/// A hostile file can name one list in many places.
constexpr std::size_t kMostItems = 10'000;

}  // namespace

std::string YamlValue::where() const { return fmt::format("{}:{}:{}", file_, at_.line, at_.column); }

void YamlValue::refuse(std::string_view problem) const { sim::refuse(where(), path_, problem); }

const std::string& YamlValue::text() const {
  if (!is_text() || node_->scalar.empty()) refuse("allowed: one value");
  return node_->scalar;
}

std::uint64_t YamlValue::whole_number(std::uint64_t least, std::uint64_t most) const {
  const std::string& digits = text();
  std::uint64_t number = 0;
  const auto [end, bad] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  if (bad != std::errc{} || end != digits.data() + digits.size() || number < least || number > most) {
    refuse(
        fmt::format("'{}' is not allowed; allowed: a whole number from {} to {}", sim::printable(digits), least, most));
  }
  return number;
}

bool YamlValue::yes_or_no() const {
  const std::string& word = text();
  if (word == "yes" || word == "true") return true;
  if (word != "no" && word != "false")
    refuse(fmt::format("'{}' is not allowed; allowed: yes, no", sim::printable(word)));
  return false;
}

std::vector<YamlValue> YamlValue::items() const {
  if (!is_list()) refuse("allowed: a list, such as [1, 2, 4]");
  if (node_->entries.empty()) refuse("is empty");
  if (node_->entries.size() > kMostItems) refuse(fmt::format("has more than {} items", kMostItems));
  std::vector<YamlValue> all;
  for (const sim::YamlNode::Entry& item : node_->entries) all.push_back(YamlValue(*this, item, path_));
  return all;
}

std::vector<std::string> YamlValue::texts() const {
  std::vector<std::string> all;
  for (const YamlValue& item : items()) all.push_back(item.text());
  return all;
}

std::vector<YamlValue> YamlValue::entries() const {
  if (!is_mapping()) refuse("allowed: a mapping, such as {key: value}");
  if (node_->entries.size() > kMostItems) refuse(fmt::format("has more than {} entries", kMostItems));
  std::vector<YamlValue> all;
  for (const sim::YamlNode::Entry& entry : node_->entries) {
    const std::string key = sim::printable(entry.key);
    all.push_back(YamlValue(*this, entry, path_.empty() ? key : path_ + "." + key));
  }
  return all;
}

std::vector<YamlValue> YamlValue::entries(std::span<const std::string_view> keys) const {
  std::vector<YamlValue> all = entries();
  for (const YamlValue& entry : all) {
    if (std::ranges::find(keys, entry.key()) != keys.end()) continue;
    sim::refuse(fmt::format("{}:{}:{}", file_, entry.key_at_.line, entry.key_at_.column), entry.path_,
                fmt::format("unknown key '{}'{}; allowed: {}", sim::printable(entry.key()),
                            traces::did_you_mean(entry.key(), std::vector<std::string>(keys.begin(), keys.end())),
                            fmt::join(keys, ", ")));
  }
  return all;
}

}  // namespace tools::sweep
