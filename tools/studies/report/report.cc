#include "tools/studies/report/report.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <iterator>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <openssl/sha.h>

#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/printable.h"
#include "tools/host/build_info.h"
#include "tools/host/paths.h"
#include "tools/studies/compare/compare.h"
#include "tools/studies/report/page_data.h"
#include "tools/studies/report/pictures.h"

namespace tools::pages {
namespace {

using sim::Json;
namespace fs = std::filesystem;

/// Identifies pages that we write, within their first bytes.
constexpr std::string_view kPageMark = "<meta name=\"generator\" content=\"raywatt report\">";

/// Scripts and style of all pages, made by tools/report_page.
struct Bundle {
  std::string script;     ///< draws the page
  std::string libraries;  ///< third-party code, loaded after the first paint
  std::string style;
};

constexpr std::uint64_t kLargestScript = 16 << 20;
constexpr std::string_view kPicture = "data:image/png;base64,";

/// Replaces characters by other text.
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

/// Returns JSON for a script element: no text in it can end the element or begin a comment.
std::string json_for_html(const Json& json) {
  return escape_text(sim::json_line(json), {{'<', "\\u003c"}, {'>', "\\u003e"}, {'&', "\\u0026"}});
}

/// Returns a source of a content security policy that allows only this text.
std::string hash_source(std::string_view text) {
  std::array<unsigned char, SHA256_DIGEST_LENGTH> digest{};
  SHA256(reinterpret_cast<const unsigned char*>(text.data()), text.size(), digest.data());
  const std::string url = data_url("", {reinterpret_cast<const char*>(digest.data()), digest.size()});
  return fmt::format("'sha256-{}'", url.substr(url.find(',') + 1));
}

/// Moves pictures from the data into a list and replaces them by their numbers. Each is stored once, and the page is
/// drawn before they are read.
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

/// Throws if the text of an inline element would end it, or begin a comment.
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

/// Escapes text for HTML.
std::string html_text(std::string_view text) {
  return escape_text(text, {{'<', "&lt;"}, {'>', "&gt;"}, {'&', "&amp;"}, {'"', "&quot;"}, {'\'', "&#39;"}});
}

/// Loads the bundle from where the program is installed or was built. InputError if it does not exist.
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

/// Returns the page as one file with data, script, style and pictures. It fetches nothing, and its content security
/// policy allows only the bundle's scripts, by hash.
std::string page_html(const Bundle& bundle, const std::string& kind, const std::string& title, Json data) {
  check_inline(bundle);
  Json pictures = Json::array();
  for (const char* key : {"picture", "pictures"}) {
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

std::string page_of(const Bundle& bundle, const std::vector<fs::path>& inputs) {
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
  const std::vector<std::string> names = short_names(reports);
  const std::string title =
      names.size() == 2 ? fmt::format("{} against {}", names[1], names[0]) : "Runs against " + names[0];
  return page_html(bundle, "diff", title, diff_data(reports));
}

}  // namespace

void write_report_page(const Options& options) {
  sim::check_output(options.out, {.mark = kPageMark, .kind = "page", .any = options.force});
  const Bundle bundle = load_bundle();
  sim::write_file_atomically(options.out, page_of(bundle, options.inputs));
}

}  // namespace tools::pages
