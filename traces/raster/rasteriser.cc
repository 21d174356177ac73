#include "traces/raster/rasteriser.h"

#include <algorithm>
#include <limits>
#include <tuple>

namespace traces {
namespace {

/// Depth of the near plane, in diagonals of the scene. The depth is small, because rays begin at the eye.
constexpr double kNear = 1e-6;

double near_plane_depth(const MemoryImage& image) {
  const double diagonal = image.diagonal();
  return diagonal > 0 && diagonal < std::numeric_limits<double>::infinity() ? kNear * diagonal : kNear;
}

std::uint32_t whole_pixels(double pixels) { return pixels <= 0 ? 0 : static_cast<std::uint32_t>(pixels); }

Coverage::Block make_block(std::span<const Coverage::Sample> samples) {
  Coverage::Block block{samples, {samples[0].at, samples[0].at}, std::numeric_limits<double>::infinity()};
  for (const Coverage::Sample& s : samples) {
    block.box = {glm::min(block.box.low, s.at), glm::max(block.box.high, s.at)};
  }
  return block;
}

double farthest_depth(const Coverage::Block& block, const Coverage& found) {
  double depth = 0;
  for (const Coverage::Sample& s : block.samples) {
    const Coverage::NearestTriangle& winner = found.winners[s.sample];
    if (winner.triangle == kNone) return std::numeric_limits<double>::infinity();
    depth = std::max(depth, winner.depth);
  }
  return depth;
}

bool boxes_overlap(const PictureBox& a, const PictureBox& b) {
  return a.high.x >= b.low.x && a.low.x <= b.high.x && a.high.y >= b.low.y && a.low.y <= b.high.y;
}

/// Tests the depth of a triangle at a sample that the triangle covers. If the triangle is the nearest so far, stores it
/// for the sample and returns true.
bool test_depth(const Coverage::Sample& sample, std::uint32_t number, const EdgeFunctions& edges, Coverage& found) {
  Coverage::NearestTriangle& winner = found.winners[sample.sample];
  const double depth = edges.depth_at(sample.at);
  if (winner.triangle != kNone && !(depth < winner.depth)) return false;
  winner = {number, depth};
  return true;
}

/// Tests which samples of a block of pixels a triangle covers. The samples are sorted by quad.
void cover_block(const Coverage::Block& block, bool hidden, const EdgeFunctions& edges, Coverage& found,
                 RasterTriangle& triangle) {
  const std::span<const Coverage::Sample> samples = block.samples;
  for (std::size_t begin = 0, end = 0; begin < samples.size(); begin = end) {
    std::uint32_t covered = 0;
    for (end = begin; end < samples.size() && samples[end].quad == samples[begin].quad; ++end) {
      if (!edges.covers_point(samples[end].at)) continue;
      covered += 1;
      found.layers[samples[end].sample] += 1;
      if (!hidden && test_depth(samples[end], triangle.number, edges, found)) triangle.passed += 1;
    }
    if (covered == 0) continue;
    triangle.samples += covered;
    triangle.quads += 1;
    if (hidden) {
      triangle.hidden_samples += covered;
      triangle.hidden_quads += 1;
    }
    for (std::size_t i = begin; i < end; ++i) found.quads[samples[i].sample] += 1;
  }
}

}  // namespace

Rasteriser::Rasteriser(const MemoryImage& image, const PictureCamera& camera, const RasterConfig& config,
                       std::uint32_t side)
    : config_(config),
      geometry_(raster_geometry(image)),
      view_(camera),
      near_(near_plane_depth(image)),
      lists_(geometry_, view_, near_, side) {}

RasterArraySizes Rasteriser::raster_array_sizes() const {
  return {static_cast<std::uint32_t>(geometry_.vertices.size()), triangle_count(), lists_.entry_count()};
}

std::array<Projected, 3> Rasteriser::project_corners(std::uint32_t triangle) const {
  const auto& v = geometry_.triangles[triangle].vertices;
  return {view_.project_point(geometry_.vertices[v[0]]), view_.project_point(geometry_.vertices[v[1]]),
          view_.project_point(geometry_.vertices[v[2]])};
}

std::uint32_t Rasteriser::bin_triangles(std::uint32_t batch, Coverage& scratch, TileWork& work) const {
  const std::uint32_t first = batch * config_.batch, end = std::min(first + config_.batch, triangle_count());
  RasterWork job{static_cast<std::uint32_t>(work.raster_triangles.size()), end - first,
                 static_cast<std::uint32_t>(work.list_runs.size()), 0, 1};
  std::vector<std::uint32_t>& touched = scratch.touched;
  touched.clear();
  for (std::uint32_t t = first; t < end; ++t) {
    RasterTriangle& triangle =
        work.raster_triangles.emplace_back(RasterTriangle{.number = t, .vertices = geometry_.triangles[t].vertices});
    lists_.for_each_list(t, [&](std::uint32_t list) {
      triangle.lists += 1;
      touched.push_back(list);
    });
  }
  std::ranges::sort(touched);
  for (auto at = touched.begin(); at != touched.end();) {
    const auto next = std::find_if(at, touched.end(), [&](std::uint32_t list) { return list != *at; });
    const auto list = lists_.triangle_list(*at);
    const auto skipped = std::ranges::lower_bound(list, first) - list.begin();
    work.list_runs.push_back(
        {lists_.first_entry(*at) + static_cast<std::uint32_t>(skipped), static_cast<std::uint32_t>(next - at)});
    job.runs += 1;
    at = next;
  }
  work.raster.push_back(job);
  return job.triangles;
}

/// Computes where the rays cross the picture plane, and sorts these samples by triangle list (of their screen region),
/// block and quad.
void Rasteriser::sort_samples(std::span<const Ray> rays, Coverage& found) const {
  const std::uint32_t blocks = view_.width() / config_.block + 1, quads = view_.width() / 2 + 1;
  found.samples.resize(rays.size());
  for (std::uint32_t i = 0; i < rays.size(); ++i) {
    const Projected seen = view_.project_direction(rays[i].direction);
    const glm::dvec2 at = glm::dvec2(seen) / seen.z;
    const std::uint32_t x = std::min(whole_pixels(at.x), view_.width() - 1),
                        y = std::min(whole_pixels(at.y), view_.height() - 1);
    found.samples[i] = {lists_.list_number_at(at), y / config_.block * blocks + x / config_.block,
                        y / 2 * quads + x / 2, i, at};
  }
  std::ranges::sort(found.samples, {},
                    [](const Coverage::Sample& s) { return std::tuple(s.list, s.block, s.quad, s.sample); });
}

void Rasteriser::rasterise_samples(std::span<const Ray> rays, Coverage& found, TileWork* work) const {
  found.winners.assign(rays.size(), {});
  found.layers.assign(rays.size(), 0);
  found.quads.assign(rays.size(), 0);
  sort_samples(rays, found);
  RasterWork job;
  if (work != nullptr) {
    job.first_triangle = static_cast<std::uint32_t>(work->raster_triangles.size());
    job.first_run = static_cast<std::uint32_t>(work->list_runs.size());
  }
  std::uint32_t most = 1;  // largest number of samples in a quad
  for (std::size_t begin = 0, end = 0; begin < rays.size(); begin = end) {
    const std::uint32_t list = found.samples[begin].list;
    std::size_t quad = begin;
    for (end = begin; end < rays.size() && found.samples[end].list == list; ++end) {
      if (found.samples[end].quad != found.samples[quad].quad) quad = end;
      most = std::max(most, static_cast<std::uint32_t>(end - quad + 1));
    }
    if (lists_.triangle_list(list).empty()) continue;
    if (work != nullptr) {
      work->list_runs.push_back(
          {lists_.first_entry(list), static_cast<std::uint32_t>(lists_.triangle_list(list).size())});
      job.runs += 1;
    }
    find_coverage_in_list(std::span(found.samples).subspan(begin, end - begin), found, work);
  }
  if (work == nullptr) return;
  job.triangles = static_cast<std::uint32_t>(work->raster_triangles.size()) - job.first_triangle;
  job.pixel_samples = (most + 3) / 4;
  work->raster.push_back(job);
}

void Rasteriser::find_coverage_in_list(std::span<const Coverage::Sample> samples, Coverage& found,
                                       TileWork* work) const {
  found.blocks.clear();
  for (std::size_t begin = 0, end = 0; begin < samples.size(); begin = end) {
    while (end < samples.size() && samples[end].block == samples[begin].block) ++end;
    found.blocks.push_back(make_block(samples.subspan(begin, end - begin)));
  }
  EdgeFunctions edges;
  RasterBounds bounds;
  for (const std::uint32_t number : lists_.triangle_list(samples[0].list)) {
    RasterTriangle triangle{.number = number, .vertices = geometry_.triangles[number].vertices};
    const std::array<Projected, 3> at = project_corners(number);
    if (bounds_of(at, near_, bounds) && edges.set_triangle(at)) {
      for (Coverage::Block& block : found.blocks) {
        if (!boxes_overlap(block.box, bounds.box) || !edges.may_touch(block.box)) continue;
        const bool hidden = bounds.nearest > block.farthest;
        const std::uint32_t passed = triangle.passed;
        triangle.blocks += 1;
        if (hidden) triangle.hidden_blocks += 1;
        cover_block(block, hidden, edges, found, triangle);
        if (triangle.passed != passed) block.farthest = farthest_depth(block, found);
      }
    }
    if (work != nullptr) work->raster_triangles.push_back(triangle);
  }
}

}  // namespace traces
