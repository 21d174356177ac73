#pragma once
#include <cstddef>
#include <string>

#include "sim/config/config_tree.h"
#include "sim/config/describe.h"

namespace sim {

/// Returns the lines of one field, or of a group without its fields, at a depth of `depth` groups.
std::string dump_node(const ConfigNode& node, std::size_t depth, Comments comments);

}  // namespace sim
