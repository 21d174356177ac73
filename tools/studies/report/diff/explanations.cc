#include <fmt/format.h>

#include "tools/studies/report/diff/diff_parts.h"

namespace tools::pages {
namespace {

Dataset pairs_of(const std::vector<Pair>& pairs, const Difference& d, Show show, const char* unit = "") {
  Dataset data({{"name", "what"},
                {"a", d.name_a, show, unit},
                {"b", d.name_b, show, unit},
                {"difference", "difference", show, unit},
                {"change", "change"}});
  for (const Pair& pair : pairs) data.row({pair.name, pair.a, pair.b, pair.difference(), change_text(pair)});
  return data;
}

}  // namespace

void add_explanations(const Difference& d, View& view) {
  Section section("more", "What else has changed", "The largest difference first; headings sort.");
  const auto list = [&](const char* id, const char* title, const std::vector<Pair>& pairs, Show show,
                        const char* unit = "") {
    if (pairs.empty()) return;
    view.data(id, pairs_of(pairs, d, show, unit));
    section.table(std::string(id) + "-table", title, id);
  };
  list("ratios", "Rates and mean times", d.found.ratios, Show::kNumber);
  list("reasons", "Cycles of an average unit, by reason", d.found.reasons, Show::kSi);
  list("events", "Energy by event", d.found.events, Show::kNumber, "mJ");
  list("counters", "Counters", d.found.counters, Show::kSi);
  if (d.found.energy) {
    const EnergyRatio& gpu = d.found.energy->gpu;
    section.text(fmt::format(
        "Energy of {} over that of {} is {:.4f} under nominal tables, {:.4f} to {:.4f} in 95 % of {} draws of all "
        "their entries, and less than 1 in {:.1f} % of them.",
        d.name_b, d.name_a, gpu.together.nominal, gpu.drawn.from, gpu.drawn.to, kEnergyDraws, 100 * gpu.b_less));
  } else if (!d.found.no_energy.empty()) {
    section.text("Energies are not compared under other tables: " + d.found.no_energy + ".");
  }
  view.add(section);
}

}  // namespace tools::pages
