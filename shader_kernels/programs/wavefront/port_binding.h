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

/// The record type with which kernels read and write array elements of type T.
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

/// A variable whose address identifies the type `Record` of array elements.
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
constexpr PortArray tile_array(std::string_view name) {
  return {name, record_type(static_cast<Array<const TileResult, kPath...>*>(nullptr)),
          [](const TileResult& tile, const SceneTables&) { return array_data(follow_members<kPath...>(tile)); }};
}
template <auto... kPath>
constexpr PortArray buffer_array(std::string_view name) {
  return tile_array<&TileResult::buffer, kPath...>(name);
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
constexpr PortArray stage_queue_array(std::string_view name, std::string_view counter) {
  return tile_queue<&TileBuffer::queues, kMember>(name, counter);
}
template <auto kMember>
constexpr PortArray scene_array(std::string_view name) {
  return {name, record_type(static_cast<Array<const SceneTables, kMember>*>(nullptr)),
          [](const TileResult&, const SceneTables& scene) { return array_data(scene.*kMember); }};
}
template <auto kMember>
constexpr PortArray image_array(std::string_view name) {
  return {name, record_type(static_cast<Array<const traces::MemoryImage, kMember>*>(nullptr)),
          [](const TileResult&, const SceneTables& scene) { return array_data(scene.image.*kMember); }};
}

using Rays = RayBuffers;
using Q = StageQueues;
inline constexpr auto kAll = std::to_array<PortArray>({
    buffer_array<&TileBuffer::rays, &Rays::wave, &RaySlots::rays>("rays"),
    buffer_array<&TileBuffer::rays, &Rays::wave, &RaySlots::paths>("paths"),
    buffer_array<&TileBuffer::rays, &Rays::wave, &RaySlots::hits>("hits"),
    buffer_array<&TileBuffer::rays, &Rays::shadow, &RaySlots::rays>("shadow_rays"),
    buffer_array<&TileBuffer::rays, &Rays::shadow, &RaySlots::paths>("shadow_paths"),
    buffer_array<&TileBuffer::rays, &Rays::shadow, &RaySlots::hits>("shadow_hits"),
    buffer_array<&TileBuffer::rays, &Rays::layer, &RaySlots::hits>("layer_hits"),
    stage_queue_array<&Q::misses>("misses", "miss_count"),
    stage_queue_array<&Q::surfaces>("surfaces", "surface_count"),
    stage_queue_array<&Q::textured>("textured", "textured_count"),
    stage_queue_array<&Q::diffuse>("diffuse", "diffuse_count"),
    stage_queue_array<&Q::deferred>("later", "later_count"),
    stage_queue_array<&Q::mirror>("mirror", "mirror_count"),
    stage_queue_array<&Q::glass>("glass", "glass_count"),
    stage_queue_array<&Q::emissive>("emissive", "emissive_count"),
    stage_queue_array<&Q::absorbing>("absorbing", "absorbing_count"),
    stage_queue_array<&Q::vertexed>("vertexed", "vertexed_count"),
    stage_queue_array<&Q::based>("based", "based_count"),
    stage_queue_array<&Q::physical>("physical", "physical_count"),
    stage_queue_array<&Q::bumped>("bumped", "bumped_count"),
    stage_queue_array<&Q::blended>("blended", "blended_count"),
    stage_queue_array<&Q::glowing>("glowing", "glowing_count"),
    stage_queue_array<&Q::occluded>("occluded", "occluded_count"),
    stage_queue_array<&Q::layers>("layers", "layer_count"),
    stage_queue_array<&Q::targets>("targets", ""),
    buffer_array<&TileBuffer::surfaces, &HitSurfaces::points>("places"),
    buffer_array<&TileBuffer::surfaces, &HitSurfaces::mattes>("mattes"),
    buffer_array<&TileBuffer::surfaces, &HitSurfaces::texcoords>("texcoords"),
    buffer_array<&TileBuffer::surfaces, &HitSurfaces::optics>("optics"),
    buffer_array<&TileBuffer::surfaces, &HitSurfaces::tangents>("tangents"),
    buffer_array<&TileBuffer::samples, &SampleRecords::colours>("colours"),
    buffer_array<&TileBuffer::samples, &SampleRecords::geometry>("geometry"),
    buffer_array<&TileBuffer::samples, &SampleRecords::secondary>("secondary"),
    buffer_array<&TileBuffer::samples, &SampleRecords::kept>("kept"),
    buffer_array<&TileBuffer::samples, &SampleRecords::globals>("globals"),
    buffer_array<&TileBuffer::checks, &CheckRecords::verdicts>("verdicts"),
    buffer_array<&TileBuffer::checks, &CheckRecords::identities>("identities"),
    tile_queue<&TileBuffer::checks, &CheckRecords::samples>("samples", ""),
    tile_queue<&TileBuffer::checks, &CheckRecords::passed>("passed", "passed_count"),
    tile_queue<&TileBuffer::checks, &CheckRecords::failed>("failed", "failed_count"),
    buffer_array<&TileBuffer::subpixels, &SubpixelRecords::traits>("traits"),
    buffer_array<&TileBuffer::subpixels, &SubpixelRecords::branches>("branches"),
    buffer_array<&TileBuffer::subpixels, &SubpixelRecords::active>("active"),
    tile_queue<&TileBuffer::subpixels, &SubpixelRecords::masters>("masters", "masters_count"),
    buffer_array<&TileBuffer::subpixels, &SubpixelRecords::fills>("fills"),
    buffer_array<&TileBuffer::subpixels, &SubpixelRecords::states>("states"),
    buffer_array<&TileBuffer::subpixels, &SubpixelRecords::shown>("shown"),
    buffer_array<&TileBuffer::filters, &FilterRecords::visible>("visible"),
    buffer_array<&TileBuffer::filters, &FilterRecords::lights>("lights"),
    buffer_array<&TileBuffer::filters, &FilterRecords::ratios>("ratios"),
    tile_array<&TileResult::linear>("pixels"),
    tile_array<&TileResult::packed>("packed"),
    image_array<&traces::MemoryImage::attributes>("attributes"),
    image_array<&traces::MemoryImage::triangles>("triangles"),
    image_array<&traces::MemoryImage::instances>("instances"),
    image_array<&traces::MemoryImage::materials>("materials"),
    image_array<&traces::MemoryImage::vertices>("vertices"),
    image_array<&traces::MemoryImage::details>("details"),
    image_array<&traces::MemoryImage::textures>("texels"),
    scene_array<&SceneTables::axes>("axes"),
    scene_array<&SceneTables::levels>("levels"),
    scene_array<&SceneTables::srgb_codes>("srgb_codes"),
});

}  // namespace port_arrays

/// True if port type P accesses records. Ports that neither access records nor are counters are uniforms.
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

[[noreturn]] inline void throw_unbound_port(std::string_view kernel, std::string_view port) {
  throw std::logic_error("kernel '" + std::string(kernel) + "': port '" + std::string(port) +
                         "' is not bound, and no array of the tile or the scene has its name and type");
}

/// Binds the ports of kernel K that are not bound yet. Ports that read through the data cache append their accesses to
/// `log` unless it is null. Throws std::logic_error if a port has no array.
template <class K>
void bind_ports(typename K::template Ports<float>& ports, const TileResult& tile, const SceneTables& scene,
                std::vector<traces::Access>* log) {
  std::size_t next = 0;
  K::template Ports<float>::describe(ports, [&]<class P>(P& port, std::string_view name) {
    if constexpr (kIsRecordPort<P>) {
      const std::uint8_t found = kPortMatches<K>[next++];
      if (port.is_bound()) return;
      if (found == kNoArray) throw_unbound_port(K::kName, name);
      port.bind_raw(const_cast<void*>(port_arrays::kAll[found].data(tile, scene)), log);
    } else if constexpr (kIsCounter<P>) {
      ++next;
    }
  });
}

/// Sets the lengths of the queues to which a launch of kernel K has appended.
template <class K>
void set_queue_lengths(typename K::template Ports<float>& ports, TileResult& tile) {
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
