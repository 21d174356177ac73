#include "tools/tiles/tile_frame.h"

#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "hw_models/machines/gpu_config.h"
#include "hw_models/memory/messages.h"
#include "sim/report/report_json.h"
#include "tools/tiles/tile_energy.h"

namespace tools {
namespace {

constexpr double kMillijoulesPerPicojoule = 1e-9;  // as in report_json.cc: figures agree to the last bit

/// Returns the number that must be added to a sum so that it is exactly `whole`.
double missing_to(double whole, double sum) {
  double rest = whole - sum;
  while (sum + rest < whole) rest = std::nextafter(rest, INFINITY);
  while (sum + rest > whole) rest = std::nextafter(rest, -INFINITY);
  return rest;
}

class Builder {
 public:
  Builder(const FrameResult& s, const RunConfig& config, std::uint32_t frame) : s_(s), config_(config) {
    frame_.frame = frame;
  }

  TileFrame build_frame() {
    add_firsts();
    add_times();
    add_function();
    add_memory();
    add_energy();
    return std::move(frame_);
  }

 private:
  /// Adds a column of `value(i)` for each tile.
  TileColumn& add(std::string name, std::string unit, auto&& value) {
    TileColumn& column = frame_.columns.emplace_back(TileColumn{std::move(name), std::move(unit)});
    column.values.reserve(s_.tile_accounts.size());
    for (std::size_t i = 0; i < s_.tile_accounts.size(); ++i) {
      column.values.push_back(static_cast<double>(value(i)));
    }
    return column;
  }
  void add_sum(std::string name, std::string unit, double rest, auto&& value) {
    TileColumn& column = add(std::move(name), std::move(unit), value);
    column.is_sum = true;
    column.rest = rest;
    for (const double one : column.values) column.total += one;
    column.total += rest;
  }
  const kernels::TileSummary& summary_of(std::size_t i) const { return s_.rendered.summaries.tiles[i]; }
  const hw::TileAccount& account_of(std::size_t i) const { return s_.tile_accounts[i]; }

  void add_firsts() {
    std::uint32_t pass = 0;
    add("tile", "", [&](std::size_t i) { return summary_of(i).tile; });
    add("pass", "", [&](std::size_t i) { return pass += summary_of(i).begins_pass ? 1U : 0U; });
    if (s_.rendered.pixels.empty()) return;
    const std::vector<const kernels::TileSummary*> firsts = first_passes();
    add("x", "pixels", [&](std::size_t i) { return firsts[i]->x; });
    add("y", "pixels", [&](std::size_t i) { return firsts[i]->y; });
    add("width", "pixels", [&](std::size_t i) { return firsts[i]->width; });
    add("height", "pixels", [&](std::size_t i) { return firsts[i]->height; });
  }
  /// Returns for each entry the same tile's entry in the first pass, which has its place. A later pass over the frame
  /// numbers its tiles after those of the previous pass, in the same order.
  std::vector<const kernels::TileSummary*> first_passes() const {
    std::vector<const kernels::TileSummary*> by_tile, firsts;
    std::size_t count = 0;
    for (std::size_t i = 0; i < s_.tile_accounts.size() && !(i != 0 && summary_of(i).begins_pass); ++i) count += 1;
    by_tile.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      if (summary_of(i).tile < count) by_tile[summary_of(i).tile] = &summary_of(i);
    }
    for (std::size_t i = 0; i < s_.tile_accounts.size(); ++i) {
      const kernels::TileSummary* first = i < count ? nullptr : by_tile[summary_of(i).tile % count];
      firsts.push_back(first == nullptr ? &summary_of(i) : first);
    }
    return firsts;
  }
  void add_times() {
    const sim::Clock tni = config_.gpu->clocks.tni.clock();
    add("core", "", [&](std::size_t i) { return account_of(i).core; });
    add("dispatched", "T&I cycles", [&](std::size_t i) { return tni.cycles(account_of(i).dispatched); });
    add("finished", "T&I cycles", [&](std::size_t i) { return tni.cycles(account_of(i).finished); });
    add_sum("srp_cycles", "SRP cycles", static_cast<double>(s_.rest.srp_cycles),
            [&](std::size_t i) { return account_of(i).srp_cycles; });
  }
  void add_function() {
    constexpr std::array kKinds = {"rays_primary", "rays_shadow", "rays_reflection", "rays_refraction"};
    static_assert(kKinds.size() == static_cast<std::size_t>(traces::RayKind::kCount));
    for (std::size_t k = 0; k < kKinds.size(); ++k) {
      add_sum(kKinds[k], "rays", 0, [&](std::size_t i) { return summary_of(i).rays[k]; });
    }
    add_sum("steps", "steps", 0, [&](std::size_t i) { return summary_of(i).steps; });
    add_sum("tests", "tests", 0, [&](std::size_t i) { return summary_of(i).tests; });
  }
  void add_memory() {
    const auto bytes = [](std::uint64_t lines) { return static_cast<double>(hw::kLineBytes * lines); };
    for (std::size_t a = 0; a < hw::kRequesterKinds; ++a) {
      add_sum(std::string("bytes_").append(names_of(hw::RequesterKind{})[a]), "bytes", bytes(s_.rest.lines[a]),
              [&](std::size_t i) { return bytes(account_of(i).lines[a]); });
    }
    add_sum("dram_bytes", "bytes", bytes(s_.rest.dram_reads + s_.rest.dram_writes),
            [&](std::size_t i) { return bytes(account_of(i).dram_reads + account_of(i).dram_writes); });
  }
  void add_energy() {
    const TileEnergy energy = tile_energy(s_, config_);
    const auto add_side = [&](const char* name, double sim::Band::*side) {
      add_sum(name, "mJ", 0, [&](std::size_t i) { return energy.tiles[i].*side * kMillijoulesPerPicojoule; });
      TileColumn& column = frame_.columns.back();
      const double whole = s_.energy.total_pj.*side * kMillijoulesPerPicojoule;
      column.rest = missing_to(whole, column.total);
      column.total = whole;
    };
    add_side("energy_mj_low", &sim::Band::low);
    add_side("energy_mj_nominal", &sim::Band::nominal);
    add_side("energy_mj_high", &sim::Band::high);
  }

  const FrameResult& s_;
  const RunConfig& config_;
  TileFrame frame_;
};

}  // namespace

TileFrame tile_frame(const FrameResult& s, const RunConfig& config, std::uint32_t frame) {
  return Builder(s, config, frame).build_frame();
}

}  // namespace tools
