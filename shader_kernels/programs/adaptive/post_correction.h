#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "shader_kernels/programs/adaptive/adaptive_config.h"
#include "shader_kernels/programs/adaptive/sample_tiles.h"
#include "shader_kernels/programs/wavefront/sampling.h"
#include "shader_kernels/programs/wavefront/tile_result.h"

namespace kernels {

/// Post-correction of an undersampled frame (Kim et al. 2016, section 4): what all samples show, and the scans that
/// follow it from traced samples into interpolated ones.
///
/// A scan goes along all lines of the picture at once, sample by sample. A sample that is interpolated, beside one
/// behind it that is traced and shows something else, is a suspect and traced; it may then make the next one suspect.
class PostCorrection {
 public:
  /// A way along lines.
  struct Scan {
    bool is_along_y = false, is_backward = false;
  };
  /// A sample to be traced.
  struct Suspect {
    std::uint32_t tile = 0;
    std::uint32_t round = 0;  ///< length of the chain of suspects that led to it
    std::uint32_t x = 0, y = 0;
  };
  /// Findings of tracing at suspects, in their order.
  struct Found {
    std::vector<std::uint32_t> identities;
    std::vector<glm::vec3> colours;  ///< clamped
  };

  PostCorrection(const UndersampleConfig& config, std::uint32_t width, std::uint32_t height, std::uint32_t tile_side);

  std::uint32_t scans() const;
  /// The paper's order: to the right, to the left, downwards, upwards; of two scans to the right and downwards.
  Scan scan(std::uint32_t number) const { return {2 * number >= scans(), scans() == 4 && number % 2 == 1}; }

  /// Takes a tile's samples.
  void keep(const TileResult& tile, const SampleTile& at);
  /// Goes over the picture; `trace(suspects)` says what is there. Returns the suspects by tile, then round.
  template <class Trace>
  const std::vector<Suspect>& run(const Scan& scan, Trace&& trace) {
    begin();
    for (std::uint32_t step = 1; step < (scan.is_along_y ? height_ : width_); ++step) {
      find(scan, step);
      if (!fresh_.empty()) settle(trace(std::span<const Suspect>(fresh_)));
    }
    end();
    return all_;
  }
  /// Those of the last scan in a tile.
  std::span<const Suspect> suspects_of(std::uint32_t tile) const;

  glm::vec3 colour(std::uint32_t x, std::uint32_t y) const { return colours_[std::size_t{y} * width_ + x]; }

 private:
  std::uint32_t index_of(std::uint32_t x, std::uint32_t y) const { return (y + 1) * (width_ + 2) + x + 1; }
  void begin();
  void find(const Scan& scan, std::uint32_t step);
  void settle(const Found& found);
  void end();

  const UndersampleConfig config_;
  const std::uint32_t width_, height_, side_, across_;
  std::vector<std::uint32_t> identities_;  ///< with a border of samples that show nothing
  std::vector<std::uint16_t> rounds_;      ///< likewise: of this scan's suspects
  std::vector<glm::vec3> colours_;
  std::vector<std::uint32_t> line_, found_;
  std::vector<Suspect> fresh_, all_;
};

}  // namespace kernels
