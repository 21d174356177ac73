#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "shader_kernels/ports.h"
#include "shader_kernels/programs/wavefront/scene_tables.h"
#include "shader_kernels/programs/wavefront/tile_result.h"

namespace kernels {

// Binds a kernel's ports to arrays of the tile or the scene. A port is bound to the array with its name and record
// type. Names are compared at compile time; a launch only loads addresses.

/// The record type with which kernels read and write elements of type T.
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

/// A variable whose address identifies the record type.
template <class Record>
inline constexpr char kRecordType = 0;

/// An array to which ports can be bound.
struct PortArray {
  std::string_view name;
  const char* record;
  const void* (*data)(const TileResult&, const SceneTables&);
  std::string_view counter{};  ///< if the array is a queue, the name of the port that counts its items
  std::uint32_t* (*items)(TileResult&) = nullptr;
};

namespace port_arrays {

/// Returns the member of an object that a list of member pointers leads to: `follow_members<&A::b, &B::c>(a)` is a.b.c.
template <auto kMember, auto... kRest>
constexpr auto& follow_members(auto& object) {
  if constexpr (sizeof...(kRest) == 0) {
    return object.*kMember;
  } else {
    return follow_members<kRest...>(object.*kMember);
  }
}

template <class T>
const void* array_data(const std::vector<T>& array) {
  static_assert(sizeof(T) == sizeof(typename RecordOf<T>::Type));
  return array.data();
}
template <class T>
constexpr const char* record_type(const std::vector<T>* /*array*/) {
  return &kRecordType<typename RecordOf<T>::Type>;
}
template <class Root, auto... kPath>
using Array = std::remove_reference_t<decltype(follow_members<kPath...>(std::declval<Root&>()))>;

template <auto... kPath>
constexpr PortArray of_tile(std::string_view name) {
  return {name, record_type(static_cast<Array<const TileResult, kPath...>*>(nullptr)),
          [](const TileResult& tile, const SceneTables&) { return array_data(follow_members<kPath...>(tile)); }};
}
template <auto... kPath>
constexpr PortArray of_buffer(std::string_view name) {
  return of_tile<&TileResult::buffer, kPath...>(name);
}
template <auto... kPath>
constexpr PortArray tile_queue(std::string_view name, std::string_view counter) {
  return {name, &kRecordType<WordRecord<float>>,
          [](const TileResult& tile, const SceneTables&) {
            return array_data(follow_members<kPath...>(tile.buffer).entries);
          },
          counter, [](TileResult& tile) { return &follow_members<kPath...>(tile.buffer).items; }};
}
template <auto kMember>
constexpr PortArray stage_queue(std::string_view name, std::string_view counter) {
  return tile_queue<&TileBuffer::queues, kMember>(name, counter);
}
template <auto kMember>
constexpr PortArray of_scene(std::string_view name) {
  return {name, record_type(static_cast<Array<const SceneTables, kMember>*>(nullptr)),
          [](const TileResult&, const SceneTables& scene) { return array_data(scene.*kMember); }};
}
template <auto kMember>
constexpr PortArray of_image(std::string_view name) {
  return {name, record_type(static_cast<Array<const traces::MemoryImage, kMember>*>(nullptr)),
          [](const TileResult&, const SceneTables& scene) { return array_data(scene.image.*kMember); }};
}

using Rays = RayBuffers;
using Q = StageQueues;
inline constexpr auto kAll = std::to_array<PortArray>({
    of_buffer<&TileBuffer::rays, &Rays::wave, &RaySlots::rays>("rays"),
    of_buffer<&TileBuffer::rays, &Rays::wave, &RaySlots::paths>("paths"),
    of_buffer<&TileBuffer::rays, &Rays::wave, &RaySlots::hits>("hits"),
    of_buffer<&TileBuffer::rays, &Rays::shadow, &RaySlots::rays>("shadow_rays"),
    of_buffer<&TileBuffer::rays, &Rays::shadow, &RaySlots::paths>("shadow_paths"),
    of_buffer<&TileBuffer::rays, &Rays::shadow, &RaySlots::hits>("shadow_hits"),
    of_buffer<&TileBuffer::rays, &Rays::layer, &RaySlots::hits>("layer_hits"),
    stage_queue<&Q::misses>("misses", "miss_count"),
    stage_queue<&Q::surfaces>("surfaces", "surface_count"),
    stage_queue<&Q::textured>("textured", "textured_count"),
    stage_queue<&Q::diffuse>("diffuse", "diffuse_count"),
    stage_queue<&Q::deferred>("later", "later_count"),
    stage_queue<&Q::mirror>("mirror", "mirror_count"),
    stage_queue<&Q::glass>("glass", "glass_count"),
    stage_queue<&Q::emissive>("emissive", "emissive_count"),
    stage_queue<&Q::absorbing>("absorbing", "absorbing_count"),
    stage_queue<&Q::vertexed>("vertexed", "vertexed_count"),
    stage_queue<&Q::based>("based", "based_count"),
    stage_queue<&Q::physical>("physical", "physical_count"),
    stage_queue<&Q::bumped>("bumped", "bumped_count"),
    stage_queue<&Q::blended>("blended", "blended_count"),
    stage_queue<&Q::glowing>("glowing", "glowing_count"),
    stage_queue<&Q::occluded>("occluded", "occluded_count"),
    stage_queue<&Q::layers>("layers", "layer_count"),
    stage_queue<&Q::targets>("targets", ""),
    of_buffer<&TileBuffer::surfaces, &HitSurfaces::points>("places"),
    of_buffer<&TileBuffer::surfaces, &HitSurfaces::mattes>("mattes"),
    of_buffer<&TileBuffer::surfaces, &HitSurfaces::texcoords>("texcoords"),
    of_buffer<&TileBuffer::surfaces, &HitSurfaces::optics>("optics"),
    of_buffer<&TileBuffer::surfaces, &HitSurfaces::tangents>("tangents"),
    of_buffer<&TileBuffer::samples, &SampleRecords::colours>("colours"),
    of_buffer<&TileBuffer::samples, &SampleRecords::geometry>("geometry"),
    of_buffer<&TileBuffer::samples, &SampleRecords::secondary>("secondary"),
    of_buffer<&TileBuffer::samples, &SampleRecords::kept>("kept"),
    of_buffer<&TileBuffer::samples, &SampleRecords::globals>("globals"),
    of_buffer<&TileBuffer::checks, &CheckRecords::verdicts>("verdicts"),
    of_buffer<&TileBuffer::checks, &CheckRecords::identities>("identities"),
    tile_queue<&TileBuffer::checks, &CheckRecords::samples>("samples", ""),
    tile_queue<&TileBuffer::checks, &CheckRecords::passed>("passed", "passed_count"),
    tile_queue<&TileBuffer::checks, &CheckRecords::failed>("failed", "failed_count"),
    of_buffer<&TileBuffer::subpixels, &SubpixelRecords::traits>("traits"),
    of_buffer<&TileBuffer::subpixels, &SubpixelRecords::branches>("branches"),
    of_buffer<&TileBuffer::subpixels, &SubpixelRecords::active>("active"),
    tile_queue<&TileBuffer::subpixels, &SubpixelRecords::masters>("masters", "masters_count"),
    of_buffer<&TileBuffer::subpixels, &SubpixelRecords::fills>("fills"),
    of_buffer<&TileBuffer::subpixels, &SubpixelRecords::states>("states"),
    of_buffer<&TileBuffer::subpixels, &SubpixelRecords::shown>("shown"),
    of_buffer<&TileBuffer::filters, &FilterRecords::visible>("visible"),
    of_buffer<&TileBuffer::filters, &FilterRecords::lights>("lights"),
    of_buffer<&TileBuffer::filters, &FilterRecords::ratios>("ratios"),
    of_tile<&TileResult::linear>("pixels"),
    of_tile<&TileResult::packed>("packed"),
    of_image<&traces::MemoryImage::attributes>("attributes"),
    of_image<&traces::MemoryImage::triangles>("triangles"),
    of_image<&traces::MemoryImage::instances>("instances"),
    of_image<&traces::MemoryImage::materials>("materials"),
    of_image<&traces::MemoryImage::vertices>("vertices"),
    of_image<&traces::MemoryImage::details>("details"),
    of_image<&traces::MemoryImage::textures>("texels"),
    of_scene<&SceneTables::axes>("axes"),
    of_scene<&SceneTables::levels>("levels"),
    of_scene<&SceneTables::srgb_codes>("srgb_codes"),
});

}  // namespace port_arrays

/// True if P is a port of records. Ports that are neither records nor counters are uniforms.
template <class P>
inline constexpr bool kIsRecordPort = requires {
  typename P::Record;
};
template <class P>
inline constexpr bool kIsCounter = std::is_same_v<P, Counter<float>>;

inline constexpr std::uint8_t kNoArray = 0xff;
inline constexpr std::size_t kMostPorts = 64;
/// For each record port and counter of a kernel, in order, the index of its array in port_arrays::kAll, or kNoArray.
using PortMatches = std::array<std::uint8_t, kMostPorts>;

template <class K>
consteval PortMatches match_ports() {
  PortMatches found{};
  std::size_t count = 0;
  typename K::template Ports<float> ports{};
  K::template Ports<float>::describe(ports, [&]<class P>(P&, std::string_view name) {
    if constexpr (kIsRecordPort<P> || kIsCounter<P>) {
      std::uint8_t& match = found[count++];
      match = kNoArray;
      for (std::size_t i = 0; i < port_arrays::kAll.size(); ++i) {
        const PortArray& array = port_arrays::kAll[i];
        bool fits = false;
        if constexpr (kIsRecordPort<P>) {
          fits = array.name == name && array.record == &kRecordType<typename RecordOf<typename P::Record>::Type>;
        } else {
          fits = array.counter == name;
        }
        if (fits) match = static_cast<std::uint8_t>(i);
      }
    }
  });
  return found;
}
template <class K>
inline constexpr PortMatches kPortMatches = match_ports<K>();

[[noreturn]] inline void fail_to_bind(std::string_view kernel, std::string_view port) {
  throw std::logic_error("kernel '" + std::string(kernel) + "': port '" + std::string(port) +
                         "' is not bound, and no array of the tile or the scene has its name and type");
}

/// Binds the ports of kernel K that are not bound yet. Cached ports append their accesses to `log` unless it is null.
/// Throws std::logic_error if a port has no array.
template <class K>
void bind_ports(typename K::template Ports<float>& ports, const TileResult& tile, const SceneTables& scene,
                std::vector<traces::Access>* log) {
  std::size_t next = 0;
  K::template Ports<float>::describe(ports, [&]<class P>(P& port, std::string_view name) {
    if constexpr (kIsRecordPort<P>) {
      const std::uint8_t found = kPortMatches<K>[next++];
      if (port.is_bound()) return;
      if (found == kNoArray) fail_to_bind(K::kName, name);
      port.attach(const_cast<void*>(port_arrays::kAll[found].data(tile, scene)), log);
    } else if constexpr (kIsCounter<P>) {
      ++next;
    }
  });
}

/// Sets the lengths of the queues to which a launch of kernel K has appended.
template <class K>
void count_queued(typename K::template Ports<float>& ports, TileResult& tile) {
  std::size_t next = 0;
  K::template Ports<float>::describe(ports, [&]<class P>(P& port, std::string_view) {
    if constexpr (kIsRecordPort<P>) {
      ++next;
    } else if constexpr (kIsCounter<P>) {
      const std::uint8_t found = kPortMatches<K>[next++];
      if (found != kNoArray) *port_arrays::kAll[found].items(tile) = port.value;
    }
  });
}

}  // namespace kernels
