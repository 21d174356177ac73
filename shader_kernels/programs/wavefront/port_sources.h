#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <typeinfo>
#include <vector>

#include "shader_kernels/ports.h"
#include "shader_kernels/programs/wavefront/scene_tables.h"
#include "shader_kernels/programs/wavefront/tile_result.h"

namespace kernels {

/// The record as which kernels read and write elements of type T.
template <class T>
struct RecordOf {
  using Type = T;
};
// clang-format off
template <> struct RecordOf<std::uint32_t> { using Type = WordRecord<float>; };
template <> struct RecordOf<glm::vec3> { using Type = ColourRecord<float>; };
template <> struct RecordOf<traces::Ray> { using Type = RayRecord<float>; };
template <> struct RecordOf<traces::Hit> { using Type = HitRecord<float>; };
template <> struct RecordOf<InstanceHitRecord<float>> { using Type = HitRecord<float>; };
template <> struct RecordOf<traces::AttributeRecord> { using Type = AttributeFields<float>; };
template <> struct RecordOf<traces::TriangleRecord> { using Type = TriangleFields<float>; };
template <> struct RecordOf<traces::InstanceRecord> { using Type = InstanceFields<float>; };
template <> struct RecordOf<traces::MaterialRecord> { using Type = MaterialFields<float>; };
template <> struct RecordOf<traces::VertexRecord> { using Type = VertexFields<float>; };
template <> struct RecordOf<traces::MaterialDetailRecord> { using Type = DetailFields<float>; };
// clang-format on

/// The arrays that a tile's launches read and write: the tile's pixels, its buffer, the scene. A port of the float
/// reading is bound to the array that has its name and holds records of its type. Names are compared once per kernel,
/// not per launch.
class PortSources {
 public:
  PortSources(const SceneTables& scene, TileResult& out);

  /// Binds the ports of kernel K that are not bound yet; cached ones note their accesses in `log` unless it is null.
  /// Throws std::logic_error if there is no array for one of them.
  template <class K>
  void bind(typename K::template Ports<float>& ports, std::vector<traces::Access>* log) const;

 private:
  struct Source {
    const char* name;
    const std::type_info* record;
    const void* array;  ///< a std::vector
    const void* (*data)(const void* array);
  };
  static constexpr std::size_t kMostSources = 80, kMostPorts = 48;
  static constexpr std::uint8_t kNone = 0xff;
  using Matches = std::array<std::uint8_t, kMostPorts>;

  template <class T>
  void add(const std::vector<T>& array, const char* name) {
    using Record = typename RecordOf<T>::Type;
    static_assert(sizeof(T) == sizeof(Record));
    const auto data = [](const void* of) -> const void* { return static_cast<const std::vector<T>*>(of)->data(); };
    sources_[count_++] = {name, &typeid(Record), &array, data};
  }
  /// The index of each port's array in sources_, which every tile fills in the same order; or kNone.
  template <class K>
  Matches match() const;
  std::uint8_t find(std::string_view name, const std::type_info& record) const;
  [[noreturn]] static void fail(std::string_view kernel, std::string_view port);

  std::size_t count_ = 0;
  std::array<Source, kMostSources> sources_;
};

template <class K>
auto PortSources::match() const -> Matches {
  Matches found{};
  std::size_t count = 0;
  typename K::template Ports<float> ports;
  K::template Ports<float>::describe(ports, [&]<class P>(P&, const auto& name) {
    if constexpr (requires { typename P::Record; }) {
      found.at(count++) = find(name, typeid(typename RecordOf<typename P::Record>::Type));
    }
  });
  return found;
}

template <class K>
void PortSources::bind(typename K::template Ports<float>& ports, std::vector<traces::Access>* log) const {
  static const Matches kFound = match<K>();
  std::size_t next = 0;
  K::template Ports<float>::describe(ports, [&]<class P>(P& port, const auto& name) {
    if constexpr (requires { typename P::Record; }) {
      const std::uint8_t found = kFound[next++];
      if (port.is_bound()) return;
      if (found == kNone) fail(K::kName, name);
      const Source& source = sources_[found];
      port.attach(const_cast<void*>(source.data(source.array)), log);
    }
  });
}

}  // namespace kernels
