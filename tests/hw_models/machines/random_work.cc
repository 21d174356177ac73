#include "tests/hw_models/machines/random_work.h"

#include <utility>

#include "sim/hash.h"

namespace hw::test {

namespace {

using traces::Edge;
using traces::WorkNode;

class Additions {
 public:
  Additions(std::uint64_t seed, traces::TileWork& work) : seed_(seed), work_(work) {}

  void add() {
    for (std::uint32_t tile = 0; tile < work_.tile; ++tile) {
      if (below(3) == 0) work_.imports.push_back({tile, below(kBorders + 1)});  // no tile writes the last border
    }
    work_.after_all = below(5) == 0;
    const std::vector<WorkNode> nodes = std::exchange(work_.nodes, {});
    for (const WorkNode& node : nodes) {
      if (below(4) == 0) transfer();
      if (below(2) == 0) import_next();
      if (below(8) == 0) export_next();
      for (Edge& edge : work_.nodes.emplace_back(node).inputs) edge.node = new_indices_[edge.node];
      new_indices_.push_back(static_cast<std::uint32_t>(work_.nodes.size() - 1));
      if (node.kind == WorkNode::Kind::kLaunch) change(work_.nodes.back());
    }
    for (std::uint64_t more = below(3); more > 0; --more) transfer();
    while (imported_ < work_.imports.size()) import_next();
    while (exported_ < kBorders && below(2) == 0) export_next();
  }

 private:
  static constexpr std::uint32_t kBorders = 3;

  std::uint32_t below(std::uint64_t n) {
    return static_cast<std::uint32_t>(sim::hash(seed_, work_.tile, draws_++) % n);
  }

  void import_next() {
    if (imported_ == work_.imports.size()) return;
    transfer();
    work_.nodes.back().to_memory = false;
    work_.nodes.back().border = imported_++;
  }
  void export_next() {
    if (exported_ == kBorders) return;
    transfer();
    work_.nodes.back().to_memory = true;
    work_.nodes.back().border = exported_++;
  }

  void transfer() {
    std::vector<Edge> inputs;
    for (std::uint32_t i = work_.nodes.empty() ? 0 : below(3); i > 0; --i) {
      inputs.push_back({below(work_.nodes.size()), Edge::Kind::kAll});
    }
    transfers_.push_back(static_cast<std::uint32_t>(work_.nodes.size()));
    WorkNode& node = work_.nodes.emplace_back();
    node.kind = WorkNode::Kind::kTransfer;
    node.region = static_cast<traces::Region>(below(kTileRegions));
    node.to_memory = below(2) == 0;
    node.offset = below(1 << 14);
    node.items = 1 + below(500);
    node.inputs = std::move(inputs);
  }

  void change(WorkNode& launch) {
    if (below(3) == 0) launch.idle = 1 + below(300);
    if (!transfers_.empty() && below(3) == 0) {
      launch.inputs.push_back({transfers_[below(transfers_.size())], Edge::Kind::kAll});
    }
  }

  const std::uint64_t seed_;
  traces::TileWork& work_;
  std::uint64_t draws_ = 0;
  std::uint32_t imported_ = 0, exported_ = 0;  ///< number of borders added so far
  std::vector<std::uint32_t> new_indices_;     ///< new index of each node that the tile had before
  std::vector<std::uint32_t> transfers_;       ///< indices of added transfers
};

}  // namespace

std::vector<traces::TileWork> random_work(const Frame& frame, std::uint64_t seed) {
  std::vector<traces::TileWork> works = frame.record();
  for (traces::TileWork& work : works) Additions(seed, work).add();
  return works;
}

}  // namespace hw::test
