#include <cstring>
#include <fstream>

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "sim/error.h"
#include "tests/sim/folder.h"
#include "tests/traces/trace_file/tiny_tile.h"
#include "traces/trace_file/bytes.h"
#include "traces/trace_file/format.h"
#include "traces/trace_file/trace_reader.h"
#include "traces/trace_file/trace_writer.h"

// Tests of trace files: tiles can be read in any order, damage is refused with one line, and files appear complete or
// not at all.

namespace traces {
namespace {

using sim::test::complaint;
using sim::test::Folder;
using test::same;
using test::tiny_scope;
using test::tiny_tile;

constexpr std::uint32_t kTiles = 5;
constexpr FrameRequirements kDemands{.tile_samples = 4,
                                     .wave_samples = 2,
                                     .attribute_bytes = 64,
                                     .pass_attribute_bytes = 48,
                                     .region_bytes = {4096, 512, 16}};

TileWork tile(std::uint32_t number) {
  TileWork work = tiny_tile();
  work.tile = number;
  return work;
}

void write(const std::filesystem::path& path) {
  TraceWriter trace(path, {{"program", "full:1"}});
  const TileScope scope = tiny_scope();
  Links other = scope.links;
  other.nodes[0] = {1, leaf_link(0, 1)};
  other.nodes[1] = {2, leaf_link(1, 1)};
  for (const std::uint32_t frame : {7U, 8U, 9U}) {
    trace.begin_part({.frame = frame}, frame == 9 ? other : scope.links, scope.counts, kDemands);
    if (frame != 9) {
      for (std::uint32_t t = 0; t < kTiles; ++t) trace.add_tile(tile(t + 100 * frame));
    }
    trace.end_part({{"rays", frame}});
    trace.end_frame({{"frame", frame}});
  }
  trace.commit();
}

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Reads everything in a trace.
void read_all(const std::filesystem::path& path) {
  const TraceReader trace(path);
  TraceReader::Cursor cursor(trace);
  TileWork work;
  for (const TraceReader::Part& part : trace.parts()) {
    const TileScope scope = trace.tile_scope(part, 5);
    for (const TraceReader::FileRange& range : trace.tiles(part)) {
      trace.add_file_name_to_errors([&] { cursor.read_tile(range, scope, work); });
    }
  }
}

TEST(TraceFile, ReturnsWideTreesWithTheirSlotsAndLeafRecords) {
  const Folder folder;
  const auto path = folder.path() / "wide.trace";
  Links wide;
  wide.slots = 6;
  wide.wide_nodes.assign(2, {kNoChild, kNoChild, kNoChild, kNoChild, kNoChild, kNoChild, kNoChild, kNoChild});
  wide.wide_nodes[0] = {leaf_link(0, 2), 1, leaf_link(2, 1), kNoChild, kNoChild, kNoChild, kNoChild, kNoChild};
  wide.wide_nodes[1][4] = leaf_link(3, 1);
  wide.wide_nodes[1][5] = leaf_link(4, 1);
  wide.begins_record = {true, false, true, true, true};
  const ImageCounts counts{.triangles = 5, .attributes = 5, .materials = 1, .textures = {}};
  {
    TraceWriter trace(path, {{"program", "full:1"}});
    trace.begin_part({}, wide, counts, kDemands);
    trace.end_part({{"rays", 1}});
    trace.commit();
  }
  const TraceReader trace(path);
  EXPECT_EQ(trace.file_version(), kTraceVersion);
  EXPECT_EQ(trace.tile_scope(trace.parts().at(0), 1).links, wide);
}

TEST(TraceFile, ReadsFilesOfVersion4) {
  const Folder folder;
  const auto path = folder.path() / "a.trace";
  write(path);
  std::string bytes = bytes_of(path);
  bytes[kTraceMagic.size() - 2] = '4';
  const auto former = folder.write("former.trace", bytes);
  EXPECT_EQ(TraceReader(former).file_version(), 4);
  read_all(former);
}

TEST(TraceFile, ReturnsItsPartsTreesAndTilesInAnyOrder) {
  const Folder folder;
  const auto path = folder.path() / "a.trace";
  write(path);
  const TraceReader trace(path);
  EXPECT_EQ(trace.header()["program"], "full:1");
  ASSERT_EQ(trace.parts().size(), 3U);
  EXPECT_EQ(trace.frames().size(), 3U);
  EXPECT_EQ(trace.tree_count(), 2U) << "the second part's tree is the first's";
  EXPECT_EQ(trace.parts()[1].tree, 0U);
  EXPECT_EQ(trace.parts()[2].tree, 1U);
  const TraceReader::Part& part = trace.parts()[1];
  EXPECT_EQ(part.frame, 8U);
  EXPECT_EQ(part.result["rays"], 8);
  EXPECT_EQ(part.requirements, kDemands);
  const TileScope scope = trace.tile_scope(part, 5);
  EXPECT_EQ(scope.links, tiny_scope().links);
  EXPECT_EQ(scope.counts, tiny_scope().counts);
  const auto ranges = trace.tiles(part);
  ASSERT_EQ(ranges.size(), kTiles);
  TraceReader::Cursor cursor(trace);
  TileWork work;
  for (const std::uint32_t t : {kTiles - 1, 0U, 2U, 2U}) {
    cursor.read_tile(ranges[t], scope, work);
    EXPECT_TRUE(same(work, tile(800 + t)));
  }
}

TEST(TraceFile, ATileThatRepeatsItselfIsPackedNoBetterThanMayBeRead) {
  const Folder folder;
  const auto path = folder.path() / "a.trace";
  TileWork work = tiny_tile();
  constexpr std::uint32_t kItems = kMaxSmallBlock;
  work.nodes = {{.kind = WorkNode::Kind::kLaunch, .items = kItems, .has_accesses = true, .inputs = {}}};
  work.accesses.assign(kItems, Access::attributes(6));
  work.access_begin.resize(kItems + 1);
  for (std::uint32_t item = 0; item <= kItems; ++item) work.access_begin[item] = item;
  work.imports.clear(), work.sources.clear(), work.walk.clear(), work.ray_begin.clear();
  const FrameRequirements demands{.tile_samples = kItems, .region_bytes = kDemands.region_bytes};
  {
    TraceWriter trace(path, {});
    trace.begin_part({}, tiny_scope().links, tiny_scope().counts, demands);
    trace.add_tile(work);
    trace.end_part({});
    trace.commit();
  }
  const TraceReader trace(path);
  const auto ranges = trace.tiles(trace.parts()[0]);
  EXPECT_GT(ranges[0].bytes, kMaxSmallBlock / kMaxPacking);
  EXPECT_LT(ranges[0].bytes, 2 * kMaxSmallBlock / kMaxPacking) << "and not much worse";
  TileWork back;
  TraceReader::Cursor(trace).read_tile(ranges[0], trace.tile_scope(trace.parts()[0], 5), back);
  EXPECT_TRUE(same(work, back));
}

TEST(TraceFile, ItemsThatTakeNoBytesAreNotTooMany) {
  const auto with_items = [](std::uint32_t items) {
    TileWork tile;
    tile.nodes = {{.items = items, .has_accesses = true, .inputs = {}}};
    tile.access_begin.assign(items + 1, 0);
    return test::complaint(tile, tiny_scope());
  };
  EXPECT_EQ(with_items(1U << 20), "no error");
  EXPECT_EQ(with_items(1U << 21), "has 2097152 items with accesses; allowed: 1048576, and 8 for each of its bytes");
}

TEST(TraceFile, DemandsOfOneWaveAndOnePassAreLeftOut) {
  const FrameRequirements plain{.tile_samples = 4, .attribute_bytes = 64, .region_bytes = {4096, 512, 16}};
  const Json json = to_json(plain);
  EXPECT_FALSE(json.contains("wave_samples"));
  EXPECT_FALSE(json.contains("pass_attribute_bytes"));
  EXPECT_EQ(requirements_of_json(json), plain);
}

TEST(TraceFile, EqualWorkMakesEqualBytes) {
  const Folder folder;
  write(folder.path() / "a.trace");
  write(folder.path() / "b.trace");
  EXPECT_EQ(bytes_of(folder.path() / "a.trace"), bytes_of(folder.path() / "b.trace"));
}

TEST(TraceFile, AppearsCompleteOrNotAtAll) {
  const Folder folder;
  const auto path = folder.path() / "a.trace";
  {
    TraceWriter trace(path, {});
    trace.begin_part({}, tiny_scope().links, tiny_scope().counts, kDemands);
    trace.add_tile(tiny_tile());
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  write(path);
  const std::string former = bytes_of(path);
  { const TraceWriter trace(path, {}); }
  EXPECT_EQ(bytes_of(path), former);
  write(path);  // over an existing trace
}

TEST(TraceFile, OtherFilesAreNeitherReplacedNorRead) {
  const Folder folder;
  const auto thesis = folder.write("thesis.txt", "three years");
  EXPECT_EQ(complaint<sim::InputError>(folder, [&] { TraceWriter(thesis, {}); }),
            "thesis.txt: is there and is no trace; allowed: a new file, or a trace to be replaced");
  EXPECT_EQ(bytes_of(thesis), "three years");
  const auto complaint_of = [&](const std::filesystem::path& path) {
    return complaint<sim::InputError>(folder, [&] { read_all(path); });
  };
  EXPECT_EQ(complaint_of(thesis), "thesis.txt: is no trace: too short");
  EXPECT_EQ(complaint_of(folder.write("long", std::string(100, 'x'))),
            "long: is no trace; raywatt trace record makes one");
  EXPECT_EQ(
      complaint_of(folder.write("former", "raywatt-trace/2\n" + std::string(100, 'x'))),
      "former: is a trace of another format, 'raywatt-trace/2'; this program reads 'raywatt-trace/5', and raywatt "
      "trace record makes one");
  EXPECT_EQ(complaint_of(folder.path() / "absent"), "absent: no such file");
  EXPECT_EQ(complaint_of(folder.path() / "."), ".: is a folder, not a file");
  EXPECT_EQ(complaint<sim::InputError>(folder, [&] { TraceWriter(folder.path() / "no" / "folder", {}); }),
            "no/folder: cannot be written: there is no folder no; make it first");
}

TEST(TraceFile, FilesThatAreNotRegularAreRefusedBeforeTheyAreOpened) {
  const Folder folder;
  const auto pipe = folder.path() / "f.trace";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_EQ(complaint<sim::InputError>(folder, [&] { TraceWriter(pipe, {}); }),
            "f.trace: is there and is not a regular file; allowed: a new file, or a trace to be replaced");
  EXPECT_TRUE(std::filesystem::is_fifo(pipe));
}

TEST(TraceFile, TwoWritersOfOneFileDoNotMixAndNoOtherFileIsTouched) {
  const Folder folder;
  const auto path = folder.path() / "a.trace", target = folder.write("target", "kept");
  const auto mine = folder.write("b.raywatt-tmp.trace", "mine");
  std::filesystem::create_symlink(target, folder.path() / "a.raywatt-tmp.trace");
  {
    TraceWriter other(path, {{"program", "other"}});
    write(path);
    other.commit();
  }
  EXPECT_EQ(TraceReader(path).header()["program"], "other");
  write(folder.path() / "b.trace");
  EXPECT_EQ(bytes_of(mine), "mine");
  EXPECT_EQ(bytes_of(target), "kept");
  EXPECT_TRUE(std::filesystem::is_symlink(folder.path() / "a.raywatt-tmp.trace"));
}

/// Returns a valid trace file with other contents.
std::string with_contents(const std::string& good, const std::string& contents) {
  const auto offset = load_unaligned<std::uint64_t>(good.data() + good.size() - kFooterBytes);
  Packer packer;
  const std::string_view packed = packer.pack_block(contents);
  std::string footer(12, '\0');
  const auto size = static_cast<std::uint32_t>(packed.size());
  std::memcpy(footer.data(), &offset, 8);
  std::memcpy(footer.data() + 8, &size, 4);
  return good.substr(0, offset) + std::string(packed) + footer + std::string(kTraceEnd);
}

TEST(TraceFile, APartHasNoMoreTilesThanTheFileHasRoomFor) {
  const Folder folder;
  write(folder.path() / "a.trace");
  const std::string good = bytes_of(folder.path() / "a.trace");
  const auto offset = load_unaligned<std::uint64_t>(good.data() + good.size() - kFooterBytes);
  const auto size = load_unaligned<std::uint32_t>(good.data() + good.size() - kFooterBytes + 8);
  Unpacker unpacker;
  Json contents =
      sim::parse_json(unpacker.unpack_block(std::string_view(good).substr(offset, size), kMaxContentsBytes));
  const auto says = [&](std::uint64_t tiles) {
    contents["parts"][0]["tiles"] = tiles;
    const auto path = folder.write("b.trace", with_contents(good, sim::json_line(contents)));
    return complaint<sim::InputError>(folder, [&] { const TraceReader trace(path); });
  };
  EXPECT_EQ(says(kTiles), "no error");
  EXPECT_EQ(says(good.size()), "b.trace: tiles is out of range");
}

TEST(TraceFile, EveryDamageIsFoundOrHarmless) {
  const Folder folder;
  const auto path = folder.path() / "a.trace";
  write(path);
  const std::string good = bytes_of(path);
  const auto damaged = folder.path() / "b.trace";
  const auto is_refused = [&](const std::string& bytes) {
    std::ofstream(damaged, std::ios::binary) << bytes;
    const std::string says = complaint<sim::InputError>(folder, [&] { read_all(damaged); });
    if (says == "no error") return false;
    EXPECT_TRUE(says.starts_with("b.trace: ")) << says;
    EXPECT_EQ(says.find('\n'), std::string::npos) << says;
    return true;
  };
  for (std::size_t size = 0; size < good.size(); size += 1 + size / 32) {
    EXPECT_TRUE(is_refused(good.substr(0, size))) << size;
  }
  std::size_t harmless = 0;
  for (std::size_t i = 0; i < good.size(); i += 5) {
    std::string bad = good;
    bad[i] = static_cast<char>(static_cast<unsigned char>(bad[i]) ^ (1U << (i % 8)));
    if (!is_refused(bad)) ++harmless;
  }
  // Only changes of bits that zstd does not use may remain unnoticed.
  EXPECT_LT(harmless, good.size() / 5 / 50 + 1);
}

}  // namespace
}  // namespace traces
