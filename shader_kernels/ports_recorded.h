#pragma once
#include <array>
#include <string>
#include <string_view>
#include <utility>

#include "shader_kernels/fusion.h"
#include "shader_kernels/ports.h"
#include "shader_kernels/recorder.h"

namespace kernels {

/// Records the load of a record. Its fields become kInput nodes with their byte offsets.
template <template <class> class R>
R<Recorded> record_load(Recorder& recorder, Op op, const std::string& memory, std::array<IntNode, 3> address,
                        std::uint32_t address_words) {
  GraphNode load{.op = op, .label = memory};
  for (std::uint32_t i = 0; i < address_words; ++i) load.inputs[i] = address[i].node_in(recorder);
  const std::uint32_t id = recorder.add(std::move(load));
  std::uint32_t offset = 0;
  const auto input = [&](const std::string& name) {
    GraphNode field{.op = Op::kInput, .value = offset, .label = memory + '.' + name};
    field.inputs[0] = id;
    offset += 4;
    return recorder.add(std::move(field));
  };
  R<Recorded> record;
  const auto read = [&]<class T>(T& field, const std::string& name) {
    if constexpr (std::is_same_v<T, Vec3<Recorded>>) {
      field.x = {recorder, input(name + ".x")};
      field.y = {recorder, input(name + ".y")};
      field.z = {recorder, input(name + ".z")};
    } else {
      field = {recorder, input(name)};
    }
  };
  R<Recorded>::fields(record, read);
  recorder.set_bytes(id, offset);
  return record;
}

/// A port of the recording reading: its recorder and name.
struct RecordedPort {
  Recorder* recorder = nullptr;
  std::string name;
};

template <template <class> class R>
struct Local<Recorded, R> : RecordedPort {
  R<Recorded> load(const IntNode& index) const { return record_load<R>(*recorder, Op::kLoadLocal, name, {index}, 1); }
  void store(const IntNode& index, const R<Recorded>& record) const {
    GraphNode store{.op = Op::kStoreLocal, .label = name};
    store.inputs[0] = index.node_in(*recorder);
    const auto write = [&]<class T>(const T& field, std::string_view) {
      if constexpr (std::is_same_v<T, Vec3<Recorded>>) {
        for (const FloatNode& part : {field.x, field.y, field.z}) store.stored.push_back(part.node_in(*recorder));
      } else {
        store.stored.push_back(field.node_in(*recorder));
      }
    };
    R<Recorded>::fields(record, write);
    store.bytes = static_cast<std::uint32_t>(4 * store.stored.size());
    recorder->add(std::move(store));
  }
};

template <template <class> class R>
struct Table<Recorded, R> : RecordedPort {
  R<Recorded> load(const IntNode& index) const { return record_load<R>(*recorder, Op::kLoadLocal, name, {index}, 1); }
};

template <template <class> class R, traces::Access::Kind kKind>
struct Cached<Recorded, R, kKind> : RecordedPort {
  R<Recorded> load(const IntNode& index) const { return record_load<R>(*recorder, Op::kLoadCached, name, {index}, 1); }
};

template <>
struct Texels<Recorded> : RecordedPort {
  FootprintRecord<Recorded> load(const IntNode& texture, const IntNode& corner0, const IntNode& corner1) const {
    return record_load<FootprintRecord>(*recorder, Op::kLoadCached, name, {texture, corner0, corner1}, 3);
  }
};

template <>
struct Counter<Recorded> : RecordedPort {
  IntNode next(const MaskNode& keep) {
    const IntNode at{*recorder, recorder->carried(name)};
    recorder->close(at.node_or_bits, (at + select(keep, 1U, 0U)).node_or_bits);
    return at;
  }
};

template <>
struct Carried<Recorded> : RecordedPort {
  std::uint32_t node = GraphNode::kNone;
  FloatNode get() {
    node = recorder->carried(name);
    return {*recorder, node};
  }
  void set(const FloatNode& x) const { recorder->close(node, x.node_in(*recorder)); }
};

/// Binds a kernel's ports and uniforms to the recorder by name; for describe().
class PortBinder {
 public:
  explicit PortBinder(Recorder& recorder) : recorder_(recorder) {}
  void operator()(RecordedPort& port, std::string_view name) const {
    port.recorder = &recorder_;
    port.name = name;
  }
  void operator()(FloatNode& uniform, std::string_view name) const {
    uniform = {recorder_, recorder_.uniform(std::string(name))};
  }
  void operator()(IntNode& uniform, std::string_view name) const {
    uniform = {recorder_, recorder_.uniform(std::string(name))};
  }
  void operator()(Vec3<Recorded>& uniform, const std::string& name) const {
    (*this)(uniform.x, name + ".x");
    (*this)(uniform.y, name + ".y");
    (*this)(uniform.z, name + ".z");
  }

 private:
  Recorder& recorder_;
};

/// Returns the dataflow graph of kernel K.
template <class K>
Graph record_graph() {
  Graph graph{.kernel = std::string(K::kName), .nodes = {}};
  Recorder recorder(graph);
  typename K::template Ports<Recorded> ports;
  K::template Ports<Recorded>::describe(ports, PortBinder(recorder));
  K::template body<Recorded>(IntNode{recorder, recorder.add({.op = Op::kInput, .label = "item"})}, ports);
  if constexpr (requires { K::kRegisters; }) keep_in_registers(graph, K::kRegisters);
  sort_canonically(graph);
  return graph;
}

}  // namespace kernels
