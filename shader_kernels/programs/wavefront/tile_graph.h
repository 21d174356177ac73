#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "shader_kernels/catalogue.h"
#include "shader_kernels/ports.h"
#include "shader_kernels/programs/wavefront/scene_tables.h"
#include "shader_kernels/programs/wavefront/tile_result.h"
#include "traces/stream.h"

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
    stage_queue_array<&Q::rough>("rough", "rough_count"),
    stage_queue_array<&Q::targets>("targets", ""),
    buffer_array<&TileBuffer::surfaces, &HitSurfaces::points>("places"),
    buffer_array<&TileBuffer::surfaces, &HitSurfaces::mattes>("mattes"),
    buffer_array<&TileBuffer::surfaces, &HitSurfaces::texcoords>("texcoords"),
    buffer_array<&TileBuffer::surfaces, &HitSurfaces::optics>("optics"),
    buffer_array<&TileBuffer::surfaces, &HitSurfaces::tangents>("tangents"),
    buffer_array<&TileBuffer::samples, &SampleRecords::colours>("colours"),
    buffer_array<&TileBuffer::samples, &SampleRecords::geometry>("geometry"),
    buffer_array<&TileBuffer::samples, &SampleRecords::seeds>("seeds"),
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
    buffer_array<&TileBuffer::denoise, &DenoiseRecords::guides>("guides"),
    buffer_array<&TileBuffer::denoise, &DenoiseRecords::guide_words>("guide_words"),
    buffer_array<&TileBuffer::denoise, &DenoiseRecords::half_light>("light"),
    buffer_array<&TileBuffer::denoise, &DenoiseRecords::light>("light"),
    buffer_array<&TileBuffer::denoise, &DenoiseRecords::half_filtered>("filtered"),
    buffer_array<&TileBuffer::denoise, &DenoiseRecords::filtered>("filtered"),
    buffer_array<&TileBuffer::denoise, &DenoiseRecords::half_moments>("moments"),
    buffer_array<&TileBuffer::denoise, &DenoiseRecords::moments>("moments"),
    buffer_array<&TileBuffer::denoise, &DenoiseRecords::motions>("motions"),
    buffer_array<&TileBuffer::denoise, &DenoiseRecords::albedos>("albedos"),
    buffer_array<&TileBuffer::denoise, &DenoiseRecords::taps>("taps"),
    buffer_array<&TileBuffer::denoise, &DenoiseRecords::guide_taps>("guide_taps"),
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
    scene_array<&SceneTables::lights>("light_table"),
    scene_array<&SceneTables::discs>("disc_table"),
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

/// Builds a tile's graph of work, node by node. The storage of the previous contents is reused; unused nodes are kept
/// in `spare`. All functions do nothing if recording is off.
class StreamBuilder {
 public:
  using Node = std::uint32_t;
  static constexpr Node kNone = traces::WorkNode::kNone;

  StreamBuilder(traces::TileWork& work, std::vector<traces::WorkNode>& spare, bool on);
  bool is_enabled() const { return on_ && !muted_; }
  /// While the builder is muted, it records nothing.
  void set_muted(bool muted) { muted_ = muted; }
  bool is_muted() const { return muted_; }

  /// Adds the launch of a kernel over `items` items, followed by `idle` loop iterations that do no work.
  Node add_launch(traces::KernelId kernel, std::uint32_t items, bool has_accesses, std::uint32_t idle = 0);
  /// Begins the list of memory accesses of the next item of the last added launch. Call only if the launch has
  /// accesses.
  void begin_item_accesses() { work_.access_begin.push_back(static_cast<std::uint32_t>(work_.accesses.size())); }
  /// Records that item `item` of the last launch emitted a ray.
  void add_ray_source(std::uint32_t item) { work_.sources.push_back(item); }
  /// Adds a batch of rays that `launch` emitted: one per item or, if `is_mapped`, one per call of add_ray_source()
  /// since the launch.
  Node add_rays(traces::RayKind kind, std::uint32_t ray_count, std::uint32_t first, Node launch, bool is_mapped);
  Node add_transfer(traces::Region region, bool to_memory, std::uint64_t offset, std::uint32_t bytes);
  /// Adds a node that rasterises `samples` samples, whose rays `launch` generated. The last entry of TileWork::raster
  /// describes the rasterisation.
  Node add_rasterisation(std::uint32_t samples, Node launch);
  /// Adds a node that bins triangles to screen regions. The last entry of TileWork::raster describes the binning.
  Node add_binning(std::uint32_t triangles);
  /// Adds a node that builds a tree over `items` triangles or instances, as the last entry of TileWork::build
  /// describes.
  Node add_build(std::uint32_t items);
  /// Adds a transfer of samples to memory. Border `number` of the tile is complete when the transfer has ended.
  Node export_border(std::uint32_t number, std::uint64_t offset, std::uint32_t bytes);
  /// Adds a transfer of samples from memory. The transfer waits until another tile has written its border.
  Node import_border(traces::Border border, std::uint64_t offset, std::uint32_t bytes);
  void add_wait(Node node, Node for_node, traces::Edge::Kind kind);
  void finish();

 private:
  traces::WorkNode& add_node(traces::WorkNode::Kind kind, std::uint32_t items);

  traces::TileWork& work_;
  std::vector<traces::WorkNode>& spare_;
  bool on_;
  bool muted_ = false;
  Node count_ = 0;
  std::uint32_t launch_sources_ = 0;  ///< index in TileWork::sources of the first source of the last launch
};

/// Runs kernels on a tile's buffer. Each launch and transfer becomes a node of the tile's graph of work; nodes wait for
/// others.
class TileGraph {
 public:
  using Node = StreamBuilder::Node;
  static constexpr Node kNone = StreamBuilder::kNone;

  TileGraph(const SceneTables& scene, bool record, TileResult& out);

  /// Runs kernel K over `items` items and records the launch. Unbound ports are bound by name, and the lengths of the
  /// queues that K fills are set. `lanes`: number of items from which the entries of K's queue were selected. Without
  /// compaction (RenderConfig::streams) the launch runs over all these items. `padding`: number of empty entries in K's
  /// queue.
  template <class K>
  Node launch(typename K::template Ports<float>& ports, std::uint32_t items, std::uint32_t lanes = 0,
              std::uint32_t padding = 0);
  template <class K>
  Node launch(std::uint32_t items, std::uint32_t lanes = 0) {
    typename K::template Ports<float> ports;
    return launch<K>(ports, items, lanes);
  }
  /// Records a launch of kernel K without running the kernel, because the host already has the results. K has no memory
  /// accesses.
  template <class K>
  Node record_known_launch(std::uint32_t items) {
    return stream_.add_launch(kKernelId<K>, items, false);
  }

  void wait_for_all(Node node, Node for_node) { stream_.add_wait(node, for_node, traces::Edge::Kind::kAll); }
  void wait_item_by_item(Node node, Node for_node) { stream_.add_wait(node, for_node, traces::Edge::Kind::kEach); }
  /// wait_for_colour_writers() makes `node` wait for all earlier nodes that add to samples' colours,
  /// wait_for_record_writers() for all that write samples' records.
  void wait_for_colour_writers(Node node);
  void wait_for_record_writers(Node node);
  void register_colour_writer(Node node) { scratch_.colour_writers.push_back(node); }
  void register_record_writer(Node node) { scratch_.record_writers.push_back(node); }
  /// Makes later readers of colours wait for `node` only. `node` must itself wait for all earlier colour writers.
  void replace_colour_writers(Node node) { scratch_.colour_writers.assign(1, node); }

  Node add_transfer(traces::Region region, bool to_memory, std::uint64_t offset, std::uint32_t bytes) {
    return stream_.add_transfer(region, to_memory, offset, bytes);
  }
  Node export_border(std::uint32_t number, std::uint64_t offset, std::uint32_t bytes) {
    return stream_.export_border(number, offset, bytes);
  }
  Node import_border(traces::Border border, std::uint64_t offset, std::uint32_t bytes) {
    return stream_.import_border(border, offset, bytes);
  }
  /// Adds a transfer of border `number` to memory, after all earlier nodes that write records and colours.
  void export_samples(std::uint32_t number, std::uint64_t offset, std::uint32_t bytes);
  /// Adds a transfer of another tile's border from memory. The transfer counts as a writer of records and colours.
  void import_samples(traces::Border border, std::uint64_t offset, std::uint32_t bytes);

  /// Encodes the tile's pixels after node `averaged`, and writes them to byte `offset` of the picture.
  void write_pixels(Node averaged, std::uint64_t offset);
  /// Writes pixels that node `packed` has encoded to byte `offset` of the picture.
  void write_packed_pixels(Node packed, std::uint64_t offset);
  /// Writes linear pixels to byte `offset` of the picture; the DMA encodes them. Returns the transfer.
  Node write_linear_pixels(std::uint64_t offset);

  /// Stops recording: kernels still run on the host, but their work belongs to another tile.
  void pause_recording() { stream_.set_muted(true); }
  void resume_recording() { stream_.set_muted(false); }
  bool is_muted() const { return stream_.is_muted(); }
  bool is_recording() const { return stream_.is_enabled(); }
  void finish() { stream_.finish(); }

  StreamBuilder& stream_builder() { return stream_; }

  /// Returns the list that receives the accesses of cached ports; null if nothing is recorded.
  std::vector<traces::Access>* access_log() { return stream_.is_enabled() ? &out_.work.accesses : nullptr; }

 private:
  const SceneTables& scene_;
  TileResult& out_;
  TileScratch& scratch_;
  StreamBuilder stream_;
};

template <class K>
TileGraph::Node TileGraph::launch(typename K::template Ports<float>& ports, std::uint32_t items, std::uint32_t lanes,
                                  std::uint32_t padding) {
  constexpr bool kReads = kListsAccesses<typename K::template Ports<float>>;
  constexpr bool kEmits = requires { ports.emitted; };
  const std::uint32_t idle = scene_.diverges && lanes > items ? lanes - items : padding;
  const Node node = stream_.add_launch(kKernelId<K>, items, kReads, idle);
  bind_ports<K>(ports, out_, scene_, access_log());
  typename K::template Ports<float> at = ports;  // a local copy, so that the compiler keeps it in registers
  if (!stream_.is_enabled()) {
    for (std::uint32_t i = 0; i < items; ++i) K::template body<float>(i, at);
  } else {
    for (std::uint32_t i = 0; i < items; ++i) {
      if constexpr (kReads) stream_.begin_item_accesses();
      if constexpr (kEmits) {
        const std::uint32_t before = at.emitted.value;
        K::template body<float>(i, at);
        if (at.emitted.value != before) stream_.add_ray_source(i);
      } else {
        K::template body<float>(i, at);
      }
    }
  }
  ports = at;
  set_queue_lengths<K>(ports, out_);
  return node;
}

}  // namespace kernels
