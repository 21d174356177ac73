#include "sim/config/dump.h"

#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "sim/config/value.h"
#include "sim/sha256.h"

namespace sim {
namespace {

/// Writes numbers such as 1e-05 as 1.0e-05: YAML 1.1 readers such as PyYAML read a number without a point as text.
std::string with_points(const std::string& text) {
  std::string out;
  bool is_whole = false;  // the number so far has digits and no point
  for (const char c : text) {
    if (c == 'e' && is_whole) out += ".0";
    const bool begins = out.empty() || out.back() == ' ' || out.back() == '-';
    is_whole = c >= '0' && c <= '9' && (is_whole || begins);
    out += c;
  }
  return out;
}

/// Returns the value as in a configuration file. Quoted where YAML 1.1 readers would read a boolean.
std::string yaml_value(const ConfigNode& field) {
  const std::string text = value_text(field);
  const FieldKind kind = field.kind();
  if (kind == FieldKind::kDouble || kind == FieldKind::kSpread) return with_points(text);
  return kind == FieldKind::kEnum && boolean_of_word(text) ? double_quoted(text) : text;
}

class Dump {
 public:
  Dump(Comments comments, std::optional<Affects> only) : comments_(comments), only_(only) {}

  void group(const ConfigNode& parent, std::size_t depth) {
    for (const ConfigNode& node : parent.children) {
      if (!wanted(node)) continue;
      this->node(node, depth);
      group(node, depth + 1);
    }
  }
  void node(const ConfigNode& node, std::size_t depth) {
    if (node.is_group()) {
      line(depth, node.key + ":", node.meaning);
    } else if (node.kind() == FieldKind::kSpreadMap) {
      map(node, depth);
    } else {
      // A hash uses the plain text, so it does not depend on quotes.
      line(depth, node.key + ": " + (comments_ == Comments::kOn ? yaml_value(node) : value_text(node)), comment(node));
    }
  }
  std::string text() && { return std::move(text_); }

 private:
  bool wanted(const ConfigNode& node) const {
    if (!only_) return true;
    if (!node.is_group()) return node.affects == *only_;
    return std::ranges::any_of(node.children, [this](const ConfigNode& child) { return wanted(child); });
  }
  std::string comment(const ConfigNode& node) const {
    if (comments_ == Comments::kOff) return {};
    const FieldKind kind = node.kind();
    if (kind == FieldKind::kAutoCount && std::get<AutoCount*>(*node.target)->is_auto) {
      return fmt::format("{} here [{}] {}", std::get<AutoCount*>(*node.target)->value, node.unit, node.meaning);
    }
    const bool shown = kind == FieldKind::kFrequency || kind == FieldKind::kByteSize || kind == FieldKind::kDuration;
    return shown || node.unit.empty() ? node.meaning : fmt::format("[{}] {}", node.unit, node.meaning);
  }
  void map(const ConfigNode& node, std::size_t depth) {
    const auto& spreads = *std::get<std::map<std::string, Spread>*>(*node.target);
    line(depth, node.key + (spreads.empty() ? ": {}" : ":"), comment(node));
    for (const auto& [name, spread] : spreads) {
      const std::string text = spread_text(spread);
      line(depth + 1, fmt::format("{}: {}", key_text(name), comments_ == Comments::kOn ? with_points(text) : text), {});
    }
  }
  void line(std::size_t depth, std::string_view content, std::string_view remark) {
    text_.append(2 * depth, ' ').append(content);
    if (comments_ == Comments::kOn && !remark.empty()) text_.append("  # ").append(remark);
    text_ += '\n';
  }

  Comments comments_;
  std::optional<Affects> only_;
  std::string text_;
};

}  // namespace

std::string dump_tree(const ConfigNode& root, Comments comments, std::optional<Affects> only) {
  Dump dump(comments, only);
  dump.group(root, 0);
  return std::move(dump).text();
}

std::string dump_node(const ConfigNode& node, std::size_t depth, Comments comments) {
  Dump dump(comments, {});
  dump.node(node, depth);
  return std::move(dump).text();
}

std::string hash_tree(const ConfigNode& root, std::optional<Affects> only) {
  return sha256_hex(dump_tree(root, Comments::kOff, only));
}

}  // namespace sim
