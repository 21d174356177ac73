#pragma once
#include <bit>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>

#include "shader_kernels/graph.h"
#include "shader_kernels/ports.h"

namespace kernels {

/// Data that an interpreted graph reads and writes, by port name: memories, uniforms and loop-carried values.
struct Environment {
  std::map<std::string, std::byte*, std::less<>> memories;
  std::map<std::string, std::uint32_t, std::less<>> uniforms;
  std::map<std::string, std::uint32_t, std::less<>> carried;  ///< before a run, the value for the first item; after it,
                                                              ///< the value that the last item produced
  const traces::Texture* textures = nullptr;
};

/// Executes `graph` for items 0 to `items` - 1. Tests compare the results with those of the kernel's C++ code.
void interpret_graph(const Graph& graph, std::uint32_t items, Environment& environment);

/// Fills an Environment from the ports of a kernel. A visitor for the kernel's describe().
class EnvironmentBinder {
 public:
  explicit EnvironmentBinder(Environment& environment) : to_(environment) {}

  template <template <class> class R>
  void operator()(const Local<float, R>& port, std::string_view name) const {
    to_.memories.emplace(name, port.base);
  }
  template <template <class> class R>
  void operator()(const Table<float, R>& port, std::string_view name) const {
    to_.memories.emplace(name, const_cast<std::byte*>(port.base));
  }
  template <template <class> class R, traces::Access::Kind kKind>
  void operator()(const Cached<float, R, kKind>& port, std::string_view name) const {
    to_.memories.emplace(name, const_cast<std::byte*>(port.base));
  }
  void operator()(const Texels<float>& port, std::string_view) const { to_.textures = port.textures; }
  void operator()(const Counter<float>& port, std::string_view name) const { to_.carried.emplace(name, port.value); }
  void operator()(const LoopCarried<float>& port, std::string_view name) const {
    to_.carried.emplace(name, std::bit_cast<std::uint32_t>(port.value));
  }
  void operator()(std::uint32_t uniform, std::string_view name) const { to_.uniforms.emplace(name, uniform); }
  void operator()(float uniform, std::string_view name) const {
    to_.uniforms.emplace(name, std::bit_cast<std::uint32_t>(uniform));
  }
  void operator()(const Vec3<float>& uniform, std::string_view name) const {
    const std::string prefix(name);
    (*this)(uniform.x, prefix + ".x");
    (*this)(uniform.y, prefix + ".y");
    (*this)(uniform.z, prefix + ".z");
  }

 private:
  Environment& to_;
};

}  // namespace kernels
