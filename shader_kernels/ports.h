#pragma once
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <vector>

#include "shader_kernels/records.h"
#include "traces/scene/scene.h"
#include "traces/stream.h"

namespace kernels {

// Ports of kernels. A kernel's Ports struct names its ports with describe(ports, port). The classes here are for V =
// float, where a port is a pointer or a number. The classes for V = Recorded are in recorder.h.
//
// bind_raw() binds a port to the array of the same name (programs/wavefront/tile_graph.h); bind() binds it to any
// array.

/// A port through which a kernel loads and stores records in the tile buffer.
template <class V, template <class> class R>
struct Local;
/// A port through which a kernel loads records from the SRP's own memory (kernel data).
template <class V, template <class> class R>
struct Table;
/// A port through which a kernel loads records from memory, through the data cache.
template <class V, template <class> class R, traces::Access::Kind kKind>
struct Cached;
/// A port through which a kernel loads texels from memory, through the data cache. A load reads a bilinear footprint;
/// the cache's address generator finds its one to four lines.
template <class V>
struct Texels;
/// A port for the length of a list to which a kernel appends records. next_index(keep) returns the index after the last
/// record. If `keep` is false, the record stored at this index is dropped: the next one overwrites it.
template <class V>
struct Counter;
/// A port for a loop-carried value, which each item of a kernel passes to the next item.
template <class V>
struct LoopCarried;

/// Copies record `index` from raw memory, whatever C++ type was stored there.
template <template <class> class R>
R<float> load_record(const std::byte* base, std::uint32_t index) {
  R<float> record;
  std::memcpy(&record, base + std::size_t{index} * sizeof(record), sizeof(record));
  return record;
}

template <template <class> class R>
struct Local<float, R> {
  using Record = R<float>;
  std::byte* base = nullptr;
  template <class T>
  void bind(T* records) {
    static_assert(sizeof(T) == sizeof(R<float>) && std::is_trivially_copyable_v<T>);
    base = reinterpret_cast<std::byte*>(records);
  }
  bool is_bound() const { return base != nullptr; }
  void bind_raw(void* records, std::vector<traces::Access>* /*log*/) { base = static_cast<std::byte*>(records); }
  // Always inlined: in large sources, calls would cost 1 % of all instructions.
  [[gnu::always_inline]] R<float> load(std::uint32_t index) const { return load_record<R>(base, index); }
  [[gnu::always_inline]] void store(std::uint32_t index, const R<float>& record) const {
    std::memcpy(base + std::size_t{index} * sizeof(record), &record, sizeof(record));
  }
};

template <template <class> class R>
struct Table<float, R> {
  using Record = R<float>;
  const std::byte* base = nullptr;
  template <class T>
  void bind(const T* records) {
    static_assert(sizeof(T) == sizeof(R<float>) && std::is_trivially_copyable_v<T>);
    base = reinterpret_cast<const std::byte*>(records);
  }
  bool is_bound() const { return base != nullptr; }
  void bind_raw(const void* records, std::vector<traces::Access>* /*log*/) {
    base = static_cast<const std::byte*>(records);
  }
  R<float> load(std::uint32_t index) const { return load_record<R>(base, index); }
};

/// A port that loads records through the data cache and appends its accesses to `log`, unless `log` is null. Ports of
/// kind kStored read an array of region kSamples; they are bound by bind_stored().
template <template <class> class R, traces::Access::Kind kKind>
struct Cached<float, R, kKind> {
  using Record = R<float>;
  const std::byte* base = nullptr;
  std::vector<traces::Access>* log = nullptr;
  bool is_bound() const { return base != nullptr; }
  void bind_raw(const void* records, std::vector<traces::Access>* accesses) {
    base = static_cast<const std::byte*>(records);
    log = accesses;
  }
  /// Binds the port to records of region kSamples that begin at 4-byte word `word`. `region` is the region's data.
  void bind_stored(const std::uint32_t* region, std::uint64_t word, std::vector<traces::Access>* accesses) {
    bind_raw(region + word, accesses);
    first_word = static_cast<std::uint32_t>(word);
  }
  R<float> load(std::uint32_t index) const {
    if (log) log->push_back(traces::Access::of_kind(kKind, element_of(index)));
    return load_record<R>(base, index);
  }

 private:
  std::uint32_t element_of(std::uint32_t index) const {
    if constexpr (kKind != traces::Access::Kind::kStored) return index;
    return first_word + index * static_cast<std::uint32_t>(sizeof(R<float>) / traces::kStoredWordBytes);
  }
  std::uint32_t first_word = 0;
};

template <>
struct Texels<float> {
  using Record = traces::Texture;
  const traces::Texture* textures = nullptr;
  std::vector<traces::Access>* log = nullptr;
  bool is_bound() const { return textures != nullptr; }
  void bind_raw(const void* all, std::vector<traces::Access>* accesses) {
    textures = static_cast<const traces::Texture*>(all);
    log = accesses;
  }
  /// Loads the four texels of a bilinear footprint. `corner0` and `corner1` are opposite corners, each as y << 16 | x.
  FootprintRecord<float> load(std::uint32_t texture, std::uint32_t corner0, std::uint32_t corner1) const {
    const std::uint32_t x0 = corner0 & 0xffffU, y0 = corner0 >> 16, x1 = corner1 & 0xffffU, y1 = corner1 >> 16;
    if (log) log->push_back(traces::Access::texels(texture, x0, y0, x1, y1));
    const traces::Texture& t = textures[texture];
    const std::uint32_t* upper = t.texels.data() + std::size_t{y0} * t.width;
    const std::uint32_t* lower = t.texels.data() + std::size_t{y1} * t.width;
    return {upper[x0], upper[x1], lower[x0], lower[x1]};
  }
};

template <>
struct Counter<float> {
  std::uint32_t value = 0;
  std::uint32_t next_index(bool keep) {
    const std::uint32_t at = value;
    value += keep ? 1U : 0U;
    return at;
  }
};

template <>
struct LoopCarried<float> {
  float value = 0;
  float get() const { return value; }
  void set(float x) { value = x; }
};

/// True if kernels with these ports access memory through the data cache.
template <class Ports>
inline constexpr bool kListsAccesses = requires(Ports& p) {
  p.materials;
}
|| requires(Ports& p) { p.objects; }
|| requires(Ports& p) { p.texels; }
|| requires(Ports& p) { p.vertices; }
|| requires(Ports& p) { p.details; }
|| requires(Ports& p) { p.stored; };

template <class V>
using Attributes = Cached<V, AttributeFields, traces::Access::Kind::kAttributes>;
template <class V>
using Triangles = Cached<V, TriangleFields, traces::Access::Kind::kTriangle>;
template <class V>
using Instances = Cached<V, InstanceFields, traces::Access::Kind::kInstance>;
template <class V>
using Materials = Cached<V, MaterialFields, traces::Access::Kind::kMaterial>;
template <class V>
using Vertices = Cached<V, VertexFields, traces::Access::Kind::kVertices>;
template <class V>
using Details = Cached<V, DetailFields, traces::Access::Kind::kDetail>;
template <class V, template <class> class R>
using Stored = Cached<V, R, traces::Access::Kind::kStored>;

}  // namespace kernels
