#include "traces/trace_file/raster_code.h"

#include <cstdint>

#include "sim/error.h"

namespace traces {
namespace {

// A limit far above any tile's counts; it keeps sums within 32 bits.
constexpr std::uint64_t kMost = 1U << 26;
constexpr std::uint64_t kLeastBytes = 5;  ///< minimum per triangle

std::int64_t step(std::uint32_t from, std::uint32_t to) { return std::int64_t{to} - std::int64_t{from}; }

void write_cover(const RasterTriangle& t, ByteWriter& to) {
  to.number(t.blocks);
  if (t.blocks == 0) return;
  to.number(t.hidden_blocks);
  to.number(t.quads);
  if (t.quads == 0) return;
  for (const std::uint32_t count : {t.hidden_quads, t.samples, t.hidden_samples, t.passed}) to.number(count);
}

void read_cover(ByteReader& from, RasterTriangle& t) {
  constexpr const char* kWhat = "coverage of a triangle";
  t.blocks = from.number32(kMost, kWhat);
  if (t.blocks == 0) return;
  t.hidden_blocks = from.number32(t.blocks, kWhat);
  t.quads = from.number32(kMost, kWhat);
  if (t.quads == 0) return;
  t.hidden_quads = from.number32(t.quads, kWhat);
  t.samples = from.number32(kMost, kWhat);
  t.hidden_samples = from.number32(t.samples, kWhat);
  t.passed = from.number32(t.samples - t.hidden_samples, kWhat);
}

}  // namespace

void write_raster_counts(const TileWork& work, const WorkNode& node, ByteWriter& to) {
  const RasterWork& job = work.raster[node.raster];
  to.number(job.runs);
  if (node.kind == WorkNode::Kind::kBin) return;
  to.number(job.triangles);
  to.number(job.pixel_samples);
}

void read_raster_counts(ByteReader& from, WorkNode& node, TileWork& work) {
  const bool bins = node.kind == WorkNode::Kind::kBin;
  node.raster = static_cast<std::uint32_t>(work.raster.size());
  RasterWork job;
  job.runs = from.number32(kMost, "runs of lists");
  job.triangles = bins ? node.items : from.number32(kMost, "triangles of a node");
  if (!bins) job.pixel_samples = from.number32(kMost, "samples of a pixel");
  if (job.pixel_samples == 0) ByteReader::out_of_range("samples of a pixel");
  work.raster.push_back(job);
}

void write_raster(const TileWork& work, const WorkNode& node, ByteWriter& to) {
  const RasterWork& job = work.raster[node.raster];
  std::uint32_t end = 0;
  for (std::uint32_t i = job.first_run; i < job.first_run + job.runs; ++i) {
    const ListRun& run = work.list_runs[i];
    to.difference(step(end, run.first));
    to.number(run.entries);
    end = run.first + run.entries;
  }
  RasterTriangle last;
  for (std::uint32_t i = job.first_triangle; i < job.first_triangle + job.triangles; ++i) {
    const RasterTriangle& t = work.raster_triangles[i];
    to.difference(step(last.number, t.number));
    to.difference(step(last.vertices[0], t.vertices[0]));
    to.difference(step(t.vertices[0], t.vertices[1]));
    to.difference(step(t.vertices[1], t.vertices[2]));
    if (node.kind == WorkNode::Kind::kBin) {
      to.number(t.lists);
    } else {
      write_cover(t, to);
    }
    last = t;
  }
}

void read_raster(ByteReader& from, const RasterDemands& demands, const WorkNode& node, TileWork& work) {
  const RasterWork& job = work.raster[node.raster];
  const bool bins = node.kind == WorkNode::Kind::kBin;
  if (job.runs > from.left() / 2) ByteReader::out_of_range("runs of lists");
  std::uint64_t entries = 0;
  std::uint32_t end = 0;
  for (std::uint32_t i = 0; i < job.runs; ++i) {
    ListRun run;
    run.first = from.moved(end, demands.entries, "a list of triangles");
    run.entries = from.number32(demands.entries - run.first, "a list of triangles");
    entries += run.entries;
    end = run.first + run.entries;
    work.list_runs.push_back(run);
  }
  if (job.triangles > from.left() / kLeastBytes) ByteReader::out_of_range("triangles of a node");
  std::uint64_t listed = 0;
  RasterTriangle last;
  for (std::uint32_t i = 0; i < job.triangles; ++i) {
    RasterTriangle t;
    t.number = from.moved(last.number, demands.triangles, "number of a triangle");
    if (t.number == demands.triangles) ByteReader::out_of_range("number of a triangle");
    std::uint32_t base = last.vertices[0];
    for (std::uint32_t& vertex : t.vertices) {
      vertex = base = from.moved(base, demands.vertices, "vertex of a triangle");
      if (vertex == demands.vertices) ByteReader::out_of_range("vertex of a triangle");
    }
    if (bins) {
      t.lists = from.number32(demands.entries, "lists of a triangle");
    } else {
      read_cover(from, t);
    }
    listed += bins ? t.lists : 1;
    work.raster_triangles.push_back(t);
    last = t;
  }
  if (listed != entries) throw sim::InputError("lists have not as many entries as triangles are in them");
}

}  // namespace traces
