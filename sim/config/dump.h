#pragma once
#include <cstddef>
#include <string>

#include "sim/config/config_tree.h"
#include "sim/config/describe.h"

namespace sim {

/// Returns the lines of a field in dump_tree(), or of a group without its fields, `depth` groups deep.
std::string dump_node(const ConfigNode& node, std::size_t depth, Comments comments);

}  // namespace sim
