#include "traces/trace_file/tile_code.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "sim/error.h"
#include "traces/trace_file/bytes.h"
#include "traces/trace_file/walk_code.h"
#include "traces/walk.h"

namespace traces {
namespace {

// Encoding of the data of rasteriser nodes.

// Limit on each count of a tile. It is far above real counts, and keeps sums within 32 bits.
constexpr std::uint64_t kMost = 1U << 26;
constexpr std::uint64_t kLeastBytes = 5;  ///< fewest bytes of an encoded triangle

std::int64_t signed_difference(std::uint32_t from, std::uint32_t to) { return std::int64_t{to} - std::int64_t{from}; }

void write_coverage(const RasterTriangle& t, ByteWriter& to) {
  to.write_number(t.blocks);
  if (t.blocks == 0) return;
  to.write_number(t.hidden_blocks);
  to.write_number(t.quads);
  if (t.quads == 0) return;
  for (const std::uint32_t count : {t.hidden_quads, t.samples, t.hidden_samples, t.passed}) to.write_number(count);
}

void read_coverage(ByteReader& from, RasterTriangle& t) {
  constexpr const char* kWhat = "coverage of a triangle";
  t.blocks = from.read_number32(kMost, kWhat);
  if (t.blocks == 0) return;
  t.hidden_blocks = from.read_number32(t.blocks, kWhat);
  t.quads = from.read_number32(kMost, kWhat);
  if (t.quads == 0) return;
  t.hidden_quads = from.read_number32(t.quads, kWhat);
  t.samples = from.read_number32(kMost, kWhat);
  t.hidden_samples = from.read_number32(t.samples, kWhat);
  t.passed = from.read_number32(t.samples - t.hidden_samples, kWhat);
}

/// Encodes the numbers of list runs and triangles of a rasteriser node. Decoding them adds an entry to
/// TileWork::raster.
void write_raster_counts(const TileWork& work, const WorkNode& node, ByteWriter& to) {
  const RasterWork& job = work.raster[node.raster];
  to.write_number(job.runs);
  if (node.kind == WorkNode::Kind::kBin) return;
  to.write_number(job.triangles);
  to.write_number(job.pixel_samples);
}

void read_raster_counts(ByteReader& from, WorkNode& node, TileWork& work) {
  const bool bins = node.kind == WorkNode::Kind::kBin;
  node.raster = static_cast<std::uint32_t>(work.raster.size());
  RasterWork job;
  job.runs = from.read_number32(kMost, "runs of lists");
  job.triangles = bins ? node.items : from.read_number32(kMost, "triangles of a node");
  if (!bins) job.pixel_samples = from.read_number32(kMost, "samples of a pixel");
  if (job.pixel_samples == 0) ByteReader::throw_out_of_range("samples of a pixel");
  work.raster.push_back(job);
}

/// Encodes the data of a rasteriser node of the work graph: list runs, then triangles.
void write_raster(const TileWork& work, const WorkNode& node, ByteWriter& to) {
  const RasterWork& job = work.raster[node.raster];
  std::uint32_t end = 0;
  for (std::uint32_t i = job.first_run; i < job.first_run + job.runs; ++i) {
    const ListRun& run = work.list_runs[i];
    to.write_difference(signed_difference(end, run.first));
    to.write_number(run.entries);
    end = run.first + run.entries;
  }
  RasterTriangle last;
  for (std::uint32_t i = job.first_triangle; i < job.first_triangle + job.triangles; ++i) {
    const RasterTriangle& t = work.raster_triangles[i];
    to.write_difference(signed_difference(last.number, t.number));
    to.write_difference(signed_difference(last.vertices[0], t.vertices[0]));
    to.write_difference(signed_difference(t.vertices[0], t.vertices[1]));
    to.write_difference(signed_difference(t.vertices[1], t.vertices[2]));
    if (node.kind == WorkNode::Kind::kBin) {
      to.write_number(t.lists);
    } else {
      write_coverage(t, to);
    }
    last = t;
  }
}

/// Decodes the data of a rasteriser node, whose counts are in TileWork::raster. Throws InputError, without a file name,
/// if the data exceed `demands`.
void read_raster(ByteReader& from, const RasterArraySizes& demands, const WorkNode& node, TileWork& work) {
  const RasterWork& job = work.raster[node.raster];
  const bool bins = node.kind == WorkNode::Kind::kBin;
  if (job.runs > from.bytes_left() / 2) ByteReader::throw_out_of_range("runs of lists");
  std::uint64_t entries = 0;
  std::uint32_t end = 0;
  for (std::uint32_t i = 0; i < job.runs; ++i) {
    ListRun run;
    run.first = from.read_difference_from(end, demands.entries, "a list of triangles");
    run.entries = from.read_number32(demands.entries - run.first, "a list of triangles");
    entries += run.entries;
    end = run.first + run.entries;
    work.list_runs.push_back(run);
  }
  if (job.triangles > from.bytes_left() / kLeastBytes) ByteReader::throw_out_of_range("triangles of a node");
  std::uint64_t listed = 0;
  RasterTriangle last;
  for (std::uint32_t i = 0; i < job.triangles; ++i) {
    RasterTriangle t;
    t.number = from.read_difference_from(last.number, demands.triangles, "number of a triangle");
    if (t.number == demands.triangles) ByteReader::throw_out_of_range("number of a triangle");
    std::uint32_t base = last.vertices[0];
    for (std::uint32_t& vertex : t.vertices) {
      vertex = base = from.read_difference_from(base, demands.vertices, "vertex of a triangle");
      if (vertex == demands.vertices) ByteReader::throw_out_of_range("vertex of a triangle");
    }
    if (bins) {
      t.lists = from.read_number32(demands.entries, "lists of a triangle");
    } else {
      read_coverage(from, t);
    }
    listed += bins ? t.lists : 1;
    work.raster_triangles.push_back(t);
    last = t;
  }
  if (listed != entries) throw sim::InputError("lists have not as many entries as triangles are in them");
}

// Encoding of the work of the tree builder.

void write_build_job(const BuildWork& job, ByteWriter& to) {
  to.write_byte(static_cast<std::uint32_t>(job.input));
  to.write_byte(job.refit ? 1 : 0);
  to.write_number(job.first_item);
  to.write_number(job.comparisons);
  for (const BuildWork::Range& range : job.output) {
    to.write_number(range.offset);
    to.write_number(range.bytes);
  }
}

/// Decodes the job of a kBuild node and adds it to TileWork::build. Throws InputError, without a file name, if the job
/// exceeds `sizes`.
void read_build_job(ByteReader& from, const BuildArraySizes& sizes, WorkNode& node, TileWork& work) {
  constexpr const char* kWhat = "the building of a tree";
  constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 40;
  BuildWork job;
  job.input = static_cast<BuildWork::Input>(from.read_byte());
  if (job.input > BuildWork::Input::kInstances) ByteReader::throw_out_of_range(kWhat);
  const std::uint32_t refit = from.read_byte();
  if (refit > 1) ByteReader::throw_out_of_range(kWhat);
  job.refit = refit != 0;
  const std::uint32_t most = job.input == BuildWork::Input::kTriangles ? sizes.triangles : sizes.instances;
  job.first_item = from.read_number32(most, kWhat);
  job.comparisons = from.read_number(kMostBytes, kWhat);
  if (node.items > most - job.first_item) ByteReader::throw_out_of_range(kWhat);
  for (BuildWork::Range& range : job.output) {
    range.offset = from.read_number(kMostBytes, kWhat);
    range.bytes = from.read_number(kMostBytes, kWhat);
  }
  node.first = static_cast<std::uint32_t>(work.build.size());
  work.build.push_back(job);
}

/// Encodes the triangles of a kBuild node: vertices in input order, then input numbers in leaf order.
void write_build_triangles(const TileWork& work, const WorkNode& node, ByteWriter& to) {
  const BuildWork& job = work.build[node.first];
  if (job.input != BuildWork::Input::kTriangles) return;
  std::uint32_t last = 0;
  for (std::uint32_t i = job.first; i < job.first + node.items; ++i) {
    for (const std::uint32_t vertex : work.build_triangles[i]) {
      to.write_difference(signed_difference(last, vertex));
      last = vertex;
    }
  }
  last = 0;
  for (std::uint32_t i = job.first; i < job.first + node.items; ++i) {
    to.write_difference(signed_difference(last, work.build_order[i]));
    last = work.build_order[i];
  }
}

void read_build_triangles(ByteReader& from, const BuildArraySizes& sizes, const WorkNode& node, TileWork& work) {
  BuildWork& job = work.build[node.first];
  if (job.input != BuildWork::Input::kTriangles) return;
  constexpr std::uint32_t kBytes = 4;  // fewest bytes of a triangle
  if (node.items > from.bytes_left() / kBytes) ByteReader::throw_out_of_range("triangles of a tree");
  job.first = static_cast<std::uint32_t>(work.build_triangles.size());
  std::uint32_t last = 0;
  for (std::uint32_t i = 0; i < node.items; ++i) {
    std::array<std::uint32_t, 3>& triangle = work.build_triangles.emplace_back();
    for (std::uint32_t& vertex : triangle) {
      vertex = last = from.read_difference_from(last, sizes.vertices, "vertex of a triangle");
      if (vertex == sizes.vertices) ByteReader::throw_out_of_range("vertex of a triangle");
    }
  }
  last = 0;
  for (std::uint32_t i = 0; i < node.items; ++i) {
    last = from.read_difference_from(last, node.items, "number of a triangle");
    if (last == node.items) ByteReader::throw_out_of_range("number of a triangle");
    work.build_order.push_back(last);
  }
}

// The following functions check that any machine can execute a decoded tile. They throw InputError, without a file
// name.

/// True if the items of a node occupy ray slots.
bool uses_ray_slots(const WorkNode& node) {
  return node.kind == WorkNode::Kind::kRays || node.kind == WorkNode::Kind::kRaster;
}

/// Throws InputError unless a node with ray slots has one launch as its source.
void check_rays(const WorkNode& rays, const TileWork& work) {
  if (rays.inputs.size() != 1 || rays.inputs[0].kind != Edge::Kind::kEach ||
      work.nodes[rays.inputs[0].node].kind != WorkNode::Kind::kLaunch) {
    throw sim::InputError("rays must have one input, an `each` edge from a launch");
  }
  if (rays.sources == WorkNode::kNone && rays.items != work.nodes[rays.inputs[0].node].items) {
    throw sim::InputError("rays without sources must be as many as the items that make them");
  }
}

/// Throws InputError unless each batch of rays has a node that reads all its hits. A ray's slot is only released when
/// its hit has been read.
void check_readers(const TileWork& work) {
  std::vector<bool> read(work.nodes.size()), whole(work.nodes.size());
  for (const WorkNode& node : work.nodes) {
    for (const Edge& edge : node.inputs) {
      const bool is_mapped = node.sources != WorkNode::kNone;
      read[edge.node] = true;
      if (edge.kind == Edge::Kind::kAll || is_mapped || node.items == work.nodes[edge.node].items)
        whole[edge.node] = true;
    }
  }
  for (std::size_t n = 0; n < work.nodes.size(); ++n) {
    if (!uses_ray_slots(work.nodes[n]) || whole[n]) continue;
    throw sim::InputError(fmt::format("no node reads {} hits of node {}", read[n] ? "all" : "the", n));
  }
}

/// Throws InputError unless nodes of the tile read all borders that it imports, because the end of a tile implies that
/// its imported borders have arrived.
void check_imports(const TileWork& work) {
  std::uint32_t read = 0;
  for (const WorkNode& node : work.nodes) {
    const bool imports = node.kind == WorkNode::Kind::kTransfer && !node.to_memory && node.border != WorkNode::kNone;
    if (imports) read |= 1U << node.border;
  }
  for (std::size_t i = 0; i < work.imports.size(); ++i) {
    if ((read >> i & 1U) == 0) throw sim::InputError(fmt::format("no transfer reads border {}", i));
  }
}

// Encoding of nodes, walks and sources.

// Limits on the counts of a tile. They are far above real counts, and keep sums within 32 bits.
constexpr std::uint64_t kMaxItems = 1U << 26, kMaxRaysOfTile = 1U << 24, kMaxTiles = 1U << 28;
constexpr std::uint64_t kMaxFreeItems = 1U << 20;  ///< limit on items with accesses; rises by 8 per encoded byte

enum WalkEncoding : std::uint32_t { kCompact = 0, kPlain = 1, kCompactLookUps = 2, kWalkEncodings };

void append_words(const std::vector<std::uint32_t>& words, std::string& out) {
  const std::size_t before = out.size();
  out.resize(before + 4 * words.size());
  if (!words.empty()) std::memcpy(out.data() + before, words.data(), 4 * words.size());
}

void write_walks(const TileWork& work, const Links& links, std::string& out) {
  ByteWriter to(out);
  to.write_number(work.ray_begin.size());
  to.write_number(work.walk.size());
  const std::size_t form = out.size();
  const bool look_ups = has_look_ups(work);
  to.write_byte(look_ups ? kCompactLookUps : kCompact);
  if (encode_walks(work, links, look_ups, out)) return;
  out[form] = static_cast<char>(kPlain);
  append_words(work.walk, out);
}

void write_node(const TileWork& work, std::uint32_t node_index, ByteWriter& to) {
  const WorkNode& node = work.nodes[node_index];
  to.write_byte(static_cast<std::uint32_t>(node.kind));
  to.write_number(node.items);
  switch (node.kind) {
    case WorkNode::Kind::kLaunch:
      to.write_number(node.kernel);
      to.write_number(node.idle);
      to.write_byte(node.has_accesses ? 1 : 0);
      break;
    case WorkNode::Kind::kRays:
      to.write_byte(static_cast<std::uint32_t>(node.ray_kind));
      to.write_byte(node.sources == WorkNode::kNone ? 0 : 1);
      break;
    case WorkNode::Kind::kTransfer:
      to.write_byte(static_cast<std::uint32_t>(node.region));
      to.write_byte(node.to_memory ? 1 : 0);
      to.write_number(node.offset);
      to.write_number(node.border == WorkNode::kNone ? 0 : std::uint64_t{node.border} + 1);
      break;
    case WorkNode::Kind::kBin:
    case WorkNode::Kind::kRaster:
      write_raster_counts(work, node, to);
      break;
    case WorkNode::Kind::kBuild:
      write_build_job(work.build[node.first], to);
      break;
  }
  to.write_number(node.inputs.size());
  for (const Edge& edge : node.inputs)
    to.write_number(std::uint64_t{node_index - edge.node} << 1 | static_cast<std::uint64_t>(edge.kind));
}

void write_sources(const TileWork& work, const WorkNode& node, ByteWriter& to) {
  std::uint32_t last = 0;
  for (std::uint32_t i = 0; i < node.items; ++i) {
    const std::uint32_t source = work.sources[node.sources + i];
    to.write_number(source - last);
    last = source;
  }
}

std::uint32_t read_flag(ByteReader& from, const char* what) {
  const std::uint32_t value = from.read_byte();
  if (value > 1) ByteReader::throw_out_of_range(what);
  return value;
}

/// Returns how many words accesses of kind kStored may name: those of region kSamples or, if kernels build trees, of
/// all regions up to kBuild. Each region begins on a new line.
std::uint64_t stored_words(const TileScope& scope) {
  constexpr std::uint64_t kLine = 64;
  const auto bytes_of = [&](Region region) { return scope.region_bytes[static_cast<std::size_t>(region)]; };
  std::uint64_t bytes = bytes_of(Region::kSamples);
  if (bytes_of(Region::kBuild) != 0) {
    for (const Region region : {Region::kRates, Region::kBuild}) {
      bytes = (bytes + kLine - 1) / kLine * kLine + bytes_of(region);
    }
  }
  return bytes / kStoredWordBytes;
}

void read_transfer(ByteReader& from, const TileScope& scope, std::uint32_t imports, WorkNode& node) {
  const std::uint32_t region = from.read_byte();
  if (region >= kRegionCount) ByteReader::throw_out_of_range("region of a transfer");
  node.region = static_cast<Region>(region);
  node.to_memory = read_flag(from, "direction of a transfer") != 0;
  const std::uint64_t size = scope.region_bytes[region];
  node.offset = from.read_number(size, "offset of a transfer");
  if (node.items > size - node.offset) ByteReader::throw_out_of_range("bytes of a transfer");
  const std::uint32_t border = from.read_number32(node.to_memory ? kMostBorders : imports, "border of a transfer");
  node.border = border == 0 ? WorkNode::kNone : border - 1;
}

/// Decodes the edges from earlier nodes of the work graph to node `node_index`.
void read_inputs(ByteReader& from, std::uint32_t node_index, TileWork& work) {
  WorkNode& node = work.nodes[node_index];
  for (std::uint32_t left = from.read_number32(from.bytes_left(), "inputs of a node"); left > 0; --left) {
    const std::uint64_t code = from.read_number(2 * std::uint64_t{node_index} + 1, "input of a node");
    if (code < 2) ByteReader::throw_out_of_range("input of a node");
    const Edge edge{node_index - static_cast<std::uint32_t>(code >> 1), static_cast<Edge::Kind>(code & 1)};
    // If the node maps no items, item i waits for item i of the input, which must exist.
    const bool each = edge.kind == Edge::Kind::kEach && node.sources == WorkNode::kNone;
    if (each && node.items > work.nodes[edge.node].items) ByteReader::throw_out_of_range("input of a node");
    node.inputs.push_back(edge);
  }
}

}  // namespace

void TileEncoder::encode_tile(const TileWork& work, const Links& links, std::string& out) {
  if (work.nodes.size() > kMaxTileNodes) {
    throw sim::InputError(fmt::format(
        "a tile of more than {} launches, batches of rays and transfers cannot be recorded", kMaxTileNodes));
  }
  ByteWriter to(out);
  to.write_number(work.frame);
  to.write_number(work.tile);
  to.write_number(work.samples);
  to.write_byte(work.after_all ? 1 : 0);
  to.write_number(work.imports.size());
  for (const Border& border : work.imports) {
    to.write_number(border.tile);
    to.write_number(border.number);
  }
  to.write_number(work.nodes.size());
  for (std::uint32_t n = 0; n < work.nodes.size(); ++n) write_node(work, n, to);
  // All nodes are followed by their accesses, sources and other data, in node order.
  accesses_.begin_tile();
  std::uint32_t rays = 0, items = 0;
  for (const WorkNode& node : work.nodes) {
    const bool loads = node.kind == WorkNode::Kind::kLaunch && node.has_accesses;
    const bool traces = node.kind == WorkNode::Kind::kRays, mapped = node.sources != WorkNode::kNone;
    if ((traces && node.first != rays) || (loads && node.first != items) || (mapped && !traces)) {
      throw std::logic_error("a tile's rays and items do not lie in the order of its nodes");
    }
    if (mapped) write_sources(work, node, to);
    if (loads) accesses_.write_launch(work, node, out);
    if (node.raster != WorkNode::kNone) write_raster(work, node, to);
    if (node.kind == WorkNode::Kind::kBuild) write_build_triangles(work, node, to);
    rays += traces ? node.items : 0;
    items += loads ? node.items : 0;
  }
  write_walks(work, links, out);
}

WorkNode& TileDecoder::add_node(TileWork& work) {
  if (nodes_ == work.nodes.size()) {
    if (spare_.empty()) spare_.emplace_back();
    work.nodes.push_back(std::move(spare_.back()));
    spare_.pop_back();
  }
  WorkNode& node = work.nodes[nodes_++];
  std::vector<Edge> inputs = std::move(node.inputs);
  inputs.clear();
  node = {.inputs = std::move(inputs)};
  return node;
}

void TileDecoder::read_launch(ByteReader& from, const TileScope& scope, WorkNode& node) {
  node.kernel = static_cast<KernelId>(from.read_number(scope.kernels - 1, "kernel of a launch"));
  node.idle = from.read_number32(kMaxItems, "idle items of a launch");
  node.has_accesses = read_flag(from, "accesses of a launch") != 0;
  if (!node.has_accesses) return;
  node.first = items_;
  items_ += node.items;
  if (items_ > most_items_) {
    throw sim::InputError(
        fmt::format("has {} items with accesses; allowed: {}, and 8 for each of its bytes", items_, kMaxFreeItems));
  }
}

void TileDecoder::read_rays(ByteReader& from, WorkNode& node) {
  const std::uint32_t ray_kind = from.read_byte();
  if (ray_kind >= kRayKinds) ByteReader::throw_out_of_range("kind of rays");
  node.ray_kind = static_cast<RayKind>(ray_kind);
  // If the node has sources, 0 is a placeholder until they are read.
  node.sources = read_flag(from, "sources of rays") != 0 ? 0 : WorkNode::kNone;
  node.first = rays_;
  rays_ += node.items;
  if (rays_ > kMaxRaysOfTile) ByteReader::throw_out_of_range("rays of a tile");
  found_.by_kind[ray_kind] += node.items;
}

void TileDecoder::read_kind(ByteReader& from, const TileScope& scope, WorkNode& node) {
  const std::uint32_t kind = from.read_byte();
  const WorkNode::Kind last = scope.raster ? WorkNode::Kind::kRaster : WorkNode::Kind::kTransfer;
  node.kind = static_cast<WorkNode::Kind>(kind);
  if (scope.build && node.kind == WorkNode::Kind::kBuild) return;
  if (kind > static_cast<std::uint32_t>(last)) ByteReader::throw_out_of_range("kind of a node");
}

void TileDecoder::read_nodes(ByteReader& from, const TileScope& scope, TileWork& work) {
  nodes_ = rays_ = items_ = 0;
  work.raster.clear();
  work.raster_triangles.clear();
  work.list_runs.clear();
  work.build.clear();
  work.build_triangles.clear();
  work.build_order.clear();
  const std::uint32_t nodes =
      from.read_number32(std::min<std::uint64_t>(from.bytes_left() / 3, kMaxTileNodes), "number of nodes");
  if (nodes == 0) ByteReader::throw_out_of_range("number of nodes");
  for (std::uint32_t n = 0; n < nodes; ++n) {
    WorkNode& node = add_node(work);
    read_kind(from, scope, node);
    const bool moves = node.kind == WorkNode::Kind::kTransfer;
    node.items = from.read_number32(moves ? std::numeric_limits<std::uint32_t>::max() : kMaxItems, "items of a node");
    if (node.items == 0) ByteReader::throw_out_of_range("items of a node");
    switch (node.kind) {
      case WorkNode::Kind::kLaunch:
        read_launch(from, scope, node);
        break;
      case WorkNode::Kind::kRays:
        read_rays(from, node);
        break;
      case WorkNode::Kind::kTransfer:
        read_transfer(from, scope, static_cast<std::uint32_t>(work.imports.size()), node);
        break;
      case WorkNode::Kind::kBin:
      case WorkNode::Kind::kRaster:
        read_raster_counts(from, node, work);
        break;
      case WorkNode::Kind::kBuild:
        if (nodes != 1) ByteReader::throw_out_of_range("number of nodes");
        read_build_job(from, *scope.build, node, work);
        break;
    }
    read_inputs(from, n, work);
    if (uses_ray_slots(node)) check_rays(node, work);
  }
  while (work.nodes.size() > nodes_) {
    spare_.push_back(std::move(work.nodes.back()));
    work.nodes.pop_back();
  }
  check_readers(work);
  check_imports(work);
}

TileRays TileDecoder::decode_tile(std::string_view bytes, const TileScope& scope, TileWork& work) {
  ByteReader from(bytes);
  found_ = {};
  most_items_ = std::min(kMaxItems, kMaxFreeItems + 8 * bytes.size());
  work.frame = from.read_number32(std::numeric_limits<std::uint32_t>::max(), "frame");
  work.tile = from.read_number32(kMaxTiles, "number of a tile");
  work.samples = from.read_number32(kMaxItems, "samples of a tile");
  work.after_all = read_flag(from, "whether a tile waits for all others") != 0;
  work.imports.clear();
  for (std::uint32_t left = from.read_number32(kMostImports, "borders that a tile imports"); left > 0; --left) {
    const std::uint32_t tile = from.read_number32(kMaxTiles, "tile of an imported border");
    work.imports.push_back({tile, from.read_number32(kMostBorders - 1, "number of an imported border")});
  }
  read_nodes(from, scope, work);
  work.accesses.clear();
  work.ray_keys.clear();
  work.access_begin.clear();
  work.sources.clear();
  accesses_.begin_tile();
  for (WorkNode& node : work.nodes) {
    if (node.sources != WorkNode::kNone) {
      node.sources = static_cast<std::uint32_t>(work.sources.size());
      const std::uint32_t makers = work.nodes[node.inputs[0].node].items;
      std::uint64_t source = 0;
      if (node.items > from.bytes_left()) ByteReader::throw_out_of_range("sources of rays");
      for (std::uint32_t i = 0; i < node.items; ++i) {
        source += from.read_number(makers, "source of a ray");
        if (source >= makers) ByteReader::throw_out_of_range("source of a ray");
        work.sources.push_back(static_cast<std::uint32_t>(source));
      }
    }
    if (node.has_accesses) {
      accesses_.read_launch(from, {scope.counts, stored_words(scope)}, node.items, work);
    }
    if (node.raster != WorkNode::kNone) {
      RasterWork& job = work.raster[node.raster];
      job.first_triangle = static_cast<std::uint32_t>(work.raster_triangles.size());
      job.first_run = static_cast<std::uint32_t>(work.list_runs.size());
      read_raster(from, *scope.raster, node, work);
    }
    if (node.kind == WorkNode::Kind::kBuild) read_build_triangles(from, *scope.build, node, work);
  }
  work.access_begin.push_back(static_cast<std::uint32_t>(work.accesses.size()));

  const std::uint32_t rays = from.read_number32(kMaxRaysOfTile, "rays of a tile");
  // Each walk takes at least one bit.
  if (rays != rays_ || rays > 8 * from.bytes_left()) throw sim::InputError("has not as many walks as rays");
  const std::uint32_t words = from.read_number32(std::numeric_limits<std::uint32_t>::max(), "words of walks");
  const std::uint32_t form = from.read_byte();
  if (form >= kWalkEncodings) ByteReader::throw_out_of_range("form of walks");
  if (form == kCompactLookUps && !scope.look_ups) {
    throw sim::InputError("has walks with look-ups; allowed without tni.predictor: none");
  }
  const std::string_view rest = from.read_bytes(from.bytes_left());
  if (form == kPlain) {
    if (rest.size() != 4 * std::uint64_t{words}) throw sim::InputError("has not as many walks as it says");
    found_.steps = decode_plain_walks(rest, scope.links, scope.look_ups, rays, work);
  } else {
    // Each word takes at least one bit.
    if (words > 8 * std::uint64_t{rest.size()}) ByteReader::throw_out_of_range("words of walks");
    found_.steps = decode_walks(rest, scope.links, form == kCompactLookUps, rays, words, work);
  }
  return found_;
}

}  // namespace traces
