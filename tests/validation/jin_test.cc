#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/validation/figures.h"
#include "tools/analysis/picture.h"
#include "tools/run/frame/ground_truth.h"
#include "tools/run/frame/run_job.h"

// Compares supersampling with Jin et al. 2009, table 2. DEVIATIONS.md explains the differences.

namespace tools {
namespace {

Inputs conference(const std::string& textures = "0.6") {
  JobOptions options;
  options.scene = "conference";
  options.resolution = "96x48";
  options.sets = {"scene.lights.rig=strongest", "render.samples=jittered", "supersample.texture=" + textures,
                  "supersample.secondary_texture=" + textures};
  return load_inputs(options);
}

struct Render {
  double psnr = 0;
  double samples = 0;  ///< per pixel
};

TEST(Jin2009, NineSamplesArePassedOnlyWhereTexturesAreSampledMoreFinelyThanByDefault) {
  Inputs inputs = conference();
  const Inputs with_textures = conference("0.1");
  const std::vector<float> truth = ground_truth(inputs, 256, 0, {});
  const auto render = [&](const Inputs& of, const std::string& program) -> Render {
    const FrameResult run = simulate_frame(of, kernels::parse_program(program), 0);
    return {.psnr = psnr_db(mean_squared_error(run.rendered.rgb, truth)).value_or(0),
            .samples = static_cast<double>(run.rendered.sampling.traced) / (96 * 48)};
  };
  const Render nine = render(inputs, "full:9"), four = render(inputs, "full:4");
  const Render adaptive = render(inputs, "supersample"), finer = render(with_textures, "supersample");
  expect_between("samples a pixel", adaptive.samples, 7.4, 8);
  expect_between("above four samples, dB", adaptive.psnr - four.psnr, 3, 4);
  expect_between("below nine samples, dB", nine.psnr - adaptive.psnr, 0.4, 1.1);
  expect_between("gained with textures, dB", finer.psnr - adaptive.psnr, 0.9, 1.6);
  EXPECT_GT(finer.psnr, nine.psnr);
  expect_between("for this number of samples a pixel", finer.samples - adaptive.samples, 0.2, 0.5);
}

}  // namespace
}  // namespace tools
