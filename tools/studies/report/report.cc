#include "tools/studies/report/report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <map>
#include <memory>
#include <span>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <openssl/sha.h>

#include "hw_models/dram/dram_energy.h"
#include "hw_models/machines/gpu_config.h"
#include "hw_models/machines/unit_kinds.h"
#include "hw_models/srp/schedule.h"
#include "shader_kernels/catalogue.h"
#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/printable.h"
#include "sim/report/table.h"
#include "tools/host/build_info.h"
#include "tools/host/paths.h"
#include "tools/host/standard_streams.h"
#include "tools/intervals/intervals.h"
#include "tools/pricing/priced_run.h"
#include "tools/studies/compare/compare.h"
#include "traces/scene/images.h"

namespace tools::pages {

namespace {

using sim::Json;

constexpr std::size_t kLongestName = 2000, kLongestCommand = 4000;
constexpr std::size_t kMostIntervals = 512;
/// Energy events below this share of the total energy, under low, nominal and high tables alike, are merged into one
/// entry per block.
constexpr double kSmallShare = 0.008;
constexpr const char* kTotal = "GPU with memory";

std::string command_of(const ReportFile& report) {
  const sim::JsonPointer argv("/provenance/argv");
  if (!report.json.contains(argv)) return {};
  std::vector<std::string> words;
  for (const Json& word : report.json.at(argv)) {
    if (word.is_string()) words.push_back(word.get<std::string>());
  }
  return sim::printable(command_text(words), kLongestCommand);
}

/// Returns a report whose `frames` have only the members that the page shows.
Json trimmed_report(Json report) {
  const auto frames = report.find("frames");
  if (frames == report.end() || !frames->is_array()) return report;
  for (Json& frame : *frames) {
    Json kept = Json::object();
    for (const char* key : {"frame", "time_ms", "energy_mj", "rays", "limiter", "psnr_db", "temporal_psnr_db"}) {
      if (frame.is_object() && frame.contains(key)) kept[key] = frame[key];
    }
    frame = std::move(kept);
  }
  return report;
}

Json unit_kinds_json() {
  Json out = Json::array();
  for (const hw::UnitKind& unit : hw::kUnitKinds) {
    Json reasons = Json::array();
    for (const sim::Reason& reason : unit.reasons)
      reasons.push_back(
          {{"name", reason.name}, {"kind", static_cast<std::uint32_t>(reason.kind)}, {"meaning", reason.meaning}});
    out.push_back({{"name", unit.name}, {"reasons", std::move(reasons)}});
  }
  return out;
}

/// Returns the name of the shader core's resource that limits the initiation interval of a kernel.
std::string limiting_resource_name(const hw::KernelSchedule& s, const hw::ArrayConfig& array) {
  using hw::OpClass;
  if (s.rec_mii >= s.ii) return "values from item to item";
  const auto ops = [&](OpClass op) { return static_cast<double>(s.ops[static_cast<std::size_t>(op)]); };
  const auto per_unit = [](double work, std::uint32_t units) { return units == 0 ? 0 : work / units; };
  // For each resource: the smallest initiation interval at which the operations fit.
  const std::pair<double, const char*> most = std::max<std::pair<double, const char*>>(
      {{per_unit(s.fu_ops, array.unit_count()), "functional units"},
       {per_unit(ops(OpClass::kFpMul) + ops(OpClass::kFpMulAdd) + ops(OpClass::kIntMul), array.mul_units),
        "multipliers"},
       {per_unit(ops(OpClass::kFpDivSqrt), array.div_sqrt_units), "dividers"},
       {per_unit(s.local_reads + s.local_writes, array.local_ports), "local-memory ports"},
       {per_unit(s.queued_loads, array.cache_ports), "data-cache ports"}},
      [](const auto& a, const auto& b) { return a.first < b.first; });
  if (s.ii > s.res_mii) return fmt::format("the schedule: {} alone allow {}", most.second, s.res_mii);
  return most.second;
}

Json kernels_json(const ReportFile& report, const PricedRun* priced) {
  Json out = Json::object();
  const sim::JsonPointer kernels("/totals/kernels");
  if (!report.json.contains(kernels) || !report.json.at(kernels).is_object()) return out;
  for (const auto& [name, kernel] : report.json.at(kernels).items()) {
    const kernels::KernelInfo* const info = kernels::find_kernel(name);
    if (info == nullptr) continue;
    out[name]["meaning"] = info->meaning;
    if (priced == nullptr) continue;
    const hw::SrpConfig& srp = priced->config().gpu->srp;
    const hw::KernelSchedule schedule = hw::schedule_kernel(info->graph, srp);
    if (schedule.ii == report.number(fmt::format("totals.kernels.{}.ii", name)))
      out[name]["bound"] = limiting_resource_name(schedule, srp.array);
  }
  return out;
}

bool is_small(const sim::Band& pj, const sim::Band& total) {
  return pj.low < kSmallShare * total.low && pj.nominal < kSmallShare * total.nominal &&
         pj.high < kSmallShare * total.high;
}

/// Returns the links of the energy flow diagram. Links go from the total to each block, and from a block to its events,
/// its clock and its leakage. Standby energy of the memory counts as an event, not as leakage.
Json energy_flow(const PricedRun& run) {
  const sim::EnergyReport energy = run.energy();
  const auto device = hw::dram_energy_events(run.config().gpu->dram);
  std::map<std::pair<std::string, std::string>, sim::Band> links;
  const auto add = [&](const std::string& from, const std::string& to, const sim::Band& pj) {
    if (pj.high > 0) links[{from, to}] += pj;
  };
  for (const auto& [block, kinds] : energy.blocks) {
    add(kTotal, block, kinds.total());
    add(block, "clock", kinds.clock);
    sim::Band leakage = kinds.leakage;
    if (const auto events = energy.events.find(block); events != energy.events.end()) {
      for (const auto& [name, pj] : events->second) {
        const auto of_device = device.find(name);
        if (of_device != device.end() && of_device->second.standby) leakage += pj * -1.0;
        const bool is_prefixed = name.starts_with(block + ".");
        const std::string words = is_prefixed ? name.substr(block.size() + 1) : name;
        add(block, fmt::format("{}: {}", block, is_small(pj, energy.total_pj) ? "other events" : words), pj);
      }
    }
    add(block, "leakage", leakage);
  }
  Json out = Json::array();
  for (const auto& [ends, pj] : links) {
    out.push_back(Json::array({ends.first, ends.second, pj.low / sim::kPicojoulesPerMillijoule,
                               pj.nominal / sim::kPicojoulesPerMillijoule, pj.high / sim::kPicojoulesPerMillijoule}));
  }
  return out;
}

/// Returns the metrics of the first frame over time, except those that are always 0.
Json series_json(const ReportFile& report) {
  if (!RunIntervals::has_intervals(report)) return {{"note", "This run has no intervals of time."}};
  try {
    const RunIntervals intervals(report);
    if (intervals.frames().empty()) throw sim::InputError("its file of intervals is empty");
    const IntervalTable table =
        derive_table(intervals, intervals.frames().front(), &sim::Band::nominal, kMostIntervals);
    Json all = Json::array();
    for (const IntervalSeries& series : table.series) {
      const auto is_nothing = [](double value) { return value == 0 || !std::isfinite(value); };
      if (std::ranges::all_of(series.values, is_nothing)) continue;
      all.push_back({{"group", series.group},
                     {"name", series.name},
                     {"unit", series.unit},
                     {"values", rounded_for_page(series.values)}});
    }
    if (all.empty()) throw sim::InputError("nothing happened in any interval");
    return {{"note", intervals.frames().size() > 1 ? "Of the first frame." : ""},
            {"begin_us", rounded_for_page(table.begin_us)},
            {"end_us", rounded_for_page(table.end_us)},
            {"all", std::move(all)}};
  } catch (const sim::InputError& error) {
    print_message("warning: {}; the page shows no metrics over time", error.what());
    return {{"note", fmt::format("Metrics over time are not shown: {}", error.what())}};
  }
}

/// Returns the data of a page about a run: its report, and data that the page's script cannot compute from it:
///   title, command
///   report       the report; each entry of `frames` has only the keys that the page lists
///   unit_kinds   [{name, reasons: [{name, kind, meaning}]}]
///   resources    {name: description}, e.g. {"l1": "first-level caches"}
///   kernels      {name: {meaning, bound}}; bound: what limits the initiation interval
///   flow         [[from, to, low, nominal, high], ...] in mJ; null, with the reason in not_priced
///   series       {begin_us, end_us, all: [{group, name, unit, values}]}, or a note
///   picture      run_picture()
///   film         frame_pictures_block()
Json run_data(const ReportFile& report) {
  std::unique_ptr<PricedRun> priced;
  std::string not_priced;
  try {
    priced = std::make_unique<PricedRun>(report);
  } catch (const sim::InputError& error) {
    not_priced = error.what();
  }
  Json resources = Json::object();
  for (const hw::IdealConfig::Resource& resource : hw::IdealConfig::kResources)
    resources[resource.name] = resource.words;
  return {{"title", run_title(report)},
          {"command", command_of(report)},
          {"report", trimmed_report(report.json)},
          {"unit_kinds", unit_kinds_json()},
          {"resources", std::move(resources)},
          {"kernels", kernels_json(report, priced.get())},
          {"flow", priced ? energy_flow(*priced) : Json()},
          {"not_priced", not_priced},
          {"series", series_json(report)},
          {"picture", run_picture(report)},
          {"film", frame_pictures_block(report)}};
}

}  // namespace

std::string run_title(const ReportFile& report) {
  const auto program = report.json.find("program");
  const bool has_program = program != report.json.end() && program->is_string();
  return fmt::format("{}, {}x{}, {}", sim::printable(report.text("scene", "name"), kLongestName),
                     report.number("resolution[0]"), report.number("resolution[1]"),
                     has_program ? sim::printable(program->get_ref<const std::string&>(), kLongestName) : "");
}

namespace {

constexpr std::uint64_t kLargestPicture = 64 << 20;
constexpr std::uint32_t kCell = 16;  ///< side in pixels of the squares in which two pictures are compared

/// Two runs that a page compares, and their names.
struct Difference {
  const ReportFile &a, &b;
  std::string name_a, name_b;
};

TileFrame first_tile_frame(const ReportFile& report, const std::string& name) {
  const std::filesystem::path file = tiles_file(report);
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored))
    throw sim::InputError(fmt::format("{} has no {}", name, file.filename().string()));
  try {
    TileTable table = load_tiles(file);
    if (!table.frames.empty()) return std::move(table.frames.front());
  } catch (const sim::InputError& error) {
    print_message("warning: {}; the page compares no tiles", error.what());
    throw;
  }
  throw sim::InputError(fmt::format("{} of {} has no frames", kTilesFile, name));
}

/// For each tile metric that differs between two runs, adds an overlay with the difference of each tile. Sets `note` to
/// the metrics that are equal, or to the reason why tiles are not compared.
void add_tile_differences(const Difference& d, Json& grids, std::string& note) {
  const double width = d.a.number("resolution[0]"), height = d.a.number("resolution[1]");
  try {
    const TileFrame a = first_tile_frame(d.a, d.name_a), b = first_tile_frame(d.b, d.name_b);
    const TileGrid grid_a = tile_grid(a, width, height), grid_b = tile_grid(b, width, height);
    if (grid_a.side != grid_b.side) {
      throw sim::InputError(
          fmt::format("{} has tiles of {} pixels, {} of {}", d.name_a, grid_a.side, d.name_b, grid_b.side));
    }
    std::vector<std::string> equal;
    for (const TileMetric& metric : tile_metrics()) {
      const std::vector<double> of_a = tile_values(metric, a, grid_a), of_b = tile_values(metric, b, grid_b);
      std::vector<double> difference(of_a.size());
      double most = 0;
      for (std::size_t i = 0; i < difference.size(); ++i) {
        difference[i] = of_b[i] - of_a[i];
        most = std::max(most, std::abs(difference[i]));
      }
      if (most == 0) {
        equal.emplace_back(metric.words);
        continue;
      }
      grids.push_back({{"id", metric.id},
                       {"name", metric.words},
                       {"tile", grid_a.side},
                       {"unit", metric.unit},
                       {"values", rounded_for_page(difference)},
                       {"of", {rounded_for_page(of_a), rounded_for_page(of_b)}},
                       {"low", -most},
                       {"high", most},
                       {"diverging", true}});
    }
    if (!equal.empty()) note = fmt::format("Equal in every tile: {}.", fmt::join(equal, ", "));
  } catch (const sim::InputError& error) {
    note = fmt::format("Tiles are not compared: {}.", error.what());
  }
}

struct Picture {
  traces::Texture pixels;
  Json url;
};

Picture read_picture(const ReportFile& report) {
  const std::filesystem::path file = report.picture("png");
  const std::string bytes = sim::read_file(file, kLargestPicture);
  return {traces::read_image(std::as_bytes(std::span(bytes.data(), bytes.size())), file.string()),
          data_url("image/png", bytes)};
}

/// Returns the mean absolute difference of two pictures in each square of kCell pixels, in steps of 8-bit colour.
std::vector<double> cell_differences(const traces::Texture& a, const traces::Texture& b) {
  const std::uint32_t columns = (a.width + kCell - 1) / kCell, rows = (a.height + kCell - 1) / kCell;
  std::vector<double> sums(std::size_t{columns} * rows), counts(sums.size());
  for (std::uint32_t y = 0; y < a.height; ++y) {
    for (std::uint32_t x = 0; x < a.width; ++x) {
      const std::size_t i = std::size_t{y} * a.width + x;
      const std::size_t cell = std::size_t{y / kCell} * columns + x / kCell;
      for (const unsigned shift : {0U, 8U, 16U}) {
        const auto channel = [&](std::uint32_t texel) { return static_cast<double>((texel >> shift) & 0xff); };
        sums[cell] += std::abs(channel(a.texels[i]) - channel(b.texels[i])) / 3;
      }
      ++counts[cell];
    }
  }
  for (std::size_t i = 0; i < sums.size(); ++i) sums[i] = std::round(1e3 * sums[i] / counts[i]) / 1e3;
  return sums;
}

/// Returns the picture data of a page that compares two runs: both pictures, and overlays of their differences.
Json pictures_json(const Difference& d) {
  const auto size = [](const ReportFile& report) {
    return std::pair{report.number("resolution[0]"), report.number("resolution[1]")};
  };
  if (size(d.a) != size(d.b)) {
    return {{"missing", "The pictures differ in size, so neither pictures nor tiles are compared."}};
  }
  Json grids = Json::array(), out = {{"type", "pair"}, {"id", "pictures-pair"}, {"title", "Both pictures"}};
  std::string note;
  add_tile_differences(d, grids, note);
  out.update({{"about", "Pictures of both runs"},
              {"width", size(d.a).first},
              {"height", size(d.a).second},
              {"a", nullptr},
              {"b", nullptr},
              {"names", {d.name_a, d.name_b}},
              {"note", note}});
  try {
    Picture first = read_picture(d.a), second = read_picture(d.b);
    if (first.pixels.width != second.pixels.width || first.pixels.height != second.pixels.height)
      throw sim::InputError("they differ in size");
    const std::vector<double> cells = cell_differences(first.pixels, second.pixels);
    if (const double most = std::ranges::max(cells); most > 0) {
      grids.push_back({{"id", "picture"},
                       {"name", "channels of the picture, mean distance in 255ths"},
                       {"tile", kCell},
                       {"unit", ""},
                       {"values", cells},
                       {"low", 0},
                       {"high", most}});
    }
    out.update({{"width", first.pixels.width},
                {"height", first.pixels.height},
                {"a", std::move(first.url)},
                {"b", std::move(second.url)}});
  } catch (const sim::InputError& error) {
    out["missing"] = fmt::format("The pictures are not shown: {}.", error.what());
  }
  out["grids"] = std::move(grids);
  return out;
}

/// Returns the data of a page about several runs, which compares each with the first:
///   names, titles   of all runs
///   against         entries of comparison_json() (schema raywatt-compare/1)
///   warnings        a list per entry
///   pictures        both pictures and their differences for each entry; `missing`: reason that there are none
Json diff_data(const std::vector<ReportFile>& reports, const std::vector<std::string>& names) {
  std::vector<Comparison> against;
  std::vector<std::string> titles;
  Json warnings = Json::array(), pictures = Json::array();
  for (const ReportFile& report : reports) titles.push_back(run_title(report));
  for (std::size_t i = 1; i < reports.size(); ++i) {
    against.push_back(compare(reports.front(), reports[i]));
    warnings.push_back(comparison_warnings({reports.front(), reports[i]}, {against.back()}));
    pictures.push_back(pictures_json({reports.front(), reports[i], names.front(), names[i]}));
  }
  return {{"names", names},
          {"titles", titles},
          {"against", comparison_json(reports, against)["against"]},
          {"warnings", std::move(warnings)},
          {"pictures", std::move(pictures)}};
}

namespace fs = std::filesystem;

/// Text near the start of a page that marks it as written by this program.
constexpr std::string_view kPageMark = "<meta name=\"generator\" content=\"raywatt report\">";

/// Scripts and style sheet of all pages, built by tools/report_page.
struct Bundle {
  std::string script;     ///< draws the page
  std::string libraries;  ///< third-party code, loaded after the first paint
  std::string style;
};

constexpr std::uint64_t kLargestScript = 16 << 20;
constexpr std::string_view kPicture = "data:image/png;base64,";

/// Returns a text in which certain characters are replaced by other text.
std::string escape_text(std::string_view text, std::initializer_list<std::pair<char, std::string_view>> replacements) {
  std::string out;
  for (const char c : text) {
    const auto* const found = std::ranges::find(replacements, c, &std::pair<char, std::string_view>::first);
    if (found == replacements.end()) {
      out += c;
    } else {
      out += found->second;
    }
  }
  return out;
}

/// Returns JSON that is safe inside an HTML script element: it cannot end the element or begin a comment.
std::string json_for_html(const Json& json) {
  return escape_text(sim::json_line(json), {{'<', "\\u003c"}, {'>', "\\u003e"}, {'&', "\\u0026"}});
}

/// Returns an entry of a content security policy that allows only the script or style `text`, by its hash.
std::string hash_source(std::string_view text) {
  std::array<unsigned char, SHA256_DIGEST_LENGTH> digest{};
  SHA256(reinterpret_cast<const unsigned char*>(text.data()), text.size(), digest.data());
  const std::string url = data_url("", {reinterpret_cast<const char*>(digest.data()), digest.size()});
  return fmt::format("'sha256-{}'", url.substr(url.find(',') + 1));
}

/// Moves the pictures from a page's data to `pictures` and replaces each by its index. Thus each picture is stored
/// once, and the page can be drawn before pictures are decoded.
void move_pictures(Json& node, Json& pictures) {
  if (node.is_structured()) {
    for (Json& child : node) move_pictures(child, pictures);
  } else if (node.is_string() && node.get_ref<const std::string&>().starts_with(kPicture)) {
    const auto found = std::ranges::find(pictures, node);
    const auto number = std::distance(pictures.begin(), found);
    if (found == pictures.end()) pictures.push_back(node);
    node = fmt::format("picture:{}", number);
  }
}

std::vector<fs::path> bundle_folders() {
  std::vector<fs::path> folders;
  for (const fs::path& folder : search_folders()) folders.push_back(folder / "report_page");
  std::error_code ignored;
  const fs::path binaries = build_info().binary_dir;
  if (fs::read_symlink("/proc/self/exe", ignored).string().starts_with(binaries.string() + "/"))
    folders.push_back(binaries / "report_page");
  return folders;
}

/// Throws if a script or style contains text that would end its HTML element or begin an HTML comment.
void check_inline(const Bundle& bundle) {
  const auto check = [](const std::string& text, const char* file, const char* end) {
    if (text.find(end) != std::string::npos)
      throw sim::InputError(fmt::format("report_page/{} contains '{}'; build it again", file, end));
  };
  for (const char* end : {"</script", "<!--"}) {
    check(bundle.script, "page.js", end);
    check(bundle.libraries, "libraries.js", end);
  }
  check(bundle.style, "page.css", "</style");
}

/// Returns a text with special HTML characters escaped.
std::string html_text(std::string_view text) {
  return escape_text(text, {{'<', "&lt;"}, {'>', "&gt;"}, {'&', "&amp;"}, {'"', "&quot;"}, {'\'', "&#39;"}});
}

/// Loads the scripts and style sheet of pages from the installation or the build folder. Throws InputError if missing.
Bundle load_bundle() {
  std::vector<std::string> tried;
  for (const fs::path& folder : bundle_folders()) {
    const auto has = [&](const char* name) {
      std::error_code ignored;
      return fs::is_regular_file(folder / name, ignored);
    };
    const auto read = [&](const char* name) { return sim::read_file(folder / name, kLargestScript); };
    if (has("page.js") && has("libraries.js") && has("page.css"))
      return {read("page.js"), read("libraries.js"), read("page.css")};
    tried.push_back(folder.string());
  }
  throw sim::InputError(
      fmt::format("the scripts of pages do not exist: page.js, libraries.js and page.css are in none of {}; a build "
                  "makes them if node and npm are installed and npm's registry is reachable",
                  fmt::join(tried, ", ")));
}

/// Returns a page as one HTML file that contains data, scripts, style and pictures. It loads nothing from the network.
/// Its content security policy allows only the bundle's scripts, by hash.
std::string page_html(const Bundle& bundle, const std::string& kind, const std::string& title, Json data) {
  check_inline(bundle);
  Json pictures = Json::array();
  for (const char* key : {"picture", "pictures", "film"}) {
    if (data.contains(key)) move_pictures(data[key], pictures);
  }
  const Json page = {
      {"schema", "raywatt-page/2"}, {"kind", kind}, {"title", sim::printable(title)}, {"data", std::move(data)}};
  const std::string policy = fmt::format(
      "default-src 'none'; script-src {} {}; style-src {}; img-src data: blob:; base-uri 'none'; form-action 'none'",
      hash_source(bundle.script), hash_source(bundle.libraries), hash_source(bundle.style));
  return fmt::format(
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n{}\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"{}\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta name=\"color-scheme\" content=\"light dark\">\n<title>{}</title>\n<style>{}</style>\n</head>\n<body>\n"
      "<noscript>This page draws its charts and tables by its own script, which the browser does not run.</noscript>\n"
      "<div id=\"page\"></div>\n<script type=\"application/json\" id=\"data\">{}</script>\n<script>{}</script>\n"
      "<script type=\"application/json\" id=\"picture-data\">{}</script>\n"
      "<script type=\"text/plain\" id=\"libraries\">{}</script>\n</body>\n</html>\n",
      kPageMark, html_text(policy), html_text(sim::printable(title)), bundle.style, json_for_html(page), bundle.script,
      json_for_html(pictures), bundle.libraries);
}

std::string page_of(const Bundle& bundle, const Options& options) {
  const std::vector<fs::path>& inputs = options.inputs;
  if (inputs.size() == 1 && is_sweep(inputs.front())) {
    sim::Json data = sweep_data(inputs.front());
    const std::string title = data["name"].get<std::string>();
    return page_html(bundle, "sweep", title, std::move(data));
  }
  std::vector<ReportFile> reports;
  for (const fs::path& path : inputs) {
    const std::string name = sim::printable(path.string());
    if (is_sweep(path)) {
      throw sim::InputError(fmt::format(
          "{}: is a sweep, which needs a page of its own; allowed: one sweep or search, or one or more runs", name));
    }
    std::error_code ignored;
    if (fs::is_directory(path, ignored) && !fs::exists(path / "report.json", ignored)) {
      throw sim::InputError(
          fmt::format("{}: holds no run, sweep or search: it has neither report.json nor sweep.json", name));
    }
    reports.push_back(load_report(path));
  }
  if (reports.size() == 1) return page_html(bundle, "run", run_title(reports[0]), run_data(reports[0]));
  const std::vector<std::string> names = options.names.empty() ? short_names(reports) : options.names;
  const std::string title =
      names.size() == 2 ? fmt::format("{} against {}", names[1], names[0]) : "Runs against " + names[0];
  return page_html(bundle, "diff", title, diff_data(reports, names));
}

}  // namespace

void write_report_page(const Options& options) {
  sim::check_output(options.out, {.mark = kPageMark, .kind = "page", .any = options.force});
  const Bundle bundle = load_bundle();
  sim::write_file_atomically(options.out, page_of(bundle, options));
}

}  // namespace tools::pages
