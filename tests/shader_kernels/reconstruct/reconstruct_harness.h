#pragma once
#include <vector>

#include "shader_kernels/programs/adaptive/reconstruct.h"
#include "tests/shader_kernels/block_harness.h"

namespace kernels {

inline Sampled reconstruct(const Stage& stage, const RenderConfig& render, const ReconstructConfig& config = {},
                           ReconstructProgram::Filters filters = ReconstructProgram::Filters::kApart,
                           const traces::Tracer* tracer = nullptr, bool record = false) {
  ReconstructProgram program(stage.image, stage.camera, render, config, filters, stage.size(), 0);
  program.enable_marks();
  return run_program(program, tracer != nullptr ? *tracer : stage.tracer, 1, record);
}

inline double squared_error(const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sum;
}

}  // namespace kernels
