#include "shader_kernels/programs/reconstruct/reconstruct.h"

namespace kernels {

/// Shades the other samples of pixels whose colour changes where geometry does not, and gives these the mean of all
/// four. Their primary rays are cast once more: what the first time left is geometry alone. In the tile buffer their
/// colours lie where that was, since the filters are through with it.
ReconstructProgram::Node ReconstructProgram::shade_contrasts(Tile& tile, Node filtered) const {
  return with_branches([&]<std::uint32_t kBranches> { return shade_contrasts<kBranches>(tile, filtered); });
}

template <std::uint32_t kBranches>
ReconstructProgram::Node ReconstructProgram::shade_contrasts(Tile& tile, Node filtered) const {
  Wavefront& wave = tile.wave;
  typename ListContrasts<kBranches>::template Ports<float> list;
  list.finished = tile.finished;
  list.bend = bend_;
  list.threshold = static_cast<float>(reconstruct_.colour);
  list.branch = static_cast<float>(layer());
  const Node listed = wave.launch<ListContrasts<kBranches>>(list, tile.pixels);
  wave.wait_all(listed, filtered);
  const std::uint32_t pixels = list.masters_count.value;
  Sampling& sampling = tile.out.sampling;
  sampling.checked += tile.pixels;
  sampling.passed += tile.pixels - pixels;
  if (pixels == 0) return listed;

  const std::uint32_t rays = kOtherSamples * pixels, lanes = kOtherSamples * tile.pixels;
  tile.buffer.hold_wave(rays);
  GenerateContrastRays::Ports<float> generate;
  bind_pixels(generate, tile);
  generate.finished = tile.finished;
  generate.apart = static_cast<float>(positions());
  const Node generated = wave.launch<GenerateContrastRays>(generate, rays, lanes);
  wave.wait_all(generated, listed);
  place(tile, rays);
  wave.set_cone(cone_uniforms(camera_, 2));  // there are four samples in a pixel
  wave.run(generated, rays, {}, lanes);
  sampling.traced += rays;
  sampling.correction += rays;

  typename AverageContrasts<kBranches>::template Ports<float> average;
  average.finished = tile.finished;
  average.apart = positions();
  average.branch = layer();
  const Node averaged = wave.launch<AverageContrasts<kBranches>>(average, pixels, tile.pixels);
  wave.wait_all(averaged, generated);
  wave.wait_for_colours(averaged);
  return averaged;
}

}  // namespace kernels
