#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sim/io/json.h"
#include "traces/trace_file/format.h"
#include "traces/trace_file/packing.h"

namespace traces {

/// Reads a trace. The file is not trusted: every function returns valid data or throws an InputError of one line that
/// names the file. Throws IoError if reading fails.
class TraceReader {
 public:
  struct FileRange {
    std::uint64_t offset = 0, bytes = 0;
  };
  /// A part of a trace: one frame, rendered by one frame program.
  struct Part {
    std::uint32_t frame = 0;
    bool reference = false;
    bool pilot = false;  ///< thin picture by which tiles are sampled
    std::size_t tree = 0;
    FrameRequirements requirements;
    std::uint32_t tiles = 0;
    std::uint64_t tiles_at = 0;  ///< file offset of the part's first tile; its other tiles follow
    FileRange sizes;
    Json result;
  };

  explicit TraceReader(std::filesystem::path path);
  ~TraceReader();
  TraceReader(const TraceReader&) = delete;
  TraceReader& operator=(const TraceReader&) = delete;

  int file_version() const { return version_; }
  const Json& header() const { return header_; }
  const std::vector<Part>& parts() const { return parts_; }
  const Json& frames() const { return frames_; }
  std::uint64_t file_bytes() const { return size_; }
  std::size_t tree_count() const { return trees_.size(); }

  /// Returns the limits for tiles of a part of the trace. `kernels` is the number of kernels that exist.
  TileScope tile_scope(const Part& part, std::uint32_t kernels) const;
  /// Returns where in the trace file each tile of a part is.
  std::vector<FileRange> tiles(const Part& part) const;

  /// Reads single tiles of a trace. Several cursors may be in use at the same time.
  class Cursor {
   public:
    explicit Cursor(const TraceReader& trace) : trace_(trace) {}
    TileRays read_tile(const FileRange& tile, const TileScope& scope, TileWork& work);

   private:
    const TraceReader& trace_;
    std::string block_;
    Unpacker unpacker_;
    TileDecoder decoder_;
  };

  /// Calls `f`. Errors that `f` throws are prefixed with the name of the trace file.
  template <class F>
  decltype(auto) add_file_name_to_errors(F&& f) const {
    try {
      return f();
    } catch (const sim::InputError& error) {
      throw_error(error.what());
    } catch (const sim::JsonError& error) {
      throw_error(damage_text(error));
    }
  }

 private:
  struct Tree {
    FileRange range;
    std::uint64_t nodes = 0;
    ImageCounts counts;
    std::uint32_t slots = 0;                  ///< slots of a node of a wide tree; 0 for a binary tree
    std::optional<FileRange> leaf_records{};  ///< where records of several triangles begin
  };
  static std::string damage_text(const sim::JsonError& error);
  [[noreturn]] void throw_error(const std::string& what) const;
  void read_at(const FileRange& range, std::string& out) const;
  /// Reads a block from the trace file and unpacks it to at most `most` bytes.
  std::string read_block(const FileRange& range, std::uint64_t most) const;
  FileRange range_of(const Json& json) const;
  void read_header();
  void read_table_of_contents();

  const std::filesystem::path path_;
  int file_ = -1, version_ = kTraceVersion;
  std::uint64_t size_ = 0;
  Json header_, frames_;
  std::vector<Tree> trees_;
  std::vector<Part> parts_;
};

}  // namespace traces
