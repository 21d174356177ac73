#include "tools/studies/reproduce/metrics.h"

#include <algorithm>
#include <array>
#include <stdexcept>

#include <fmt/format.h>

#include "hw_models/dram/dram_channel.h"
#include "hw_models/srp/srp.h"
#include "hw_models/tni/ist.h"
#include "hw_models/tni/trv.h"
#include "tools/analysis/picture.h"
#include "tools/analysis/sampling_report.h"
#include "tools/analysis/units.h"

namespace tools::reproduce {
namespace {

using Value = std::optional<double>;
using Shown = Metric::Shown;

Value ratio_of(double a, double b) {
  if (b == 0) return {};
  return a / b;
}
Value ratio_of(std::uint64_t a, std::uint64_t b) { return ratio_of(static_cast<double>(a), static_cast<double>(b)); }

double tni_pj(const ProgramResult& o) { return o.simulation.energy.blocks.at("tni").total().nominal; }
/// Returns the energy of a block; 0 if the machine does not have it.
double block_pj(const ProgramResult& o, const std::string& block) {
  const auto found = o.simulation.energy.blocks.find(block);
  return found == o.simulation.energy.blocks.end() ? 0 : found->second.total().nominal;
}
double all_pj(const ProgramResult& o) { return o.simulation.energy.total_pj.nominal; }

/// Returns a counter of the first-level caches, summed over all T&I units.
std::uint64_t l1_counter(const ProgramResult& o, std::uint64_t hw::FetchStats::*counter) {
  return Units<hw::Trv>(o.simulation.units).counted(counter) + Units<hw::Ist>(o.simulation.units).counted(counter);
}

std::uint64_t dram_bytes_of(const ProgramResult& o) {
  return Units<hw::DramChannel>(o.simulation.units).counted(&hw::DramChannel::Stats::bytes);
}
std::uint64_t lines_filled(const ProgramResult& o) { return l1_counter(o, &hw::FetchStats::l1_fills); }
/// Returns the hit rate of the first probe for each line.
double first_hits(const ProgramResult& o) {
  const std::uint64_t lines = l1_counter(o, &hw::FetchStats::l1_hits) + l1_counter(o, &hw::FetchStats::rau_reads);
  return 1 - ratio_of(l1_counter(o, &hw::FetchStats::l1_late), lines).value_or(0);
}
double all_hits(const ProgramResult& o) {
  return ratio_of(l1_counter(o, &hw::FetchStats::l1_hits), l1_counter(o, &hw::FetchStats::l1_accesses)).value_or(0);
}

/// Returns the operations of the shader cores' functional units, of all classes.
double srp_operations(const ProgramResult& o) {
  using Stats = hw::Srp::Stats;
  const Units<hw::Srp> cores(o.simulation.units);
  double all = 0;
  for (const auto counter :
       {&Stats::fp_add, &Stats::fp_mul, &Stats::fp_mul_add, &Stats::fp_div_sqrt, &Stats::fp_compare, &Stats::int_add,
        &Stats::int_mul, &Stats::int_logic, &Stats::int_shift, &Stats::convert}) {
    all += static_cast<double>(cores.counted(counter));
  }
  return all;
}
Value ops_of_traced(const Comparison& c) {
  return ratio_of(srp_operations(c.reference), static_cast<double>(c.run.sampling_counts().wanted));
}
/// Returns the operations per sample that is not traced: those of the run minus those of its traced samples, which take
/// as many as in the reference.
Value ops_of_interpolated(const Comparison& c) {
  const auto traced = static_cast<double>(c.run.sampling_counts().traced);
  return ratio_of(srp_operations(c.run) - traced * ops_of_traced(c).value_or(0),
                  static_cast<double>(c.run.sampling_counts().wanted) - traced);
}

Value speedup_of(const Comparison& c) { return ratio_of(c.reference.simulation.cycles, c.run.simulation.cycles); }
Value work_ratio(const Comparison& c) {
  return ratio_of(c.run.simulation.rendered.traversal_steps, c.reference.simulation.rendered.traversal_steps);
}
Value tni_perf_per_watt(const Comparison& c) { return ratio_of(tni_pj(c.reference), tni_pj(c.run)); }

Value product_of(Value a, Value b) {
  if (!a || !b) return {};
  return *a * *b;
}

Value sum_of(Value a, Value b) {
  if (!a || !b) return {};
  return *a + *b;
}

Value kernel_group_share(const Comparison& c, KernelGroup group) { return kernel_share(c.run.simulation, group); }

template <Mask kMask>
Value masked_psnr(const Comparison& c) {
  const std::optional<double> error = c.masked[static_cast<std::size_t>(kMask)];
  return error ? psnr_db(*error) : std::nullopt;
}

constexpr std::string_view kMaskedPrefix = "psnr_at_";

constexpr std::array<Metric, 43> kMetrics = {{
    {"psnr_db", "PSNR against the reference picture", Shown::kDecibel, false,
     [](const Comparison& c) { return psnr_db(c.squared_error); }},
    {"psnr_at_object_edges", "the same of pixels with different objects or normals", Shown::kDecibel, false,
     masked_psnr<Mask::kObjectEdge>},
    {"psnr_at_shadow_edges", "of pixels that are partly in shadow, and nothing else", Shown::kDecibel, false,
     masked_psnr<Mask::kShadowEdge>},
    {"psnr_at_reflection_edges", "of pixels with differences in mirrors or glass, and nothing else", Shown::kDecibel,
     false, masked_psnr<Mask::kReflectionEdge>},
    {"psnr_at_texture_edges", "of pixels with differences in a texture, and nothing else", Shown::kDecibel, false,
     masked_psnr<Mask::kTextureEdge>},
    {"psnr_at_elsewhere", "of all other pixels", Shown::kDecibel, false, masked_psnr<Mask::kElsewhere>},
    {"frame_ms", "time of the frame", Shown::kMilliseconds, true,
     [](const Comparison& c) { return Value(static_cast<double>(c.run.simulation.elapsed) * 1e-12); }},
    {"geometry_share", "the share of it beyond the time of the reference", Shown::kShare, true,
     [](const Comparison& c) {
       const Value rest = ratio_of(c.reference.simulation.cycles, c.run.simulation.cycles);
       return rest ? Value(1 - *rest) : Value();
     }},
    {"traced_ratio", "samples traced of those wanted", Shown::kShare, false,
     [](const Comparison& c) { return ratio_of(c.run.sampling_counts().traced, c.run.sampling_counts().wanted); }},
    {"traced_ratio_lit", "the same without samples of the background", Shown::kShare, false,
     [](const Comparison& c) {
       const kernels::Sampling& s = c.run.sampling_counts();
       return ratio_of(s.traced - s.traced_background, s.wanted - s.background);
     }},
    {"similar_ratio", "of the samples between references, those found similar", Shown::kShare, false,
     [](const Comparison& c) { return ratio_of(c.run.sampling_counts().passed, c.run.sampling_counts().checked); }},
    {"samples_of_fixed_9", "samples against nine per pixel", Shown::kShare, false,
     [](const Comparison& c) { return ratio_of(c.run.sampling_counts().traced, 9 * c.run.pixels); }},
    {"sample_ratio", "samples against sixteen per pixel", Shown::kShare, false,
     [](const Comparison& c) { return ratio_of(c.run.sampling_counts().traced, 16 * c.run.pixels); }},
    {"reflective_share", "pixels whose surface reflects", Shown::kShare, false,
     [](const Comparison& c) { return c.reflective_share; }},
    {"rays_ratio", "rays against the reference's", Shown::kShare, false,
     [](const Comparison& c) { return ratio_of(c.run.simulation.rays(), c.reference.simulation.rays()); }},
    {"work_ratio", "traversal steps against the reference's", Shown::kShare, true, work_ratio},
    {"speedup", "cycles of the reference over cycles", Shown::kFactor, true, speedup_of},
    {"speedup_x_work", "speed-up times work ratio: 1 if traversal is the bottleneck", Shown::kFactor, true,
     [](const Comparison& c) { return product_of(speedup_of(c), work_ratio(c)); }},
    {"time_ratio", "cycles over cycles of the reference", Shown::kFactor, true,
     [](const Comparison& c) { return ratio_of(c.run.simulation.cycles, c.reference.simulation.cycles); }},
    {"time_of_fixed_1", "cycles over cycles of one sample per pixel", Shown::kFactor, true,
     [](const Comparison& c) { return ratio_of(c.run.simulation.cycles, c.reference.simulation.cycles); }},
    {"tni_power", "power of the T&I units against the reference's", Shown::kFactor, true,
     [](const Comparison& c) { return product_of(ratio_of(tni_pj(c.run), tni_pj(c.reference)), speedup_of(c)); }},
    {"tni_perf_per_watt", "performance per watt of the T&I units against the reference's", Shown::kFactor, true,
     tni_perf_per_watt},
    {"gpu_perf_per_watt", "the same of the GPU with its memory", Shown::kFactor, true,
     [](const Comparison& c) { return ratio_of(all_pj(c.reference), all_pj(c.run)); }},
    {"energy_ratio", "energy of GPU and memory against the reference's", Shown::kFactor, true,
     [](const Comparison& c) { return ratio_of(all_pj(c.run), all_pj(c.reference)); }},
    {"dram_bytes_ratio", "bytes over the memory's buses against the reference's", Shown::kFactor, true,
     [](const Comparison& c) { return ratio_of(dram_bytes_of(c.run), dram_bytes_of(c.reference)); }},
    {"l1_hits", "probes of the T&I units' caches that hit, retries included", Shown::kShare, true,
     [](const Comparison& c) { return Value(all_hits(c.run)); }},
    {"l1_hits_ratio", "the same against the reference's", Shown::kFactor, true,
     [](const Comparison& c) { return ratio_of(all_hits(c.run), all_hits(c.reference)); }},
    {"l1_first_hits", "the same of the first probe for each line", Shown::kShare, true,
     [](const Comparison& c) { return Value(first_hits(c.run)); }},
    {"l1_first_hits_ratio", "the same against the reference's", Shown::kFactor, true,
     [](const Comparison& c) { return ratio_of(first_hits(c.run), first_hits(c.reference)); }},
    {"l1_fills_ratio", "lines brought into the T&I units' caches against the reference's", Shown::kFactor, true,
     [](const Comparison& c) { return ratio_of(lines_filled(c.run), lines_filled(c.reference)); }},
    {"box_bytes_ratio", "bytes of all boxes of the tree against the reference's", Shown::kFactor, false,
     [](const Comparison& c) { return ratio_of(c.run.box_bytes, c.reference.box_bytes); }},
    {"node_bytes_ratio", "the same of whole nodes", Shown::kFactor, false,
     [](const Comparison& c) { return ratio_of(c.run.node_bytes, c.reference.node_bytes); }},
    {"check_share", "SRP cycles in similarity checks", Shown::kShare, true,
     [](const Comparison& c) { return kernel_group_share(c, KernelGroup::kCheck); }},
    {"interpolation_share", "SRP cycles in interpolation", Shown::kShare, true,
     [](const Comparison& c) { return kernel_group_share(c, KernelGroup::kInterpolation); }},
    {"adaptive_share", "SRP cycles in both, including the packing of results", Shown::kShare, true,
     [](const Comparison& c) {
       return sum_of(kernel_group_share(c, KernelGroup::kCheck), kernel_group_share(c, KernelGroup::kInterpolation));
     }},
    {"starved_share", "time without rays for the T&I units while checks or interpolation run", Shown::kShare, true,
     [](const Comparison& c) { return starved_share(c.run.simulation); }},
    {"correction_share", "SRP cycles in post-correction", Shown::kShare, true,
     [](const Comparison& c) { return kernel_group_share(c, KernelGroup::kCorrection); }},
    {"tracing_share", "SRP cycles in everything else", Shown::kShare, true,
     [](const Comparison& c) { return kernel_group_share(c, KernelGroup::kTracing); }},
    {"cycles", "cycles of the T&I clock for a frame", Shown::kCount, true,
     [](const Comparison& c) { return Value(static_cast<double>(c.run.simulation.cycles)); }},
    {"dram_bytes", "bytes over the memory's buses for a frame", Shown::kCount, true,
     [](const Comparison& c) { return Value(static_cast<double>(dram_bytes_of(c.run))); }},
    {"raster_share", "energy of the rasterisers, of GPU and memory", Shown::kShare, true,
     [](const Comparison& c) { return ratio_of(block_pj(c.run, "raster"), all_pj(c.run)); }},
    {"ops_of_traced", "operations of the SRPs for a sample of the reference", Shown::kCount, true, ops_of_traced},
    {"ops_of_interpolated", "the same for a sample that is not traced", Shown::kCount, true, ops_of_interpolated},
}};

}  // namespace

const Metric& find_metric(std::string_view name) {
  const auto found = std::ranges::find(kMetrics, name, &Metric::name);
  if (found == kMetrics.end()) throw std::logic_error(fmt::format("there is no metric '{}'", name));
  return *found;
}

bool needs_masks(std::string_view name) { return name.starts_with(kMaskedPrefix); }

std::string metric_text(const Metric& metric, double value) {
  switch (metric.shown) {
    case Shown::kDecibel:
      return fmt::format("{:.2f} dB", value);
    case Shown::kShare:
      return fmt::format("{:.1f} %", 100 * value);
    case Shown::kCount:
      return fmt::format("{:.0f}", value);
    case Shown::kMilliseconds:
      return fmt::format("{:.3f} ms", value);
    case Shown::kFactor:
      break;
  }
  return fmt::format("{:.2f} x", value);
}

}  // namespace tools::reproduce
