#include "tools/timeline/timeline.h"

#include <algorithm>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "hw_models/dram/dram_channel.h"
#include "tests/hw_models/machines/gpu_harness.h"
#include "tests/tools/tiles/itemised.h"
#include "tests/tools/timeline/decoded.h"
#include "tools/analysis/units.h"
#include "tools/tiles/tile_energy.h"

// Tests that timelines in Perfetto's format, decoded by protoc, agree with the report.

namespace tools::test {
namespace {

struct Recorded {
  Inputs inputs = small_inputs({"render.tile=16", "cores=2"});
  TimelineRecorder recorder{2};
  FrameResult s = simulate_frame(inputs, {}, 1, {.itemised = true, .observer = &recorder});
  TileFrame tiles = compute_tile_table(s, inputs.config, 0);

  Timeline make(const std::string& asked, std::uint64_t most_bytes = kMostTimelineBytes) const {
    return make_timeline(recorder, parse_timeline(asked), s, tiles, inputs.config, most_bytes);
  }
};
const Recorded& recorded() {
  static const Recorded all;
  return all;
}
const DecodedTimeline& whole() {
  static const DecodedTimeline all = decode_timeline(recorded().make("all").bytes);
  return all;
}

TEST(Timelines, AreReadByProtoc) {
  EXPECT_EQ(whole().problem, "");
  EXPECT_EQ(whole().slices.size() >= recorded().make("all").slices, true) << "loops have parts";
  std::set<std::string> processes;
  for (const auto& [id, name] : whole().processes) processes.insert(name);
  EXPECT_EQ(processes, (std::set<std::string>{"core 0", "core 1", "shared"}));
}

TEST(Timelines, SumToTheCyclesOfEachKernel) {
  std::map<std::string, std::uint64_t> cycles, lengths, items;
  for (const DecodedSlice& slice : whole().slices) {
    if (slice.category != "kernel" || slice.depth != 0) continue;
    cycles[slice.name] += slice.notes.at("cycles");
    lengths[slice.name] += slice.end - slice.begin;
    items[slice.name] += slice.notes.at("items");
  }
  std::size_t kernels = 0;
  const FrameResult& s = recorded().s;
  for (std::size_t k = 0; k < s.kernels.size(); ++k) {
    if (s.kernel_use[k].launches == 0) continue;
    const std::string& name = s.kernels[k].kernel;
    kernels += 1;
    EXPECT_EQ(cycles[name], s.kernel_use[k].cycles) << name;
    EXPECT_EQ(lengths[name], s.kernel_use[k].cycles) << name << ": the shader core runs at 1 GHz";
    EXPECT_EQ(items[name], s.kernel_use[k].items) << name;
  }
  EXPECT_GT(kernels, 5U);
  EXPECT_EQ(cycles.size(), kernels);
}

TEST(Timelines, ShowEveryTileRayAndByte) {
  std::set<std::uint64_t> tiles;
  std::uint64_t rays = 0, picture = 0;
  for (const DecodedSlice& slice : whole().slices) {
    const std::string path = whole().path(slice);
    if (slice.category == "tile") tiles.insert(slice.notes.at("tile"));
    if (slice.category == "rays") rays += slice.notes.at("rays");
    if (slice.name == "write picture") picture += slice.notes.at("bytes");
    const std::string track = path.substr(path.find('/') + 1);
    EXPECT_EQ(track, slice.category == "tile"     ? track.starts_with("tile slot ") ? track : "tile slot"
                     : slice.category == "kernel" ? "SRP"
                     : slice.category == "rays"   ? "T&I rays"
                                                  : "DMA");
  }
  EXPECT_EQ(tiles.size(), 6U) << "48 x 24 in tiles of 16";
  EXPECT_EQ(rays, recorded().s.rays());
  EXPECT_EQ(picture, 4U * 48 * 24);
}

TEST(Timelines, LeadAFlowFromEachTileThroughItsRaysToItsTransfers) {
  std::map<std::uint64_t, std::vector<const DecodedSlice*>> flows;
  for (const DecodedSlice& slice : whole().slices) {
    for (const std::uint64_t flow : slice.flows) flows[flow].push_back(&slice);
  }
  EXPECT_EQ(flows.size(), 6U);
  for (auto& [flow, slices] : flows) {
    std::ranges::stable_sort(slices, {}, &DecodedSlice::begin);
    EXPECT_EQ(slices.front()->category, "tile");
    EXPECT_EQ(slices.back()->name, "write picture");
    for (const DecodedSlice* slice : slices) {
      EXPECT_EQ(slice->notes.at("tile"), slices.front()->notes.at("tile"));
      EXPECT_LE(slice->end, slices.front()->end) << slice->name;
    }
  }
}

TEST(Timelines, HaveCountersWithUnitsThatSumToTheReport) {
  std::map<std::string, std::string> units;
  double bytes = 0, joules = 0;
  const auto seconds = static_cast<double>(recorded().s.elapsed) / sim::kFemtosecondsPerSecond;
  for (const auto& [track, values] : whole().counters) {
    const DecodedTrack& counter = whole().tracks.at(track);
    units[counter.name] = counter.unit;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double until = i + 1 < values.size() ? static_cast<double>(values[i + 1].first) * 1e-9 : seconds;
      const double amount = values[i].second * (until - static_cast<double>(values[i].first) * 1e-9);
      if (counter.unit == "GB/s") bytes += amount * 1e9;
      if (counter.unit == "W") joules += amount;
    }
  }
  EXPECT_EQ(units, (std::map<std::string, std::string>{{"DRAM read", "GB/s"},
                                                       {"DRAM write", "GB/s"},
                                                       {"L2 hits", "%"},
                                                       {"SRP busy", "%"},
                                                       {"power", "W"},
                                                       {"rays in T&I", "rays"}}));
  const auto moved = Units<hw::DramChannel>(recorded().s.units).sum_of(&hw::DramChannel::Stats::bytes);
  EXPECT_NEAR(bytes, static_cast<double>(moved), 1e-6 * static_cast<double>(moved));
  const double spent = recorded().s.energy.total_pj.nominal * 1e-12;
  EXPECT_NEAR(joules, spent, 1e-6 * spent);
}

TEST(Timelines, OfATileShowWhatItsCoreDidMeanwhile) {
  const TileFrame& tiles = recorded().tiles;
  for (const char* asked : {"tile:1,0", "pixel:17,3"}) {
    const DecodedTimeline timeline = decode_timeline(recorded().make(asked).bytes);
    EXPECT_EQ(timeline.problem, "");
    std::set<std::string> processes;
    bool has_tile = false;
    for (const DecodedSlice& slice : timeline.slices) {
      const std::string path = timeline.path(slice);
      processes.insert(path.substr(0, path.find('/')));
      has_tile |= slice.category == "tile" && slice.notes.at("tile") == 1;
    }
    EXPECT_TRUE(has_tile) << asked;
    EXPECT_EQ(processes.size(), 1U) << asked;
    EXPECT_LT(timeline.slices.size(), whole().slices.size());
  }
  EXPECT_EQ(tiles.at("x")[1], 16);
}

TEST(Timelines, ShowThePassesOfTheTreeBuilder) {
  const Inputs inputs = small_inputs({"render.tile=16", "scene.triangles=3000", "bvh.builder=lbvh", "build.engine=unit",
                                      "tree_builder.run=256", "tree_builder.ways=8"},
                                     "32x16", "car");
  TimelineRecorder recorder(inputs.config.gpu->cores);
  const FrameResult s = simulate_frame(inputs, {}, 1, {.itemised = true, .observer = &recorder});
  const TileFrame tiles = compute_tile_table(s, inputs.config, 0);
  for (const char* asked : {"all", "slowest:1"}) {
    const DecodedTimeline timeline =
        decode_timeline(make_timeline(recorder, parse_timeline(asked), s, tiles, inputs.config).bytes);
    EXPECT_EQ(timeline.problem, "");
    std::vector<std::string> passes;
    std::uint64_t end = 0;
    for (const DecodedSlice& slice : timeline.slices) {
      if (slice.category != "build") continue;
      passes.push_back(slice.name);
      EXPECT_EQ(timeline.path(slice), "shared/tree builder");
      EXPECT_EQ(slice.notes.at("items"), inputs.builds.sizes.triangles);
      end = slice.end;
    }
    EXPECT_EQ(passes, (std::vector<std::string>{"sort", "merge", "hierarchy", "invalidate"})) << asked;
    for (const DecodedSlice& slice : timeline.slices) {
      if (slice.category != "tile") continue;
      // Passes that pose the geometry have the numbers after those of the picture's two tiles.
      EXPECT_EQ(slice.begin >= end, slice.notes.at("tile") < 2U) << "tiles wait for the tree";
    }
  }
}

TEST(Timelines, KeepToTheirRoomAndSayWhatHadNone) {
  const Timeline all = recorded().make("all");
  EXPECT_EQ(all.dropped, 0U);
  const std::uint64_t most = all.bytes.size() / 2;
  const Timeline half = recorded().make("all", most);
  EXPECT_LE(half.bytes.size(), most);
  EXPECT_GT(half.slices, 0U);
  EXPECT_GT(half.dropped, 0U);
  EXPECT_EQ(half.slices + half.dropped, all.slices);
  EXPECT_EQ(decode_timeline(half.bytes).problem, "");
}

TEST(Timelines, ChangeNothing) {
  const Recorded& r = recorded();
  const FrameResult plain = simulate_frame(r.inputs, {}, 1);
  const hw::test::Outcome a{plain.units, plain.kernel_use, {}, plain.elapsed, plain.cycles};
  const hw::test::Outcome b{r.s.units, r.s.kernel_use, {}, r.s.elapsed, r.s.cycles};
  EXPECT_EQ(difference(a, b), "");
}

TEST(Timelines, AreTheSameForAnyNumberOfThreads) {
  const Recorded& r = recorded();
  TimelineRecorder recorder(2);
  const FrameResult s = simulate_frame(r.inputs, {}, 3, {.itemised = true, .observer = &recorder});
  EXPECT_EQ(make_timeline(recorder, {}, s, r.tiles, r.inputs.config).bytes, r.make("all").bytes);
}

}  // namespace
}  // namespace tools::test
