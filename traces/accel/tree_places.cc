#include "traces/accel/tree_places.h"

#include <utility>

namespace traces {
namespace {

constexpr std::uint32_t kUnit = Layout::kPlaceBytes;

/// Places the records of a q8 tree: after a node's inner children follow its leaves, then the blocks of its children's
/// children, depth first.
class JoinedPlaces {
 public:
  JoinedPlaces(const ImageCounts& counts, const MemoryImage& image, std::uint32_t record_bytes)
      : image_(image), record_units_(record_bytes / kUnit) {
    out_.one_array = true;
    out_.nodes.assign(image.wide_nodes.size(), kNone);
    out_.triangles.assign(counts.triangles, 0);
    out_.instances.assign(counts.instances, kNone);
  }

  TreePlaces run() {
    for (std::uint32_t i = 0; i < image_.wide_nodes.size(); ++i) {
      if (out_.nodes[i] == kNone) place_root(i);
    }
    for (std::uint32_t& place : out_.instances) {  // instances without triangles are in no leaf
      if (place == kNone) place = std::exchange(next_, next_ + kLineUnits);
    }
    out_.node_bytes = std::uint64_t{next_} * kUnit;
    return std::move(out_);
  }

 private:
  static constexpr std::uint32_t kLineUnits = 64 / kUnit;

  void place_root(std::uint32_t root) {
    out_.nodes[root] = std::exchange(next_, next_ + kLineUnits);
    std::vector<std::uint32_t> open{root};
    while (!open.empty()) {
      const std::uint32_t index = open.back();
      open.pop_back();
      place_children(index);
      const auto& links = image_.wide_nodes[index].child;
      for (std::size_t i = kMaxWidth; i-- > 0;) {
        if (!is_leaf(links[i]) && links[i] != kNoChild) open.push_back(links[i]);
      }
    }
  }

  void place_children(std::uint32_t index) {
    const auto& links = image_.wide_nodes[index].child;
    for (const std::uint32_t link : links) {
      if (!is_leaf(link) && link != kNoChild) out_.nodes[link] = std::exchange(next_, next_ + kLineUnits);
    }
    for (const std::uint32_t link : links) {
      if (is_instance(link)) {
        out_.instances[link_instance(link)] = std::exchange(next_, next_ + kLineUnits);
      } else if (is_leaf(link)) {
        place_leaf(leaf_first(link), leaf_count(link));
      }
    }
    next_ = (next_ + kLineUnits - 1) / kLineUnits * kLineUnits;
  }

  void place_leaf(std::uint32_t first, std::uint32_t count) {
    std::uint32_t record = next_;
    for (std::uint32_t i = first; i < first + count; ++i) {
      if (i == first || image_.begins_record.empty() || image_.begins_record[i]) {
        record = std::exchange(next_, next_ + record_units_);
        out_.leaf_bytes += std::uint64_t{record_units_} * kUnit;
      }
      out_.triangles[i] = record;
    }
  }

  const MemoryImage& image_;
  const std::uint32_t record_units_;
  std::uint32_t next_ = 0;  ///< first free place, in units
  TreePlaces out_;
};

}  // namespace

TreePlaces place_tree(const ImageCounts& counts, const MemoryImage& image, const BvhConfig& config) {
  const std::uint32_t record_bytes = leaf_record_bytes(config);
  if (config.node_format() == NodeFormat::kQ8) return JoinedPlaces(counts, image, record_bytes).run();
  TreePlaces out;
  out.node_bytes = config.is_wide()
                       ? std::uint64_t{wide_node_bytes(config.node_format(), config.width)} * image.wide_nodes.size()
                       : node_bytes(config.box_numbers(), config.boxes) *
                             node_records(image.nodes.size(), config.boxes, 1 + counts.trees);
  out.leaf_bytes = counts.triangles * record_bytes;
  if (!image.begins_record.empty()) {
    std::uint32_t records = 0;
    for (const bool begins : image.begins_record) {
      records += begins ? 1 : 0;
      out.triangles.push_back((records - 1) * (record_bytes / kUnit));
    }
    out.leaf_bytes = std::uint64_t{records} * record_bytes;
  }
  if (is_quantised(config.format) && counts.instances != 0) {
    std::uint32_t next = 0;
    out.instances.assign(counts.instances, kNone);
    const auto place = [&](std::uint32_t& at) {
      at = next;
      next += static_cast<std::uint32_t>(sizeof(InstanceRecord)) / kUnit;
    };
    for (const WideNode& node : image.wide_nodes) {
      for (const std::uint32_t link : node.child) {
        if (is_instance(link)) place(out.instances[link_instance(link)]);
      }
    }
    for (std::uint32_t& at : out.instances) {
      if (at == kNone) place(at);
    }
  }
  return out;
}

}  // namespace traces
