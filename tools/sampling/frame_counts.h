#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "shader_kernels/programs/program_spec.h"
#include "tools/run/frame/run_job.h"
#include "traces/accel/memory_image.h"
#include "traces/stream.h"

namespace tools {

/// Counts of a frame's work that do not depend on the machine. They predict the frame's cost.
struct FrameCounts {
  double primary = 0, shadow = 0, reflection = 0, refraction = 0;  ///< rays
  double visits = 0;                                               ///< node visits
  double tests = 0;                                                ///< triangle tests
  double operations = 0;                                           ///< operations of all launches of kernels
  double tree_lines = 0;           ///< distinct cache lines of nodes and triangles that the frame reads
  double data_lines = 0;           ///< distinct cache lines of attributes, materials and textures that the frame reads
  double tile_lines = 0;           ///< distinct cache lines that a tile reads, summed over tiles
  double longest = 0;              ///< node visits and triangle tests of a tile's longest ray, summed over tiles
  double built = 0, refitted = 0;  ///< triangles and instances of the trees that the machine builds and refits

  static constexpr std::array<double FrameCounts::*, 13> kAll = {
      &FrameCounts::primary,    &FrameCounts::shadow,     &FrameCounts::reflection, &FrameCounts::refraction,
      &FrameCounts::visits,     &FrameCounts::tests,      &FrameCounts::operations, &FrameCounts::tree_lines,
      &FrameCounts::data_lines, &FrameCounts::tile_lines, &FrameCounts::longest,    &FrameCounts::built,
      &FrameCounts::refitted};
  friend bool operator==(const FrameCounts&, const FrameCounts&) = default;
};

/// Counts the work of frames, tile by tile.
class FrameCounter {
 public:
  FrameCounter();
  /// Starts to count a new frame. `layout`: addresses of the arrays in its memory image.
  void begin_frame(const traces::Layout& layout);
  void add_tile(const traces::TileWork& work);
  const FrameCounts& counts() const { return counts_; }

 private:
  /// Marks a line as read. Adds 1 to `distinct` for the frame's first read, and to tile_lines for the tile's.
  void read_line(hw::Addr line, double& distinct);

  std::vector<double> operations_;     ///< operations of an item of each kernel
  std::vector<std::uint32_t> stamps_;  ///< for each line of memory, the number of the last tile that has read it
  std::uint32_t tile_ = 0;             ///< number of the current tile over all frames, from 1
  std::uint32_t frame_begin_ = 1;      ///< number of the frame's first tile
  std::vector<std::uint32_t> steps_;   ///< steps of each ray of the tile
  const traces::Layout* layout_ = nullptr;
  FrameCounts counts_;
};

/// Counts the work of every frame of a sequence in pictures with few samples. Of a long sequence, moving geometry is
/// updated in some frames only, so that counts are approximate. Leaves `inputs` in the state of the
/// first frame. Throws Interrupted.
std::vector<FrameCounts> count_frames(Inputs& inputs, const kernels::ProgramSpec& spec, std::uint32_t threads,
                                      Progress* progress);

}  // namespace tools
