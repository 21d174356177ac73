#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "tools/run/frame/run_job.h"

namespace tools::test {

/// Returns the inputs of a small picture of the scene cornell.
inline Inputs small_inputs(const std::vector<std::string>& sets = {}, const std::string& resolution = "48x24",
                           const std::string& scene = "cornell") {
  JobOptions options;
  options.resolution = resolution;
  options.scene = scene;
  options.sets = sets;
  return load_inputs(options);
}

/// Simulates a frame with statistics for each tile and pixel.
inline FrameResult itemised(const Inputs& inputs, const char* program = "full:1", std::uint32_t threads = 1) {
  return simulate_frame(inputs, kernels::parse_program(program), threads, {.itemised = true});
}

}  // namespace tools::test
