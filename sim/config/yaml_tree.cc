#include "sim/config/yaml_tree.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <sstream>

#include <fmt/format.h>
#include <yaml-cpp/depthguard.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include "sim/config/config_tree.h"
#include "sim/io/printable.h"

namespace sim {
namespace {

using Node = std::shared_ptr<YamlNode>;

/// Builds the tree of YamlNodes from the events of the YAML parser.
class YamlTreeBuilder final : public YAML::EventHandler {
 public:
  explicit YamlTreeBuilder(const std::string& name) : name_(name) {}

  Node root_node() const { return root_; }

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (root_ != nullptr) refuse_at(mark, "a second document begins; allowed: one");
  }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    const Node node = make_node(YamlNode::Kind::kEmpty);
    add_node(mark, node);
    set_anchor(anchor, node);
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    refuse_tag(mark, tag);
    const Node node = make_node(YamlNode::Kind::kScalar);
    node->scalar = value;
    add_node(mark, node);
    set_anchor(anchor, node);
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    const auto found = anchors_.find(anchor);
    if (found == anchors_.end()) refuse_at(mark, "an alias stands inside the value it repeats");
    add_node(mark, found->second);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    open_node(mark, tag, anchor, YamlNode::Kind::kSequence);
  }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    open_node(mark, tag, anchor, YamlNode::Kind::kMapping);
  }
  void OnSequenceEnd() override { close_node(); }
  void OnMapEnd() override { close_node(); }

  [[noreturn]] void refuse_at(const YAML::Mark& mark, std::string_view problem) const {
    refuse(fmt::format("{}:{}:{}", name_, mark.line + 1, mark.column + 1), {}, problem);
  }

 private:
  /// A YAML mapping or sequence whose end has not been parsed yet.
  struct OpenNode {
    Node node;
    YAML::anchor_t anchor;
    std::optional<YamlNode::Entry> entry;  ///< entry whose key has been parsed, but not its value
    std::set<std::string> keys;
  };

  static TextPosition position_of(const YAML::Mark& mark) { return {mark.line + 1, mark.column + 1}; }
  static Node make_node(YamlNode::Kind kind) {
    const Node node = std::make_shared<YamlNode>();
    node->kind = kind;
    return node;
  }
  void refuse_tag(const YAML::Mark& mark, const std::string& tag) const {
    if (tag.empty() || tag == "?" || tag == "!") return;
    refuse_at(mark, fmt::format("the tag '{}' has no meaning here; allowed: values without tags", tag));
  }
  void set_anchor(YAML::anchor_t anchor, const Node& node) {
    if (anchor != YAML::NullAnchor) anchors_[anchor] = node;
  }
  void open_node(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor, YamlNode::Kind kind) {
    refuse_tag(mark, tag);
    const Node node = make_node(kind);
    add_node(mark, node);
    open_.push_back({node, anchor, std::nullopt, {}});
  }
  void close_node() {
    set_anchor(open_.back().anchor, open_.back().node);
    open_.pop_back();
  }
  /// Adds a YAML node to the innermost open mapping or sequence, or makes it the root.
  void add_node(const YAML::Mark& mark, const Node& node) {
    if (open_.empty()) {
      root_ = node;
    } else if (open_.back().node->kind == YamlNode::Kind::kMapping) {
      open_.back().entry ? attach_value(mark, node) : attach_key(mark, node);
    } else {
      open_.back().node->entries.push_back({{}, position_of(mark), position_of(mark), node});
    }
  }
  void attach_key(const YAML::Mark& mark, const Node& node) {
    OpenNode& mapping = open_.back();
    if (node->kind != YamlNode::Kind::kScalar) refuse_at(mark, "a key must be plain text");
    if (!mapping.keys.insert(node->scalar).second) {
      refuse_at(mark, fmt::format("the key '{}' is given twice", node->scalar));
    }
    mapping.entry = {node->scalar, position_of(mark), position_of(mark), nullptr};
  }
  void attach_value(const YAML::Mark& mark, const Node& node) {
    OpenNode& mapping = open_.back();
    if (node->kind != YamlNode::Kind::kEmpty) mapping.entry->value_at = position_of(mark);
    mapping.entry->value = node;
    mapping.node->entries.push_back(std::move(*mapping.entry));
    mapping.entry.reset();
  }

  const std::string& name_;
  Node root_;
  std::vector<OpenNode> open_;
  std::map<YAML::anchor_t, Node> anchors_;
};

}  // namespace

const YamlNode::Entry* YamlNode::find(std::string_view key) const {
  const auto found = std::ranges::find(entries, key, &Entry::key);
  return found == entries.end() ? nullptr : &*found;
}

std::shared_ptr<const YamlNode> parse_yaml_mapping(const std::string& text, const std::string& name) {
  // Without trailing white space, because yaml-cpp accepts an unclosed quote before it.
  std::istringstream stream(text.substr(0, text.find_last_not_of(" \n\r") + 1));
  YamlTreeBuilder builder(name);
  try {
    YAML::Parser parser(stream);
    while (parser.HandleNextDocument(builder)) {
    }
  } catch (const YAML::DeepRecursion& error) {
    builder.refuse_at(error.mark, "is nested too deeply");
  } catch (const YAML::Exception& error) {
    const bool is_tab = error.msg.find("tab") != std::string::npos;
    builder.refuse_at(error.mark, is_tab ? "a tab indents this line; allowed: spaces"
                                         : fmt::format("is not valid YAML: {}", error.msg));
  }
  const Node root = builder.root_node();
  if (root == nullptr || root->kind == YamlNode::Kind::kEmpty) refuse(name, {}, "is empty; allowed: a mapping");
  if (root->kind != YamlNode::Kind::kMapping) refuse(name + ":1:1", {}, "holds no 'key: value' at its top level");
  return root;
}

}  // namespace sim
