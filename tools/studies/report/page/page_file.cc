#include "tools/studies/report/page/page_file.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <openssl/evp.h>
#include <openssl/sha.h>

#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "tools/host/build_info.h"
#include "tools/host/paths.h"

namespace tools::pages {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kLargestScript = 16 << 20;
constexpr std::string_view kPicture = "data:image/png;base64,";

std::string base64(std::string_view bytes) {
  std::string out(4 * ((bytes.size() + 2) / 3) + 1, '\0');
  const int length =
      EVP_EncodeBlock(reinterpret_cast<unsigned char*>(out.data()),
                      reinterpret_cast<const unsigned char*>(bytes.data()), static_cast<int>(bytes.size()));
  out.resize(static_cast<std::size_t>(length));
  return out;
}

/// A source of a content security policy that allows this text alone.
std::string hash_source(std::string_view text) {
  std::array<unsigned char, SHA256_DIGEST_LENGTH> digest{};
  SHA256(reinterpret_cast<const unsigned char*>(text.data()), text.size(), digest.data());
  return "'sha256-" + base64({reinterpret_cast<const char*>(digest.data()), digest.size()}) + "'";
}

/// JSON within a script element: no text of it can end the element or begin a comment.
std::string json_for_html(const Json& json) {
  std::string out;
  for (const char c : sim::json_line(json)) {
    switch (c) {
      case '<':
        out += "\\u003c";
        break;
      case '>':
        out += "\\u003e";
        break;
      case '&':
        out += "\\u0026";
        break;
      default:
        out += c;
    }
  }
  return out;
}

/// Moves pictures from the model into a list, and leaves their numbers: each is there once, and the page's script can
/// draw the rest before they are read.
void take_pictures(Json& node, Json& pictures) {
  if (node.is_structured()) {
    for (Json& child : node) take_pictures(child, pictures);
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

/// Text of an element must not end it, nor begin a comment within which nothing ends it.
void check_inline(const Bundle& bundle) {
  const auto has = [](const std::string& text, const char* word) { return text.find(word) != std::string::npos; };
  for (const std::string* script : {&bundle.script, &bundle.libraries}) {
    if (has(*script, "</script") || has(*script, "<!--"))
      throw sim::InputError("the scripts of pages do not stand within a page; build them anew");
  }
  if (has(bundle.style, "</style")) throw sim::InputError("the style of pages does not stand within a page");
}

}  // namespace

Bundle load_bundle() {
  std::vector<std::string> looked;
  for (const fs::path& folder : bundle_folders()) {
    const auto has = [&](const char* name) {
      std::error_code ignored;
      return fs::is_regular_file(folder / name, ignored);
    };
    const auto read = [&](const char* name) { return sim::read_file(folder / name, kLargestScript); };
    if (has("page.js") && has("libraries.js") && has("page.css"))
      return {read("page.js"), read("libraries.js"), read("page.css")};
    looked.push_back(folder.string());
  }
  throw sim::InputError(
      fmt::format("the scripts of pages are not there: page.js, libraries.js and page.css are in none of {}; a build "
                  "makes them where node and npm are installed and npm's registry is reached, all else works without",
                  fmt::join(looked, ", ")));
}

std::string html_text(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '&':
        out += "&amp;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string data_url(std::string_view mime, std::string_view bytes) {
  return fmt::format("data:{};base64,{}", mime, base64(bytes));
}

std::string page_html(const Bundle& bundle, const std::string& kind, const std::string& title,
                      const std::vector<View>& views) {
  check_inline(bundle);
  Json data = {
      {"schema", "raywatt-page/1"}, {"kind", kind}, {"title", sim::printable(title)}, {"views", Json::array()}};
  Json pictures = Json::array();
  for (const View& view : views) {
    Json json = view.json();
    for (Json& section : json["sections"]) take_pictures(section["blocks"], pictures);
    data["views"].push_back(std::move(json));
  }
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
      kPageMark, html_text(policy), html_text(sim::printable(title)), bundle.style, json_for_html(data), bundle.script,
      json_for_html(pictures), bundle.libraries);
}

}  // namespace tools::pages
