#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "shader_kernels/programs/wavefront/sampling.h"
#include "shader_kernels/programs/wavefront/tile_result.h"
#include "traces/stream.h"
#include "traces/tracer.h"

namespace kernels {

using traces::FrameRequirements;

/// Tiles of a picture.
struct TileCounts {
  std::uint32_t columns = 0, rows = 0;
};

/// A way to render a frame: a list of tiles, in one pass or more, each of which renders a part of the picture and
/// writes down the work that takes. A pass may look at all that earlier passes have found out.
class FrameProgram {
 public:
  FrameProgram(std::uint32_t width, std::uint32_t height)
      : width_(width), height_(height), picture_(std::size_t{3} * width * height) {}
  virtual ~FrameProgram() = default;
  FrameProgram(const FrameProgram&) = delete;
  FrameProgram& operator=(const FrameProgram&) = delete;

  std::uint32_t width() const { return width_; }
  std::uint32_t height() const { return height_; }
  /// Entries of the list, of all passes.
  virtual std::uint32_t tiles() const = 0;
  /// Tiles that the picture is cut into; none of a program that does not know.
  virtual TileCounts tile_counts() const { return {}; }
  /// First entry behind the pass that entry `tile_index` belongs to.
  virtual std::uint32_t pass_end([[maybe_unused]] std::uint32_t tile_index) const { return tiles(); }
  virtual FrameRequirements requirements() const = 0;

  /// Called once before the pass that begins with entry `tile_index`, when all earlier entries have been kept.
  virtual void begin_pass([[maybe_unused]] std::uint32_t tile_index, [[maybe_unused]] const traces::Tracer& tracer) {}
  /// Renders an entry of the list; with `record` also writes down its work. Any number of threads may run entries of a
  /// pass at once, each into its own `out`, whose storage is used again.
  virtual void run_tile(std::uint32_t tile_index, const traces::Tracer& tracer, bool record, TileResult& out) const = 0;
  /// Takes what an entry has found out. Called once for each, in the order of the list.
  virtual void commit_tile(const TileResult& tile);

  /// Linear RGB, row by row, as far as tiles have been kept.
  virtual const std::vector<float>& picture() const { return picture_; }
  /// When no more tiles of the frame come; the next tile begins a new picture.
  virtual std::vector<float> take_picture() { return std::move(picture_); }
  virtual const Sampling& sampling() const { return sampling_; }
  /// Has keep() keep marks too.
  virtual void keep_marks() { keeps_marks_ = true; }
  /// Marks of all samples, row by row, as many to a pixel as the program marks; empty if it marks none or they
  /// are not kept.
  virtual const std::vector<SampleMark>& marks() const { return marks_; }

 protected:
  std::vector<float>& kept_picture() { return picture_; }
  Sampling& kept_sampling() { return sampling_; }
  std::vector<SampleMark>& kept_marks() { return marks_; }
  bool wants_marks() const { return keeps_marks_; }

 private:
  void copy_marks(const TileResult& tile);

  const std::uint32_t width_, height_;
  std::vector<float> picture_;
  Sampling sampling_;
  bool keeps_marks_ = false;
  std::vector<SampleMark> marks_;
};

}  // namespace kernels
