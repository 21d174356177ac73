#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "tools/studies/report/page/page_model.h"

namespace tools::pages {

/// Stands in every page that we write, near its beginning.
inline constexpr std::string_view kPageMark = "<meta name=\"generator\" content=\"raywatt report\">";

/// Scripts and style of all pages, made by tools/report_page.
struct Bundle {
  std::string script;     ///< draws the page
  std::string libraries;  ///< those of others, which it reads when the page has been painted
  std::string style;
};
/// Looks for it where an installed program has it, then where it was built. InputError if it is not there.
Bundle load_bundle();

/// The page as one file: views, script, style and pictures. Nothing in it is fetched, and nothing but the bundle's
/// script runs: the policy names its hash, and what comes from reports is data.
std::string page_html(const Bundle& bundle, const std::string& kind, const std::string& title,
                      const std::vector<View>& views);

/// Bytes of a file as a data: URL.
std::string data_url(std::string_view mime, std::string_view bytes);

/// Text as HTML shows it.
std::string html_text(std::string_view text);

}  // namespace tools::pages
