#pragma once
#include <string>
#include <string_view>

#include "sim/io/json.h"

namespace tools::pages {

/// Identifies pages that we write, within their first bytes.
inline constexpr std::string_view kPageMark = "<meta name=\"generator\" content=\"raywatt report\">";

/// Scripts and style of all pages, made by tools/report_page.
struct Bundle {
  std::string script;     ///< draws the page
  std::string libraries;  ///< third-party code, loaded after the first paint
  std::string style;
};
/// Loads the bundle from where the program is installed or was built. InputError if it does not exist.
Bundle load_bundle();

/// Returns the page as one file with data, script, style and pictures. It fetches nothing, and its content security
/// policy allows only the bundle's scripts, by hash.
std::string page_html(const Bundle& bundle, const std::string& kind, const std::string& title, sim::Json data);

}  // namespace tools::pages
