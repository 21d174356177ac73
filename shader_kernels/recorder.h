#pragma once
#include <bit>
#include <concepts>
#include <cstdint>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>

#include "shader_kernels/graph.h"
#include "shader_kernels/value.h"

namespace kernels {

/// The value type of the recording reading (value.h).
struct Recorded;

/// Records a kernel's operations into a graph while the kernel's source runs.
class Recorder {
 public:
  explicit Recorder(Graph& graph) : graph_(graph) {}

  std::uint32_t add(GraphNode node);
  /// Returns the node of a literal; equal bits share one node.
  std::uint32_t literal(std::uint32_t bits);
  /// Returns the node of a named value that is constant over the loop.
  std::uint32_t uniform(std::string label);
  /// Returns a node for the previous item's value of the producer given to `close(id, producer)`.
  std::uint32_t carried(std::string label);
  void set_bytes(std::uint32_t load, std::uint32_t bytes) { graph_.nodes[load].bytes = bytes; }
  void close(std::uint32_t carried, std::uint32_t producer) { graph_.nodes[carried].inputs[0] = producer; }

 private:
  Graph& graph_;
  std::map<std::uint32_t, std::uint32_t> literals_;
};

/// Renumbers the nodes by their dependences and drops unused fields and uniforms. Loads, stores and carried values keep
/// their order, each after its inputs, operands from left to right. The graph is then independent of the order in which
/// a compiler evaluates a + b.
void sort_canonically(Graph& graph);

/// A value of the recording reading: a node, or a literal that becomes a node when it is combined with one.
struct Value {
  Recorder* recorder = nullptr;
  std::uint32_t node_or_bits = 0;
  std::uint32_t node_in(Recorder& r) const { return recorder ? node_or_bits : r.literal(node_or_bits); }
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

/// Records `op`. At least one input must be a node; the compiler should compute operations on literals alone.
template <class Result>
Result record(Op op, const std::derived_from<Value> auto&... in) {
  Recorder* r = nullptr;
  ((r = r ? r : in.recorder), ...);
  if (!r) throw std::logic_error("a kernel's operation on literals alone");
  GraphNode node{.op = op};
  std::uint32_t n = 0;
  ((node.inputs[n++] = in.node_in(*r)), ...);
  return {*r, r->add(std::move(node))};
}

inline FloatNode operator+(const FloatNode& a, const FloatNode& b) { return record<FloatNode>(Op::kAdd, a, b); }
inline FloatNode operator-(const FloatNode& a, const FloatNode& b) { return record<FloatNode>(Op::kSub, a, b); }
inline FloatNode operator*(const FloatNode& a, const FloatNode& b) { return record<FloatNode>(Op::kMul, a, b); }
inline FloatNode operator/(const FloatNode& a, const FloatNode& b) { return record<FloatNode>(Op::kDiv, a, b); }
inline FloatNode operator-(const FloatNode& a) { return record<FloatNode>(Op::kNeg, a); }
inline FloatNode sqrt(const FloatNode& a) { return record<FloatNode>(Op::kSqrt, a); }
inline FloatNode floor(const FloatNode& a) { return record<FloatNode>(Op::kFloor, a); }
inline FloatNode abs(const FloatNode& a) { return record<FloatNode>(Op::kAbs, a); }
inline FloatNode min(const FloatNode& a, const FloatNode& b) { return record<FloatNode>(Op::kMin, a, b); }
inline FloatNode max(const FloatNode& a, const FloatNode& b) { return record<FloatNode>(Op::kMax, a, b); }
inline MaskNode operator<(const FloatNode& a, const FloatNode& b) { return record<MaskNode>(Op::kLess, a, b); }
inline MaskNode operator<=(const FloatNode& a, const FloatNode& b) { return record<MaskNode>(Op::kLessEqual, a, b); }
inline MaskNode operator==(const FloatNode& a, const FloatNode& b) { return record<MaskNode>(Op::kEqual, a, b); }

inline IntNode operator+(const IntNode& a, const IntNode& b) { return record<IntNode>(Op::kIntAdd, a, b); }
inline IntNode operator-(const IntNode& a, const IntNode& b) { return record<IntNode>(Op::kIntSub, a, b); }
inline IntNode operator*(const IntNode& a, const IntNode& b) { return record<IntNode>(Op::kIntMul, a, b); }
inline IntNode operator&(const IntNode& a, const IntNode& b) { return record<IntNode>(Op::kAnd, a, b); }
inline IntNode operator|(const IntNode& a, const IntNode& b) { return record<IntNode>(Op::kOr, a, b); }
inline IntNode operator^(const IntNode& a, const IntNode& b) { return record<IntNode>(Op::kXor, a, b); }
inline IntNode operator<<(const IntNode& a, const IntNode& b) { return record<IntNode>(Op::kShiftLeft, a, b); }
inline IntNode operator>>(const IntNode& a, const IntNode& b) { return record<IntNode>(Op::kShiftRight, a, b); }
inline MaskNode operator<(const IntNode& a, const IntNode& b) { return record<MaskNode>(Op::kIntLess, a, b); }
inline MaskNode operator==(const IntNode& a, const IntNode& b) { return record<MaskNode>(Op::kIntEqual, a, b); }

inline FloatNode to_float(const IntNode& a) { return record<FloatNode>(Op::kToFloat, a); }
inline IntNode to_int(const FloatNode& a) { return record<IntNode>(Op::kToInt, a); }
inline IntNode bits_of(const FloatNode& a) { return record<IntNode>(Op::kBits, a); }
inline FloatNode from_bits(const IntNode& a) { return record<FloatNode>(Op::kBits, a); }

inline MaskNode both(const MaskNode& a, const MaskNode& b) { return record<MaskNode>(Op::kAnd, a, b); }
inline MaskNode logical_or(const MaskNode& a, const MaskNode& b) { return record<MaskNode>(Op::kOr, a, b); }
inline FloatNode select(const MaskNode& mask, const FloatNode& yes, const FloatNode& no) {
  return record<FloatNode>(Op::kSelect, mask, yes, no);
}
inline IntNode select(const MaskNode& mask, const IntNode& yes, const IntNode& no) {
  return record<IntNode>(Op::kSelect, mask, yes, no);
}

}  // namespace kernels
