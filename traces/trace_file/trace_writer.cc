#include "traces/trace_file/trace_writer.h"

#include <array>
#include <utility>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "traces/trace_file/bytes.h"

namespace traces {

namespace {

constexpr std::size_t kPiece = 1U << 20;

/// Opens a new file. Throws InputError if the path cannot be written; a disk that fills up later causes an IoError.
std::unique_ptr<sim::NewFile> open_trace_file(const std::filesystem::path& path) {
  try {
    return std::make_unique<sim::NewFile>(path);
  } catch (const sim::IoError& error) {
    throw sim::InputError(error.what());
  }
}

}  // namespace

OutputFile::OutputFile(const std::filesystem::path& path) : file_(open_trace_file(path)) {}

void OutputFile::write(std::string_view bytes) {
  held_.append(bytes);
  size_ += bytes.size();
  if (held_.size() >= kPiece) flush();
}

void OutputFile::flush() {
  file_->write(held_);
  held_.clear();
}

void OutputFile::commit() {
  flush();
  file_->commit();
}

namespace {

/// Returns `path`. Throws InputError if the file exists and is not a trace, because it would be overwritten by mistake.
const std::filesystem::path& check_replaceable(const std::filesystem::path& path) {
  sim::check_output(path, {.mark = kTraceKind, .kind = "trace"});
  return path;
}

template <class T>
void append_bytes(T number, std::string& out) {
  std::array<char, sizeof number> bytes{};
  std::memcpy(bytes.data(), &number, bytes.size());
  out.append(bytes.data(), bytes.size());
}

}  // namespace

TraceWriter::TraceWriter(const std::filesystem::path& path, const Json& header) : file_(check_replaceable(path)) {
  contents_ = {{"trees", Json::array()}, {"parts", Json::array()}, {"frames", Json::array()}};
  const std::string_view packed = pack_within_limits(sim::json_line(header));
  std::string size;
  append_bytes(static_cast<std::uint32_t>(packed.size()), size);
  file_.write(kTraceMagic);
  file_.write(size);
  file_.write(packed);
}

std::string_view TraceWriter::pack_within_limits(std::string_view bytes) {
  const std::string_view packed = packer_.pack_block(bytes);
  return bytes.size() <= most_unpacked_bytes(packed.size()) ? packed
                                                            : packer_.pack_with_limited_ratio(bytes, kMaxPacking);
}

Json TraceWriter::append_block(std::string_view bytes) {
  const std::string_view packed = pack_within_limits(bytes);
  const Json range = {{"offset", file_.size()}, {"bytes", packed.size()}};
  file_.write(packed);
  return range;
}

void TraceWriter::begin_part(PartId id, Links links, const ImageCounts& counts, const FrameRequirements& requirements) {
  Json& trees = contents_["trees"];
  if (trees.empty() || links != links_ || counts != counts_) {
    links_ = std::move(links);
    counts_ = counts;
    Json tree = append_block(encode_child_links(links_));
    tree["nodes"] = links_.node_count();
    if (links_.is_wide()) tree["slots"] = links_.slots;
    if (!links_.begins_record.empty()) tree["leaf_records"] = append_block(encode_records(links_.begins_record));
    tree["counts"] = to_json(counts);
    trees.push_back(std::move(tree));
  }
  sizes_.clear();
  most_of_tile_ = most_tile_bytes(requirements);
  part_ = {{"frame", id.frame},
           {"program", id.pilot       ? "pilot"
                       : id.reference ? "reference"
                                      : "program"},
           {"tree", trees.size() - 1},
           {"demands", to_json(requirements)},
           {"offset", file_.size()}};
}

void TraceWriter::add_tile(const TileWork& work) {
  bytes_.clear();
  encoder_.encode_tile(work, links_, bytes_);
  if (bytes_.size() > most_of_tile_) {
    throw sim::InputError(
        fmt::format("render.tile: a tile's work takes {} MiB and cannot be recorded; allowed: {} MiB, with a smaller "
                    "tile, depth or number of lights",
                    bytes_.size() >> 20, most_of_tile_ >> 20));
  }
  const std::string_view packed = pack_within_limits(bytes_);
  file_.write(packed);
  sizes_.push_back(static_cast<std::uint32_t>(packed.size()));
}

void TraceWriter::end_part(Json result) {
  std::string sizes;
  for (const std::uint32_t size : sizes_) append_bytes(size, sizes);
  part_["tiles"] = sizes_.size();
  part_["sizes"] = append_block(sizes);
  part_["result"] = std::move(result);
  contents_bytes_ += sim::json_line(part_).size();
  if (contents_bytes_ > kMaxContentsBytes) {
    throw sim::InputError(
        fmt::format("results of frames take more than {} MiB and cannot be recorded; allowed: fewer --frames",
                    kMaxContentsBytes >> 20));
  }
  contents_["parts"].push_back(std::move(part_));
}

void TraceWriter::commit() {
  const Json range = append_block(sim::json_line(contents_));
  std::string footer;
  append_bytes(range["offset"].get<std::uint64_t>(), footer);
  append_bytes(range["bytes"].get<std::uint32_t>(), footer);
  file_.write(footer.append(kTraceEnd));
  file_.commit();
}

}  // namespace traces
