#include <array>

#include "shader_kernels/programs/reconstruct/reconstruct.h"

namespace kernels {

/// With a radius of 0 a pixel shows its own shaded sample.
ReconstructProgram::Node ReconstructProgram::show_shaded(Tile& tile) const {
  AverageSamples::Ports<float> ports;
  ports.samples = ports.inverse_samples = 1;
  ports.width = tile.finished.width;
  ports.inverse_width = tile.finished.inverse_width;
  ports.grid = ports.inverse_grid = 1;
  ports.first = tile.finished.first;
  ports.pitch = tile.finished.pitch;
  const Node shown = tile.wave.launch<AverageSamples>(ports, tile.pixels);
  tile.wave.wait_for_colours(shown);
  return shown;
}

ReconstructProgram::Node ReconstructProgram::reconstruct(Tile& tile) const {
  return reconstruct_.radius == 1 ? filter<1>(tile) : filter<2>(tile);
}

template <class K>
void ReconstructProgram::bind_filter(typename K::template Ports<float>& ports, const Tile& tile) const {
  ports.finished = tile.finished;
  ports.bend = bend_;
  ports.apart = positions();
}

template <std::uint32_t kRadius>
ReconstructProgram::Node ReconstructProgram::filter(Tile& tile) const {
  Wavefront& wave = tile.wave;
  using Surfaces = Reconstruct<kRadius, false>;
  typename Surfaces::template Ports<float> ports;
  bind_filter<Surfaces>(ports, tile);
  Node last = wave.launch<Surfaces>(ports, tile.pixels);
  wave.wait_for_records(last);
  wave.wait_for_colours(last);
  for (std::uint32_t b = 1; b < layers_; ++b) {
    const auto layers_before = static_cast<float>(b * layer());
    ListBranches::Ports<float> list;
    list.finished = tile.finished;
    list.branch = layers_before;
    list.apart = positions();
    const Node listed = wave.launch<ListBranches>(list, tile.pixels);
    wave.wait_all(listed, last);
    last = listed;
    const std::uint32_t items = list.masters_count.value;
    if (items == 0) continue;
    using Branch = Reconstruct<kRadius, true>;
    typename Branch::template Ports<float> branch;
    bind_filter<Branch>(branch, tile);
    branch.branch = layers_before;
    last = wave.launch<Branch>(branch, items, tile.pixels);
    wave.wait_all(last, listed);
  }
  return last;
}

}  // namespace kernels
