#include "traces/scene/gltf/extensions.h"

#include <algorithm>

#include <fmt/format.h>

namespace traces::gltf {
namespace {

constexpr std::string_view kSupported[] = {
    "EXT_mesh_gpu_instancing", "EXT_meshopt_compression", "KHR_draco_mesh_compression",
    "KHR_lights_punctual",     "KHR_materials_clearcoat", "KHR_materials_emissive_strength",
    "KHR_materials_ior",       "KHR_materials_specular",  "KHR_materials_transmission",
    "KHR_materials_unlit",     "KHR_materials_volume",    "KHR_mesh_quantization",
    "KHR_meshopt_compression", "KHR_texture_transform",
};

}  // namespace

bool is_supported_extension(std::string_view name) {
  return std::ranges::find(kSupported, name) != std::end(kSupported);
}

std::string supported_extensions() { return fmt::format("{}", fmt::join(kSupported, ", ")); }

}  // namespace traces::gltf
