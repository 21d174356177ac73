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

/// Post-correction of an undersampled frame (Kim et al. 2016, section 4): the identities of all samples, and the scans
/// that correct interpolated samples next to traced ones.
///
/// 1. A scan advances along all lines of the picture at once, sample by sample.
/// 2. An interpolated sample is suspect if its predecessor was traced and has another identity.
/// 3. Suspects are traced, so that a suspect may make the next sample suspect.
class PostCorrection {
 public:
  /// Direction of a scan.
  struct Scan {
    bool is_along_y = false, is_backward = false;
  };
  /// A sample to trace.
  struct Suspect {
    std::uint32_t tile = 0;
    std::uint32_t round = 0;  ///< length of the chain of suspects that led to it
    std::uint32_t x = 0, y = 0;
  };
  /// Results of traced suspects, in their order.
  struct Found {
    std::vector<std::uint32_t> identities;
    std::vector<glm::vec3> colours;  ///< clamped
  };

  PostCorrection(const UndersampleConfig& config, std::uint32_t width, std::uint32_t height, std::uint32_t tile_side);

  std::uint32_t scans() const;
  /// Returns a scan's direction in the paper's order: right, left, down, up; with two scans right, down.
  Scan scan(std::uint32_t number) const { return {2 * number >= scans(), scans() == 4 && number % 2 == 1}; }

  /// Stores a tile's samples.
  void keep(const TileResult& tile, const SampleTile& at);
  /// Runs a scan over the picture. `trace(suspects)` returns their results. Returns all suspects, by tile, then round.
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
  /// Returns the last scan's suspects in a tile.
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
  std::vector<std::uint32_t> identities_;  ///< with a border of samples without identity
  std::vector<std::uint16_t> rounds_;      ///< rounds of this scan's suspects, with the same border
  std::vector<glm::vec3> colours_;
  std::vector<std::uint32_t> line_, found_;
  std::vector<Suspect> fresh_, all_;
};

}  // namespace kernels
