#include "traces/scene/gltf/extensions.h"

#include <ranges>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "traces/scene/gltf/schema.h"

namespace traces::gltf {

bool is_supported_extension(std::string_view name) { return extension_kinds().contains(name); }

std::string supported_extensions() { return fmt::format("{}", fmt::join(extension_kinds() | std::views::keys, ", ")); }

}  // namespace traces::gltf
