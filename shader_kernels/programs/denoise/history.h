#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include <glm/vec3.hpp>

#include "shader_kernels/kernels/denoise.h"
#include "shader_kernels/programs/denoise/denoise_config.h"
#include "traces/accel/memory_image.h"

namespace kernels {

/// Bytes of a pixel's records in the denoiser's memory.
struct DenoiseRecordBytes {
  explicit DenoiseRecordBytes(HistoryPrecision precision)
      : light(precision == HistoryPrecision::kHalf ? 8 : 16), moments(precision == HistoryPrecision::kHalf ? 4 : 8) {}
  std::uint32_t light, moments;
  std::uint32_t guide = 8, motion = 4, albedo = 4;
  std::uint32_t history() const { return light + guide + moments; }
  /// Returns the bytes that a tile of the program writes for each pixel.
  std::uint32_t block() const { return light + guide + motion + albedo; }
};

/// Start of the denoiser's arrays within region kSamples, in bytes.
struct DenoiseLayout {
  /// Arrays of a pixel's history, row by row.
  struct History {
    std::uint64_t light = 0, guides = 0, moments = 0;
  };
  std::uint64_t blocks = 0;            ///< per tile: light, guides, motions, albedos of its pixels
  std::array<History, 2> histories{};  ///< of even and odd frames
  std::array<std::uint64_t, 2> light{};
  std::uint64_t past_vertices = 0, end = 0;

  /// `tiles` tiles have `tile_pixels` pixels each; `past_triangles` triangles have moved.
  DenoiseLayout(const DenoiseRecordBytes& bytes, std::uint64_t pixels, std::uint64_t tiles, std::uint64_t tile_pixels,
                std::uint64_t past_triangles);
};

/// What the denoiser keeps of a frame for the next one: its memory, camera and triangles.
struct DenoiseHistory {
  std::shared_ptr<const std::vector<std::uint32_t>> memory;  ///< contents of region kSamples
  std::uint32_t parity = 0;  ///< entry of DenoiseLayout::histories that the frame has written
  ProjectionUniforms<float> projection{};
  std::vector<glm::vec3> vertices;  ///< corners of all triangles by TriangleRecord::source, or with instances by index
  std::vector<traces::InstanceRecord> instances;
};

/// Returns the corners of an image's triangles as DenoiseHistory::vertices.
std::vector<glm::vec3> vertices_of(const traces::MemoryImage& image);

/// True if a triangle of the image has moved since the frame of `history`. Throws InputError if instances have moved.
bool has_moved_since(const DenoiseHistory& history, const traces::MemoryImage& image);

}  // namespace kernels
