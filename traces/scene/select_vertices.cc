#include "traces/scene/select_vertices.h"

namespace traces {
namespace {

template <class T>
void select(std::vector<T>& values, const std::vector<std::uint32_t>& from) {
  if (values.empty()) return;
  std::vector<T> selected;
  selected.reserve(from.size());
  for (const std::uint32_t i : from) selected.push_back(values[i]);
  values = std::move(selected);
}

}  // namespace

void select_vertices(Mesh& mesh, const std::vector<std::uint32_t>& from) {
  select(mesh.positions, from);
  select(mesh.normals, from);
  select(mesh.uvs, from);
  select(mesh.second_uvs, from);
  select(mesh.tangents, from);
  select(mesh.colours, from);
}

}  // namespace traces
