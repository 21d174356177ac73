#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "sim/io/file.h"
#include "sim/io/json.h"
#include "traces/trace_file/format.h"
#include "traces/trace_file/packing.h"

namespace traces {

/// A new file with a buffer that collects small writes.
class OutputFile {
 public:
  /// Throws InputError if the file cannot be created.
  explicit OutputFile(const std::filesystem::path& path);

  /// Appends bytes to the file. Throws IoError, possibly because an earlier write failed.
  void write(std::string_view bytes);
  std::uint64_t size() const { return size_; }
  void commit();

 private:
  void flush();

  std::unique_ptr<sim::NewFile> file_;
  std::string held_;
  std::uint64_t size_ = 0;
};

/// Writes a trace: the header, then each part with its tiles in list order. The complete file appears at `path` on
/// commit().
///
///   TraceWriter trace(path, header);
///   trace.begin_part({.frame = 0}, links, counts, requirements);  for each tile: trace.add_tile(work);
///   trace.end_part(result); trace.commit();
class TraceWriter {
 public:
  struct PartId {
    std::uint32_t frame = 0;
    bool reference = false;  ///< the part was rendered by the reference program
    bool pilot = false;      ///< the part is the thin picture by which tiles are sampled
  };

  /// Throws InputError if `path` cannot be written or is an existing file that is not a trace.
  TraceWriter(const std::filesystem::path& path, const Json& header);

  /// Begins a part of the trace. A BVH equal to that of the previous part is not stored again.
  void begin_part(PartId id, Links links, const ImageCounts& counts, const FrameRequirements& requirements);
  void add_tile(const TileWork& work);
  /// Ends the current part of the trace. `result`: report data of the part, as JSON.
  void end_part(Json result);
  /// Adds report data that belong to a whole frame and not to one of its parts.
  void end_frame(Json frame) { contents_["frames"].push_back(std::move(frame)); }
  void commit();

 private:
  /// Packs a block so that its unpacked size is within most_unpacked_bytes(). The result is valid until the next call.
  std::string_view pack_within_limits(std::string_view bytes);
  /// Appends a packed block to the file. Returns its offset and size as JSON.
  Json append_block(std::string_view bytes);

  OutputFile file_;
  Packer packer_;
  TileEncoder encoder_;
  Json contents_;
  std::uint64_t contents_bytes_ = 0;  ///< bytes of the JSON text of all parts
  // State of the part that is being written.
  Links links_;
  ImageCounts counts_;
  Json part_;
  std::uint64_t most_of_tile_ = 0;    ///< largest encoded size of a tile in this part
  std::vector<std::uint32_t> sizes_;  ///< packed sizes of the part's tiles
  std::string bytes_;
};

}  // namespace traces
