#include "traces/trace_file/trace_reader.h"

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "traces/trace_file/bytes.h"
#include "traces/walk.h"

namespace traces {

TraceReader::TraceReader(std::filesystem::path path) : path_(std::move(path)) {
  file_ = ::open(path_.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (file_ < 0) throw_error(errno == ENOENT ? "no such file" : std::generic_category().message(errno));
  struct stat status {};
  if (::fstat(file_, &status) != 0 || !S_ISREG(status.st_mode)) {
    ::close(file_);
    throw_error(S_ISDIR(status.st_mode) ? "is a folder, not a file" : "is not a regular file");
  }
  size_ = static_cast<std::uint64_t>(status.st_size);
  try {
    add_file_name_to_errors([&] {
      read_header();
      read_table_of_contents();
    });
  } catch (...) {
    ::close(file_);
    throw;
  }
}

TraceReader::~TraceReader() { ::close(file_); }

std::string TraceReader::damage_text(const sim::JsonError& error) {
  const std::string what = error.what();
  const std::size_t begin = what.find('\''), end = what.rfind('\'');
  if (error.kind == sim::JsonError::Kind::kKey && begin < end)
    return "has no key " + what.substr(begin, end - begin + 1);
  if (error.kind == sim::JsonError::Kind::kSyntax) return "is damaged: a block holds no JSON";
  if (error.kind == sim::JsonError::Kind::kType) return "is damaged: a value is of a wrong kind";
  return "is damaged: a list is too short";
}

void TraceReader::throw_error(const std::string& what) const {
  throw sim::InputError(fmt::format("{}: {}", sim::printable(path_.string()), sim::printable(what)));
}

void TraceReader::read_at(const FileRange& range, std::string& out) const {
  out.resize(range.bytes);
  std::size_t done = 0;
  while (done < range.bytes) {
    const ssize_t got = ::pread(file_, out.data() + done, range.bytes - done, static_cast<off_t>(range.offset + done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) {
      throw sim::IoError(fmt::format("{}: cannot be read: {}", sim::printable(path_.string()),
                                     std::generic_category().message(errno)));
    }
    if (got == 0) throw sim::InputError("ends early");
    done += static_cast<std::size_t>(got);
  }
}

std::string TraceReader::read_block(const FileRange& range, std::uint64_t most) const {
  std::string packed;
  read_at(range, packed);
  return std::string(Unpacker().unpack_block(packed, std::min(most, most_unpacked_bytes(packed.size()))));
}

TraceReader::FileRange TraceReader::range_of(const Json& json) const {
  const std::uint64_t offset = number_at(json, "offset", size_);
  return {offset, number_at(json, "bytes", size_ - offset)};
}

void TraceReader::read_header() {
  std::string start;
  if (size_ < kTraceMagic.size() + 4) throw sim::InputError("is no trace: too short");
  read_at({0, kTraceMagic.size() + 4}, start);
  if (!start.starts_with(kTraceKind)) throw sim::InputError("is no trace; raywatt trace record makes one");
  const auto former =
      std::ranges::find_if(kFormerMagics, [&](const auto& magic) { return start.starts_with(magic.first); });
  if (!start.starts_with(kTraceMagic) && former == kFormerMagics.end()) {
    throw sim::InputError(
        fmt::format("is a trace of another format, '{}'; this program reads '{}', and "
                    "raywatt trace record makes one",
                    sim::printable(start.substr(0, start.find('\n'))), kTraceMagic.substr(0, kTraceMagic.size() - 1)));
  }
  version_ = former == kFormerMagics.end() ? kTraceVersion : former->second;
  const FileRange range{start.size(), load_unaligned<std::uint32_t>(start.data() + kTraceMagic.size())};
  if (range.bytes > size_ - range.offset) throw sim::InputError("ends early");
  header_ = sim::parse_json(read_block(range, kMaxHeaderBytes));
}

void TraceReader::read_table_of_contents() {
  if (size_ < kTraceMagic.size() + 4 + kFooterBytes) throw sim::InputError("ends early");
  std::string footer;
  read_at({size_ - kFooterBytes, kFooterBytes}, footer);
  if (!footer.ends_with(kTraceEnd)) throw sim::InputError("ends early, or with something other than a footer");
  const FileRange range{load_unaligned<std::uint64_t>(footer.data()), load_unaligned<std::uint32_t>(footer.data() + 8)};
  if (range.offset > size_ || range.bytes > size_ - range.offset) throw sim::InputError("footer is damaged");
  Json contents = sim::parse_json(read_block(range, kMaxContentsBytes));
  for (const Json& tree : contents.at("trees")) {
    trees_.push_back({range_of(tree), number_at(tree, "nodes", kMaxNodes), counts_of_json(tree.at("counts"))});
    Tree& read = trees_.back();
    if (tree.contains("slots")) {
      read.slots = static_cast<std::uint32_t>(number_at(tree, "slots", kMaxWidth));
      if (read.slots == 0 || read.slots % 2 != 0) throw sim::InputError("tree: number of slots; allowed: 2, 4, 6, 8");
    }
    if (tree.contains("leaf_records")) read.leaf_records = range_of(tree.at("leaf_records"));
  }
  for (Json& json : contents.at("parts")) {
    Part part;
    part.frame = static_cast<std::uint32_t>(number_at(json, "frame", kMaxFrame));
    part.reference = json.at("program").get<std::string>() == "reference";
    part.pilot = json.at("program").get<std::string>() == "pilot";
    if (trees_.empty()) throw sim::InputError("has no tree");
    part.tree = number_at(json, "tree", trees_.size() - 1);
    part.requirements = requirements_of_json(json.at("demands"));
    part.tiles = static_cast<std::uint32_t>(
        number_at(json, "tiles", std::min<std::uint64_t>(kMaxPartTiles, size_ / kLeastPacked)));
    part.sizes = range_of(json.at("sizes"));
    part.tiles_at = number_at(json, "offset", size_);
    part.result = std::move(json.at("result"));
    parts_.push_back(std::move(part));
  }
  frames_ = std::move(contents.at("frames"));
}

TileScope TraceReader::tile_scope(const Part& part, std::uint32_t kernels) const {
  const Tree& tree = trees_[part.tree];
  return add_file_name_to_errors([&]() -> TileScope {
    Links links = decode_child_links(read_block(tree.range, kMaxTreeBytes), tree.nodes, tree.counts, tree.slots);
    if (tree.leaf_records) {
      links.begins_record = decode_records(read_block(*tree.leaf_records, kMaxTreeBytes), tree.counts.triangles);
    }
    return {std::move(links),
            tree.counts,
            kernels,
            part.requirements.region_bytes,
            part.requirements.raster,
            part.requirements.build,
            most_tile_bytes(part.requirements)};
  });
}

std::vector<TraceReader::FileRange> TraceReader::tiles(const Part& part) const {
  return add_file_name_to_errors([&] {
    const std::string sizes = read_block(part.sizes, std::uint64_t{4} * part.tiles);
    if (sizes.size() != std::uint64_t{4} * part.tiles) throw sim::InputError("sizes of tiles are damaged");
    std::vector<FileRange> ranges(part.tiles);
    std::uint64_t at = part.tiles_at;
    for (std::size_t i = 0; i < ranges.size(); ++i) {
      ranges[i] = {at, load_unaligned<std::uint32_t>(sizes.data() + 4 * i)};
      if (at > size_ || ranges[i].bytes > size_ - at) throw sim::InputError("ends early");
      at += ranges[i].bytes;
    }
    return ranges;
  });
}

TileRays TraceReader::Cursor::read_tile(const FileRange& tile, const TileScope& scope, TileWork& work) {
  trace_.read_at(tile, block_);
  const std::uint64_t most = std::min(scope.tile_bytes, most_unpacked_bytes(block_.size()));
  return decoder_.decode_tile(unpacker_.unpack_block(block_, most), scope, work);
}

}  // namespace traces
