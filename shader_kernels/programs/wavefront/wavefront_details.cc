#include "shader_kernels/programs/wavefront/wavefront.h"

namespace kernels {

/// Steps that only some scenes have, before surfaces are sorted: they change points, base colours, optics and classes
/// of the surfaces in their streams. Each waits for the one before; `bounce.inspector` is the last.
void Wavefront::shade_details(Bounce& bounce, const ClassifyDetails::Ports<float>& sorted, Streams& streams) {
  step<Absorb>(bounce, sorted.absorbing_count.value);
  scene_.image.has_levels() ? step<FetchVertices<true>>(bounce, sorted.vertexed_count.value)
                            : step<FetchVertices<false>>(bounce, sorted.vertexed_count.value);
  with_mips([&]<MipFilter kMips> {
    step<ShadeBase<kMips>>(bounce, sorted.based_count.value, &buffer_.based);
    step<ShadePhysical<kMips>>(bounce, sorted.physical_count.value, &buffer_.physical);
    step<ShadeBump<kMips>>(bounce, sorted.bumped_count.value, &buffer_.bumped);
  });
  step<ShadeBlend>(bounce, sorted.blended_count.value);
  streams.blended = sorted.blended_count.value;
  streams.glowing = sorted.glowing_count.value;
  streams.occluded = sorted.occluded_count.value;
}

/// Launches the next step of shade_details, if its stream has items: it waits for the one before.
template <class K>
void Wavefront::step(Bounce& bounce, std::uint32_t items, std::vector<std::uint32_t>* stream) {
  if (items == 0) return;
  typename K::template Ports<float> ports;
  if constexpr (requires { ports.stream; }) ports.stream.bind(stream->data());
  const Node node = launch<K>(ports, items, bounce.lanes);
  wait_for_bounce(node, bounce);
  bounce.inspector = node;
}

void Wavefront::shade_glow(const Bounce& bounce, std::uint32_t items) {
  with_mips([&]<MipFilter kMips> {
    typename ShadeGlow<kMips>::template Ports<float> ports;
    ports.stream.bind(buffer_.glowing.data());
    add_colours<ShadeGlow<kMips>>(bounce, ports, items);
  });
}

void Wavefront::shade_occluded(const Bounce& bounce, std::uint32_t items) {
  with_mips([&]<MipFilter kMips> {
    typename ShadeOccluded<kMips>::template Ports<float> ports;
    ports.stream.bind(buffer_.occluded.data());
    ports.ambient = scene_.ambient;
    add_colours<ShadeOccluded<kMips>>(bounce, ports, items);
  });
}

}  // namespace kernels
