#include "shader_kernels/programs/programs.h"

#include <cmath>

#include "shader_kernels/programs/adaptive/multirate.h"
#include "shader_kernels/programs/adaptive/supersample.h"
#include "shader_kernels/programs/adaptive/undersample.h"
#include "shader_kernels/programs/full.h"
#include "shader_kernels/programs/reconstruct/reconstruct.h"

namespace kernels {

std::unique_ptr<FrameProgram> make_program(const ProgramSpec& spec, const Frame& f) {
  switch (spec.kind) {
    case ProgramSpec::Kind::kMultirate:
      return std::make_unique<MultirateProgram>(f.image, f.camera, f.render, f.programs.multirate,
                                                spec.samples == 1 ? 1 : 2, f.rates, f.number);
    case ProgramSpec::Kind::kSupersample:
      return std::make_unique<SupersampleProgram>(f.image, f.camera, f.render, f.programs.supersample, f.number);
    case ProgramSpec::Kind::kUndersample:
      return std::make_unique<UndersampleProgram>(f.image, f.camera, f.render, f.programs.undersample, f.scene_size,
                                                  f.number);
    case ProgramSpec::Kind::kReconstruct:
    case ProgramSpec::Kind::kSraa: {
      using Filters = ReconstructProgram::Filters;
      const Filters filters = spec.kind == ProgramSpec::Kind::kSraa ? Filters::kOne : Filters::kApart;
      return std::make_unique<ReconstructProgram>(f.image, f.camera, f.render, f.programs.reconstruct, filters,
                                                  f.scene_size, f.number);
    }
    case ProgramSpec::Kind::kFull:
      break;
  }
  return std::make_unique<FullProgram>(f.image, f.camera, f.render, spec.samples, f.number);
}

}  // namespace kernels
