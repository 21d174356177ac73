#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "shader_kernels/programs/wavefront/sampling.h"
#include "shader_kernels/programs/wavefront/tile_result.h"
#include "traces/ray.h"
#include "traces/stream.h"

namespace kernels {

using traces::FrameRequirements;
struct DenoiseHistory;  // programs/denoise/history.h

/// Number of tiles of a picture, across and down.
struct TileGridSize {
  std::uint32_t columns = 0, rows = 0;
};

/// Interface of a frame program, which renders a list of entries in one or more passes and records the work. Most
/// entries are one tile of the picture. A pass may read the results of all earlier passes.
class FrameProgram {
 public:
  FrameProgram(std::uint32_t width, std::uint32_t height)
      : width_(width), height_(height), picture_(std::size_t{3} * width * height) {}
  virtual ~FrameProgram() = default;
  FrameProgram(const FrameProgram&) = delete;
  FrameProgram& operator=(const FrameProgram&) = delete;

  std::uint32_t width() const { return width_; }
  std::uint32_t height() const { return height_; }
  /// Returns the number of entries in all passes of the frame. Most entries are tiles; those of a geometry pass are
  /// batches of triangles.
  virtual std::uint32_t tiles() const = 0;
  /// Returns the number of tiles of the picture, across and down. Returns 0 if the program's entries are not tiles of
  /// one grid.
  virtual TileGridSize tile_grid_size() const { return {}; }
  /// Returns the index after the last entry of the rendering pass that contains entry `tile_index`.
  virtual std::uint32_t pass_end([[maybe_unused]] std::uint32_t tile_index) const { return tiles(); }
  virtual FrameRequirements requirements() const = 0;

  /// Prepares the rendering pass that begins with entry `tile_index`. Called after all earlier entries have been
  /// committed.
  virtual void begin_pass([[maybe_unused]] std::uint32_t tile_index, [[maybe_unused]] const traces::Tracer& tracer) {}
  /// Renders an entry, mostly a tile, into `out`. Records its work if `record` is set. Entries of a pass may run on any
  /// number of threads, each with its own `out`, whose storage is reused.
  virtual void run_tile(std::uint32_t tile_index, const traces::Tracer& tracer, bool record, TileResult& out) const = 0;
  /// Adds the results of a rendered entry to the frame. Called once per entry, in list order.
  virtual void commit_tile(const TileResult& tile);

  /// Returns the picture with all entries committed so far: linear RGB, row by row.
  virtual const std::vector<float>& picture() const { return picture_; }
  /// Moves the picture out after the last tile of a frame. The next tile begins a new picture.
  virtual std::vector<float> move_picture_out() { return std::move(picture_); }
  virtual const Sampling& sampling() const { return sampling_; }
  /// Returns what the denoiser of the next frame needs of this one, after the last tile; null without a denoiser.
  virtual std::shared_ptr<const DenoiseHistory> make_history() const { return nullptr; }
  /// Makes commit_tile() store the debug marks of samples.
  virtual void enable_marks() { keeps_marks_ = true; }
  /// Returns the debug marks of all samples of the frame, row by row. Empty if the program makes no marks or does not
  /// store them.
  virtual const std::vector<SampleMark>& sample_marks() const { return marks_; }

 protected:
  std::vector<float>& mutable_picture() { return picture_; }
  Sampling& mutable_sampling() { return sampling_; }
  std::vector<SampleMark>& mutable_marks() { return marks_; }
  bool stores_marks() const { return keeps_marks_; }

 private:
  void copy_marks(const TileResult& tile);

  const std::uint32_t width_, height_;
  std::vector<float> picture_;
  Sampling sampling_;
  bool keeps_marks_ = false;
  std::vector<SampleMark> marks_;
};

}  // namespace kernels
