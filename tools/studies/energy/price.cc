#include "tools/studies/energy/price.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <optional>
#include <system_error>

#include <fmt/format.h>

#include "sim/config/config.h"
#include "sim/error.h"
#include "sim/io/printable.h"
#include "tools/host/standard_streams.h"
#include "tools/studies/energy/priced_text.h"
#include "tools/studies/sweep/results/collect.h"
#include "tools/studies/sweep/store/folder.h"

namespace tools {
namespace {

namespace fs = std::filesystem;

Priced price(const std::string& run, const ReportFile& report, const PriceTable& table) {
  const PricedRun own(report), asked(report, table);
  return {.run = run,
          .own = energy_totals_json(own.energy(), own.work()),
          .asked = energy_totals_json(asked.energy(), asked.work()),
          .changes = figure_changes(own.config(), asked.config()),
          .plays = std::max<std::size_t>(1, static_cast<std::size_t>(report.number("totals.replicates.count"))),
          .extrapolated = asked.extrapolated()};
}

std::vector<Priced> price_sweep(const fs::path& path, const PriceTable& table) {
  const auto folder = sweep::SweepFolder::open(path);
  const sweep::Store store = folder.store();
  std::vector<Priced> out;
  results::StatusCounts counts;
  for (const sweep::Point& point : folder.read_points()) {
    const std::optional<std::string> report = store.read_report(point.id);
    ++counts[report ? sweep::PointStatus::kDone : results::listed_status(store, point.id)];
    if (!report) continue;
    out.push_back(price(path.string(), parse_report(*report, store.folder_of(point.id) / "report.json"), table));
    out.back().n = fmt::format("{}", point.n);
    out.back().axes = point.axes;
  }
  const std::string missing = results::missing_text(counts);
  if (out.empty()) throw sim::InputError(fmt::format("{}: {}", sim::printable(path.string()), missing));
  if (!missing.empty()) print_message("warning: {}: {}", sim::printable(path.string()), missing);
  return out;
}

std::map<std::string, sim::Band> figures_of(RunConfig config) {
  std::map<std::string, sim::Band> out;
  for (const EnergyEntry& entry : energy_entries(config)) {
    for (const EnergyEntry::Figure& f : entry.figures) out[f.name] = f.band;
  }
  return out;
}

std::string band_text(const std::map<std::string, sim::Band>& figures, const std::string& name) {
  const auto found = figures.find(name);
  if (found == figures.end()) return "none";
  const sim::Band& s = found->second;
  if (s.low == s.high) return fmt::format("{} without a band", s.nominal);
  return fmt::format("{} / {} / {}", s.low, s.nominal, s.high);
}

}  // namespace

std::vector<FigureChange> figure_changes(const RunConfig& from, const RunConfig& to) {
  const auto a = figures_of(from), b = figures_of(to);
  auto all = a;
  all.insert(b.begin(), b.end());
  std::vector<FigureChange> out;
  for (const auto& [name, figure] : all) {
    FigureChange change{name, band_text(a, name), band_text(b, name)};
    if (change.from != change.to) out.push_back(std::move(change));
  }
  const auto keys = sim::list_fields(from), others = sim::list_fields(to);
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (!keys[i].path.starts_with("power.") || keys[i].value == others[i].value) continue;
    const bool is_table = keys[i].kind == sim::FieldKind::kBandMap;
    out.push_back({keys[i].path, is_table ? "a table" : keys[i].value, is_table ? "another" : others[i].value});
  }
  return out;
}

std::string price_text(const std::vector<fs::path>& paths, const PriceTable& table, PriceFormat format) {
  std::vector<std::vector<Priced>> priced;
  std::error_code ignored;
  for (const fs::path& path : paths) {
    priced.push_back(fs::exists(path / "sweep.json", ignored)
                         ? price_sweep(path, table)
                         : std::vector<Priced>{price(path.string(), load_report(path), table)});
  }
  if (format == PriceFormat::kText) return priced_text(priced);
  std::vector<Priced> runs;
  for (std::vector<Priced>& group : priced) std::ranges::move(group, std::back_inserter(runs));
  return format == PriceFormat::kJson ? priced_json(runs) : priced_csv(runs);
}

}  // namespace tools
