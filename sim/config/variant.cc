#include "sim/config/variant.h"

#include <cassert>

#include "sim/config/config_tree.h"
#include "sim/config/describe.h"
#include "sim/sha256.h"

namespace sim {
namespace {

std::uint32_t affects_bit(Affects affects) { return std::uint32_t{1} << static_cast<unsigned>(affects); }

bool are_same(const AutoCount& a, const AutoCount& b) { return a.value == b.value && a.is_auto == b.is_auto; }
bool are_same(const auto& a, const auto& b) { return a == b; }

/// True if two nodes of the same configuration field have the same value.
bool has_same_value(const ConfigNode& a, const ConfigNode& b) {
  return std::visit(
      Overloaded{[&](const EnumTarget& of_a) { return of_a.get() == std::get<EnumTarget>(*b.target).get(); },
                 [&]<class T>(T* of_a) { return are_same(*of_a, *std::get<T*>(*b.target)); }},
      *a.target);
}

void copy_value(const ConfigNode& from, ConfigNode& to) {
  std::visit(Overloaded{[&](const EnumTarget& source) { std::get<EnumTarget>(*to.target).set(source.get()); },
                        [&]<class T>(T* source) { *std::get<T*>(*to.target) = *source; }},
             *from.target);
}

}  // namespace

ConfigVariant::ConfigVariant(const ConfigNode& base, ConfigNode& variant) {
  for (std::size_t i = 0; i < base.children.size(); ++i) add_node(base.children[i], variant.children.at(i), 0);
  for (const Node& node : nodes_) bytes_ += node.text.size();
}

std::uint32_t ConfigVariant::add_node(const ConfigNode& base, ConfigNode& variant, std::size_t depth) {
  assert(base.key == variant.key);
  const std::size_t at = nodes_.size();
  nodes_.push_back({&base, &variant, depth, dump_node(base, depth, Comments::kOff), 0});
  std::uint32_t affects = base.is_group() ? 0 : affects_bit(base.affects);
  for (std::size_t i = 0; i < base.children.size(); ++i) {
    affects |= add_node(base.children[i], variant.children.at(i), depth + 1);
  }
  nodes_[at].affects = affects;
  return affects;
}

void ConfigVariant::reset() {
  for (Node& node : nodes_) {
    if (node.variant->nearness != node.base->nearness || node.variant->origin != node.base->origin) {
      node.variant->nearness = node.base->nearness;
      node.variant->origin = node.base->origin;
    }
    if (!node.base->is_group() && !has_same_value(*node.base, *node.variant)) copy_value(*node.base, *node.variant);
  }
}

std::string ConfigVariant::hash(std::optional<Affects> only) const {
  std::string text;
  text.reserve(bytes_ + bytes_ / 4);  // spare room, because changed values may be longer than in the base
  for (const Node& node : nodes_) {
    if (only && (node.affects & affects_bit(*only)) == 0) continue;
    const bool is_unchanged = node.base->is_group() || has_same_value(*node.base, *node.variant);
    text += is_unchanged ? node.text : dump_node(*node.variant, node.depth, Comments::kOff);
  }
  return sha256_hex(text);
}

}  // namespace sim
