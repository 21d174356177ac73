#include "tests/shader_kernels/interpret.h"

#include <array>
#include <bit>
#include <cstring>
#include <stdexcept>
#include <utility>
#include <vector>

#include "shader_kernels/value.h"

namespace kernels {
namespace {

using Word = std::uint32_t;

float as_float(Word bits) { return std::bit_cast<float>(bits); }
Word as_word(float x) { return std::bit_cast<Word>(x); }
Word as_word(bool mask) { return mask ? 1U : 0U; }

float compute_float(Op op, float a, float b) {
  switch (op) {
    case Op::kAdd:
      return a + b;
    case Op::kSub:
      return a - b;
    case Op::kMul:
      return a * b;
    case Op::kDiv:
      return a / b;
    case Op::kSqrt:
      return sqrt(a);
    case Op::kMin:
      return min(a, b);
    case Op::kMax:
      return max(a, b);
    case Op::kAbs:
      return abs(a);
    case Op::kNeg:
      return -a;
    case Op::kFloor:
      return floor(a);
    default:
      throw std::logic_error("not an arithmetic operation");
  }
}

Word compute_word(Op op, Word a, Word b, Word c) {
  switch (op) {
    case Op::kIntAdd:
      return a + b;
    case Op::kIntSub:
      return a - b;
    case Op::kIntMul:
      return a * b;
    case Op::kAnd:
      return a & b;
    case Op::kOr:
      return a | b;
    case Op::kXor:
      return a ^ b;
    case Op::kShiftLeft:
      return a << b;
    case Op::kShiftRight:
      return a >> b;
    case Op::kLess:
      return as_word(as_float(a) < as_float(b));
    case Op::kLessEqual:
      return as_word(as_float(a) <= as_float(b));
    case Op::kEqual:
      return as_word(as_float(a) == as_float(b));
    case Op::kIntLess:
      return as_word(a < b);
    case Op::kIntEqual:
      return as_word(a == b);
    case Op::kSelect:
      return a != 0 ? b : c;
    case Op::kToFloat:
      return as_word(to_float(a));
    case Op::kToInt:
      return to_int(as_float(a));
    case Op::kBits:
      return a;
    default:
      return as_word(compute_float(op, as_float(a), as_float(b)));
  }
}

template <class T>
T& find_bound(std::map<std::string, T, std::less<>>& all, const std::string& name) {
  const auto at = all.find(name);
  if (at == all.end()) throw std::invalid_argument("nothing is bound to '" + name + "'");
  return at->second;
}

/// Interpreter that executes a kernel's graph item by item. It stores the values of the current and the previous item.
class Interpreter {
 public:
  Interpreter(const Graph& graph, Environment& environment)
      : graph_(graph), environment_(environment), values_(graph.nodes.size()), records_(graph.nodes.size()) {}

  void run_items(Word items) {
    for (Word item = 0; item < items; ++item) {
      for (std::size_t i = 0; i < values_.size(); ++i) run_operation(i, item);
      for (const GraphNode& node : graph_.nodes) {
        if (node.distance != 0) find_bound(environment_.carried, node.label) = values_[node.inputs[0]];
      }
    }
  }

 private:
  Word operand_value(const GraphNode& node, int i) const {
    return node.inputs[i] == GraphNode::kNone ? 0 : values_[node.inputs[i]];
  }

  void run_operation(std::size_t i, Word item) {
    const GraphNode& node = graph_.nodes[i];
    switch (node.op) {
      case Op::kInput:
        values_[i] = read_input(node, item);
        break;
      case Op::kConstant:
        values_[i] = node.label.empty() ? node.value : find_bound(environment_.uniforms, node.label);
        break;
      case Op::kLoadLocal:
      case Op::kLoadCached:
        run_load(i);
        break;
      case Op::kStoreLocal:
        run_store(node);
        break;
      default:
        values_[i] = compute_word(node.op, operand_value(node, 0), operand_value(node, 1), operand_value(node, 2));
    }
  }

  Word read_input(const GraphNode& node, Word item) {
    if (node.distance != 0) return find_bound(environment_.carried, node.label);
    if (node.inputs[0] == GraphNode::kNone) return item;
    return records_[node.inputs[0]][node.value / 4];
  }

  void run_load(std::size_t i) {
    const GraphNode& node = graph_.nodes[i];
    if (node.inputs[1] != GraphNode::kNone) {
      const FootprintRecord<float> texels = Texels<float>{environment_.textures}.load(
          operand_value(node, 0), operand_value(node, 1), operand_value(node, 2));
      records_[i] = {texels.at00, texels.at10, texels.at01, texels.at11};
    } else {
      const std::byte* memory = find_bound(environment_.memories, node.label);
      std::memcpy(records_[i].data(), memory + std::size_t{operand_value(node, 0)} * node.bytes, node.bytes);
    }
  }

  void run_store(const GraphNode& node) {
    std::byte* to = find_bound(environment_.memories, node.label) + std::size_t{operand_value(node, 0)} * node.bytes;
    for (const std::uint32_t id : node.stored) {
      std::memcpy(to, &values_[id], sizeof(Word));
      to += sizeof(Word);
    }
  }

  const Graph& graph_;
  Environment& environment_;
  std::vector<Word> values_;
  std::vector<std::array<Word, 17>> records_;  ///< for each load, the record that it read
};

}  // namespace

void interpret_graph(const Graph& graph, std::uint32_t items, Environment& environment) {
  Interpreter(graph, environment).run_items(items);
}

}  // namespace kernels
