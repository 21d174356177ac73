#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/config/yaml_tree.h"

namespace tools::sweep {

/// A value of a YAML file that says, in errors, where it stands and what it is called.
class YamlValue {
 public:
  /// The mapping that the text is. It must outlive all its values. InputError.
  YamlValue(const sim::YamlNode& root, std::string file) : node_(&root), file_(std::move(file)) {}

  bool is_mapping() const { return node_->kind == sim::YamlNode::Kind::kMapping; }
  bool is_list() const { return node_->kind == sim::YamlNode::Kind::kSequence; }
  bool is_text() const { return node_->kind == sim::YamlNode::Kind::kScalar; }

  // InputError if it is anything else.
  const std::string& text() const;
  std::uint64_t whole_number(std::uint64_t least, std::uint64_t most) const;
  bool yes_or_no() const;
  std::vector<std::string> texts() const;  ///< a list of texts
  std::vector<YamlValue> items() const;    ///< elements of a list
  /// An entry of a mapping, by key.
  std::vector<YamlValue> entries() const;
  /// The same; InputError, with what is nearest, for a key that is none of these.
  std::vector<YamlValue> entries(std::span<const std::string_view> keys) const;

  const std::string& key() const { return key_; }  ///< in its mapping
  std::string where() const;                       ///< "file:line:column" of the value
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

}  // namespace tools::sweep
