#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "sim/io/json.h"
#include "traces/trace_file/format.h"
#include "traces/trace_file/output_file.h"
#include "traces/trace_file/packing.h"

namespace traces {

/// Writes a trace: the header, then part by part the tiles in the order of their list. Nothing is at `path` until
/// commit(), and then all is.
///
///   TraceWriter trace(path, header);
///   trace.begin_part({.frame = 0}, links, counts, requirements);  for each tile: trace.add(work);
///   trace.end_part(result); trace.commit();
class TraceWriter {
 public:
  struct PartId {
    std::uint32_t frame = 0;
    bool reference = false;  ///< made by the program that others are compared with
  };

  /// InputError if there is something at `path` that is no trace, or if it cannot be written.
  TraceWriter(const std::filesystem::path& path, const Json& header);

  /// A tree that is as the part before had it is not written again.
  void begin_part(PartId id, Links links, const ImageCounts& counts, const FrameRequirements& requirements);
  void add(const TileWork& work);
  /// `result`: what else a report tells of this part.
  void end_part(Json result);
  /// Adds what a report tells of the frame beside its parts.
  void end_frame(Json frame) { contents_["frames"].push_back(std::move(frame)); }
  void commit();

 private:
  /// A block that most_held() allows; valid until the next one.
  std::string_view pack(std::string_view bytes);
  /// Appends a block; where it lies.
  Json put(std::string_view bytes);

  OutputFile file_;
  Packer packer_;
  TileEncoder encoder_;
  Json contents_;
  std::uint64_t contents_bytes_ = 0;  ///< bytes of its parts, as text
  // The present part's.
  Links links_;
  ImageCounts counts_;
  Json part_;
  std::uint64_t most_of_tile_ = 0;    ///< bytes
  std::vector<std::uint32_t> sizes_;  ///< sizes of its tiles
  std::string bytes_;
};

}  // namespace traces
