#pragma once
#include <array>
#include <bit>
#include <concepts>
#include <cstdint>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "shader_kernels/graph.h"
#include "shader_kernels/ports.h"
#include "shader_kernels/value.h"

namespace kernels {

/// The value type with which a kernel records its graph instead of computing (value.h).
struct Recorded;

/// Records the operations of a kernel as a graph while the kernel's source runs.
class Recorder {
 public:
  explicit Recorder(Graph& graph) : graph_(graph) {}

  std::uint32_t add_node(GraphNode node) {
    graph_.nodes.push_back(std::move(node));
    return static_cast<std::uint32_t>(graph_.nodes.size() - 1);
  }
  /// Returns the graph node of a literal. Equal literals share one node.
  std::uint32_t add_literal(std::uint32_t bits) {
    const auto [at, is_new] = literals_.try_emplace(bits, 0);
    if (is_new) at->second = add_node({.op = Op::kConstant, .value = bits});
    return at->second;
  }
  /// Returns a new graph node for a uniform: a named value that is constant during the loop.
  std::uint32_t add_uniform(std::string label) { return add_node({.op = Op::kConstant, .label = std::move(label)}); }
  /// Returns a new graph node for a loop-carried value. close_loop(id, producer) later sets the node that produces it.
  std::uint32_t add_carried(std::string label) {
    return add_node({.op = Op::kInput, .distance = 1, .label = std::move(label)});
  }
  void set_bytes(std::uint32_t load, std::uint32_t bytes) { graph_.nodes[load].bytes = bytes; }
  void close_loop(std::uint32_t carried, std::uint32_t producer) { graph_.nodes[carried].inputs[0] = producer; }

 private:
  Graph& graph_;
  std::map<std::uint32_t, std::uint32_t> literals_;
};

/// A value while a graph is recorded: a node or a literal. A literal becomes a node when it is combined with a node.
struct Value {
  Recorder* recorder = nullptr;
  std::uint32_t node_or_bits = 0;
  std::uint32_t node_in(Recorder& r) const { return recorder ? node_or_bits : r.add_literal(node_or_bits); }
};

struct FloatNode : Value {
  FloatNode() = default;
  FloatNode(std::same_as<float> auto x) : Value{nullptr, std::bit_cast<std::uint32_t>(x)} {}
  FloatNode(Recorder& r, std::uint32_t node) : Value{&r, node} {}
};
struct IntNode : Value {
  IntNode() = default;
  IntNode(std::same_as<std::uint32_t> auto x) : Value{nullptr, x} {}
  IntNode(Recorder& r, std::uint32_t node) : Value{&r, node} {}
};
struct MaskNode : Value {
  MaskNode(Recorder& r, std::uint32_t node) : Value{&r, node} {}
};

template <>
struct Reading<Recorded> {
  using Float = FloatNode;
  using Int = IntNode;
  using Mask = MaskNode;
};

/// Records operation `op` and returns its result. At least one input is a node, because the compiler evaluates
/// operations on literals.
template <class Result>
Result record_op(Op op, const std::derived_from<Value> auto&... in) {
  Recorder* r = nullptr;
  ((r = r ? r : in.recorder), ...);
  if (!r) throw std::logic_error("a kernel's operation on literals alone");
  GraphNode node{.op = op};
  std::uint32_t n = 0;
  ((node.inputs[n++] = in.node_in(*r)), ...);
  return {*r, r->add_node(std::move(node))};
}

inline FloatNode operator+(const FloatNode& a, const FloatNode& b) { return record_op<FloatNode>(Op::kAdd, a, b); }
inline FloatNode operator-(const FloatNode& a, const FloatNode& b) { return record_op<FloatNode>(Op::kSub, a, b); }
inline FloatNode operator*(const FloatNode& a, const FloatNode& b) { return record_op<FloatNode>(Op::kMul, a, b); }
inline FloatNode operator/(const FloatNode& a, const FloatNode& b) { return record_op<FloatNode>(Op::kDiv, a, b); }
inline FloatNode operator-(const FloatNode& a) { return record_op<FloatNode>(Op::kNeg, a); }
inline FloatNode sqrt(const FloatNode& a) { return record_op<FloatNode>(Op::kSqrt, a); }
inline FloatNode floor(const FloatNode& a) { return record_op<FloatNode>(Op::kFloor, a); }
inline FloatNode abs(const FloatNode& a) { return record_op<FloatNode>(Op::kAbs, a); }
inline FloatNode min(const FloatNode& a, const FloatNode& b) { return record_op<FloatNode>(Op::kMin, a, b); }
inline FloatNode max(const FloatNode& a, const FloatNode& b) { return record_op<FloatNode>(Op::kMax, a, b); }
inline MaskNode operator<(const FloatNode& a, const FloatNode& b) { return record_op<MaskNode>(Op::kLess, a, b); }
inline MaskNode operator<=(const FloatNode& a, const FloatNode& b) { return record_op<MaskNode>(Op::kLessEqual, a, b); }
inline MaskNode operator==(const FloatNode& a, const FloatNode& b) { return record_op<MaskNode>(Op::kEqual, a, b); }

inline IntNode operator+(const IntNode& a, const IntNode& b) { return record_op<IntNode>(Op::kIntAdd, a, b); }
inline IntNode operator-(const IntNode& a, const IntNode& b) { return record_op<IntNode>(Op::kIntSub, a, b); }
inline IntNode operator*(const IntNode& a, const IntNode& b) { return record_op<IntNode>(Op::kIntMul, a, b); }
inline IntNode operator&(const IntNode& a, const IntNode& b) { return record_op<IntNode>(Op::kAnd, a, b); }
inline IntNode operator|(const IntNode& a, const IntNode& b) { return record_op<IntNode>(Op::kOr, a, b); }
inline IntNode operator^(const IntNode& a, const IntNode& b) { return record_op<IntNode>(Op::kXor, a, b); }
inline IntNode operator<<(const IntNode& a, const IntNode& b) { return record_op<IntNode>(Op::kShiftLeft, a, b); }
inline IntNode operator>>(const IntNode& a, const IntNode& b) { return record_op<IntNode>(Op::kShiftRight, a, b); }
inline MaskNode operator<(const IntNode& a, const IntNode& b) { return record_op<MaskNode>(Op::kIntLess, a, b); }
inline MaskNode operator==(const IntNode& a, const IntNode& b) { return record_op<MaskNode>(Op::kIntEqual, a, b); }

inline FloatNode to_float(const IntNode& a) { return record_op<FloatNode>(Op::kToFloat, a); }
inline IntNode to_int(const FloatNode& a) { return record_op<IntNode>(Op::kToInt, a); }
inline IntNode bits_of(const FloatNode& a) { return record_op<IntNode>(Op::kBits, a); }
inline FloatNode from_bits(const IntNode& a) { return record_op<FloatNode>(Op::kBits, a); }

inline MaskNode logical_and(const MaskNode& a, const MaskNode& b) { return record_op<MaskNode>(Op::kAnd, a, b); }
inline MaskNode logical_or(const MaskNode& a, const MaskNode& b) { return record_op<MaskNode>(Op::kOr, a, b); }
inline FloatNode select(const MaskNode& mask, const FloatNode& yes, const FloatNode& no) {
  return record_op<FloatNode>(Op::kSelect, mask, yes, no);
}
inline IntNode select(const MaskNode& mask, const IntNode& yes, const IntNode& no) {
  return record_op<IntNode>(Op::kSelect, mask, yes, no);
}

/// Records a load of a whole record. Each field of the record becomes a kInput node with the field's byte offset.
template <template <class> class R>
R<Recorded> record_load(Recorder& recorder, Op op, const std::string& memory, std::array<IntNode, 3> address,
                        std::uint32_t address_words) {
  GraphNode load{.op = op, .label = memory};
  for (std::uint32_t i = 0; i < address_words; ++i) load.inputs[i] = address[i].node_in(recorder);
  const std::uint32_t id = recorder.add_node(std::move(load));
  std::uint32_t offset = 0;
  const auto input = [&](const std::string& name) {
    GraphNode field{.op = Op::kInput, .value = offset, .label = memory + '.' + name};
    field.inputs[0] = id;
    offset += 4;
    return recorder.add_node(std::move(field));
  };
  R<Recorded> record;
  const auto read = [&]<class T>(T& field, std::string_view member) {
    const std::string name(member);
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

/// A port of a kernel whose graph is being recorded: the recorder, and the port's name.
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
    recorder->add_node(std::move(store));
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
  IntNode next_index(const MaskNode& keep) {
    const IntNode at{*recorder, recorder->add_carried(name)};
    recorder->close_loop(at.node_or_bits, (at + select(keep, 1U, 0U)).node_or_bits);
    return at;
  }
};

template <>
struct LoopCarried<Recorded> : RecordedPort {
  std::uint32_t node = GraphNode::kNone;
  FloatNode get() {
    node = recorder->add_carried(name);
    return {*recorder, node};
  }
  void set(const FloatNode& x) const { recorder->close_loop(node, x.node_in(*recorder)); }
};

/// Connects the ports and uniforms of a kernel to a recorder by name; passed to describe() as its visitor.
class PortBinder {
 public:
  explicit PortBinder(Recorder& recorder) : recorder_(recorder) {}
  void operator()(RecordedPort& port, std::string_view name) const {
    port.recorder = &recorder_;
    port.name = name;
  }
  void operator()(FloatNode& uniform, std::string_view name) const {
    uniform = {recorder_, recorder_.add_uniform(std::string(name))};
  }
  void operator()(IntNode& uniform, std::string_view name) const {
    uniform = {recorder_, recorder_.add_uniform(std::string(name))};
  }
  void operator()(Vec3<Recorded>& uniform, std::string_view name) const {
    const std::string prefix(name);
    (*this)(uniform.x, prefix + ".x");
    (*this)(uniform.y, prefix + ".y");
    (*this)(uniform.z, prefix + ".z");
  }

 private:
  Recorder& recorder_;
};

/// Runs kernel K once and returns the dataflow graph that this records.
template <class K>
Graph record_graph() {
  Graph graph{.kernel = std::string(K::kName), .nodes = {}};
  Recorder recorder(graph);
  typename K::template Ports<Recorded> ports;
  K::template Ports<Recorded>::describe(ports, PortBinder(recorder));
  K::template body<Recorded>(IntNode{recorder, recorder.add_node({.op = Op::kInput, .label = "item"})}, ports);
  if constexpr (requires { K::kRegisters; }) remove_repeated_accesses(graph, K::kRegisters);
  sort_nodes_canonically(graph);
  return graph;
}

}  // namespace kernels
