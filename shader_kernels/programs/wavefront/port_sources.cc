#include "shader_kernels/programs/wavefront/port_sources.h"

#include <stdexcept>
#include <string>

namespace kernels {

PortSources::PortSources(const SceneTables& scene, TileResult& out) {
  const auto source = [this](const auto& array, const char* name) { add(array, name); };
  TileBuffer::describe(out.buffer, source);
  SceneTables::describe(scene, source);
  add(out.linear, "pixels");
  add(out.packed, "packed");
}

std::uint8_t PortSources::find(std::string_view name, const std::type_info& record) const {
  for (std::size_t i = 0; i < count_; ++i) {
    if (name == sources_[i].name && record == *sources_[i].record) return static_cast<std::uint8_t>(i);
  }
  return kNone;
}

void PortSources::fail(std::string_view kernel, std::string_view port) {
  throw std::logic_error("kernel '" + std::string(kernel) + "': port '" + std::string(port) +
                         "' is not bound, and no array of the tile or the scene has its name and type");
}

}  // namespace kernels
