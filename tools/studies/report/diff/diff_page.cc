#include "tools/studies/report/diff/diff_page.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "sim/report/table.h"
#include "tools/analysis/picture.h"
#include "tools/studies/report/diff/diff_parts.h"

namespace tools::pages {
namespace {

std::string changed(const Pair& pair) {
  const double percent = 100 * (pair.b / pair.a - 1);
  return fmt::format("{:.{}f} %", std::abs(percent), std::abs(percent) < 1 ? 2 : 1);
}

/// Words on what a difference is beside its noise; none where no noise is known.
std::string beside_noise(const Pair& pair) {
  if (!pair.noise) return "";
  return pair.noise->outside ? ", which is outside the noise" : ", which is within the noise";
}

/// Words for the figures of a comparison that stand at the top.
struct Figure {
  const char *name, *words, *unit;
  Show show;
};
constexpr Figure kFigures[] = {{"cycles", "Cycles", "", Show::kSi},
                               {"fps", "Frame rate", "frames/s", Show::kNumber},
                               {"energy_mj", "Energy", "mJ", Show::kNumber},
                               {"power_w", "Power", "W", Show::kNumber},
                               {"frames_per_joule_gpu", "Efficiency", "frames/J", Show::kNumber},
                               {"mrays_per_s", "Ray rate", "Mrays/s", Show::kNumber},
                               {"dram_bytes", "DRAM traffic", "B", Show::kSi},
                               {"area_mm2", "Area", "mm²", Show::kNumber}};

std::string shown(const Figure& figure, double value) {
  return figure.show == Show::kSi ? sim::si_text(value, figure.unit)
                                  : fmt::format("{} {}", number_text(value), figure.unit);
}

std::string picture_words(const Comparison& c) {
  if (!c.squared_error) return "The pictures are not compared: " + c.no_picture + ".";
  const std::optional<double> psnr = psnr_db(*c.squared_error);
  return psnr ? fmt::format("PSNR of the pictures {:.2f} dB.", *psnr) : "The pictures are identical.";
}

/// All runs side by side, where there are more than two.
void add_overview(const std::vector<ReportFile>& reports, const std::vector<std::string>& names,
                  const std::vector<Comparison>& against, View& view) {
  if (reports.size() < 3) return;
  std::vector<Column> columns = {{"run", "run"}};
  for (const Figure& figure : kFigures) columns.push_back({figure.name, figure.words, figure.show, figure.unit});
  Dataset data(columns);
  for (std::size_t i = 0; i < reports.size(); ++i) {
    std::vector<Json> row = {names[i]};
    for (const Figure& figure : kFigures) {
      const auto& pairs = against[i == 0 ? 0 : i - 1].figures;
      const auto found = std::ranges::find(pairs, std::string(figure.name), &Pair::name);
      row.push_back(found == pairs.end() ? Json() : Json(i == 0 ? found->a : found->b));
    }
    data.row(std::move(row));
  }
  view.data("overview", data);
  Section section("overview", "All runs side by side");
  section.table("overview-table", "Figures of all runs", "overview");
  view.add(section);
}

}  // namespace

const Pair* Difference::figure(std::string_view name) const {
  const auto pair = std::ranges::find(found.figures, name, &Pair::name);
  return pair == found.figures.end() ? nullptr : &*pair;
}

void add_diff_verdict(const Difference& d, View& view) {
  const std::vector<std::pair<std::string, std::string>> links = {{"what made the difference", "waterfall"},
                                                                  {"keys that differ", "keys"}};
  const Pair* const cycles = d.figure("cycles");
  const Pair* const energy = d.figure("energy_mj");
  std::string more;
  if (energy != nullptr && energy->a != energy->b && energy->a > 0)
    more = fmt::format("Energy {}{}{}. ", energy->b < energy->a ? "−" : "+", changed(*energy), beside_noise(*energy));
  more += picture_words(d.found);
  if (cycles == nullptr || cycles->a <= 0 || cycles->b <= 0) {
    return view.verdict(fmt::format("{} and {} cannot be compared in time.", d.name_b, d.name_a), more, links);
  }
  if (cycles->a == cycles->b) {
    view.verdict(fmt::format("{} takes as many cycles as {}.", d.name_b, d.name_a), more, links);
  } else {
    view.verdict(fmt::format("{} takes {} {} cycles than {}{}.", d.name_b, changed(*cycles),
                             cycles->b < cycles->a ? "fewer" : "more", d.name_a, beside_noise(*cycles)),
                 more, links);
  }
  for (const Figure& figure : kFigures) {
    const Pair* const pair = d.figure(figure.name);
    if (pair == nullptr) continue;
    std::string note = fmt::format("{}, was {}", change_text(*pair), shown(figure, pair->a));
    if (pair->noise)
      note += fmt::format("; {} a noise of ±{:.2g} %", pair->noise->outside ? "outside" : "within",
                          100 * pair->noise->half_width);
    view.headline({.id = figure.name,
                   .name = figure.words,
                   .value = pair->b,
                   .show = figure.show,
                   .unit = figure.unit,
                   .note = note});
  }
}

std::vector<View> diff_views(const std::vector<ReportFile>& reports) {
  std::vector<Comparison> against;
  for (std::size_t i = 1; i < reports.size(); ++i) against.push_back(compare(reports.front(), reports[i]));
  const std::vector<std::string> names = short_names(reports);
  std::vector<View> views;
  for (std::size_t i = 0; i < against.size(); ++i) {
    const Difference d{reports.front(), reports[i + 1], names[0], names[i + 1], against[i]};
    View view(fmt::format("{} against {}", d.name_b, d.name_a));
    for (const auto& [which, report] : {std::pair{"First", &d.a}, std::pair{"Second", &d.b}}) {
      view.fact(which, fmt::format("{}: {}, {}x{}, {}", report == &d.a ? d.name_a : d.name_b,
                                   text_at(report->json, {"scene", "name"}), report->number("resolution[0]"),
                                   report->number("resolution[1]"), text_at(report->json, {"program"})));
    }
    for (const std::string& warning : comparison_warnings({reports.front(), reports[i + 1]}, {against[i]}))
      view.notice(warning);
    add_diff_verdict(d, view);
    add_overview(reports, names, against, view);
    add_waterfalls(d, view);
    add_keys(d, view);
    add_diff_pictures(d, view);
    add_explanations(d, view);
    views.push_back(std::move(view));
  }
  return views;
}

}  // namespace tools::pages
