#include <array>
#include <csignal>
#include <string>
#include <string_view>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tools/cli/declared.h"
#include "tools/cli/verbs.h"
#include "tools/host/build_info.h"

namespace tools {
namespace {

/// Exit codes, as in the table of docs/verbs.md.
constexpr std::array<std::pair<int, std::string_view>, 8> kEndings = {{
    {kGood, "good"},
    {kCheckFailed,
     "it ran, but a check failed: a ray or a figure differs, points of a sweep failed, no point of a search meets the "
     "constraints"},
    {kBadInput,
     "bad input, an output that cannot be begun, or a processor without AVX2; one line says where, what was wrong and "
     "what is allowed. Nothing is written"},
    {kStuckMachine, "the simulated machine is stuck, or goes on and retires nothing; every unit's state is printed"},
    {kOurBug, "a bug of Raywatt"},
    {kIoFailed, "reading or writing failed, for instance a full disk, or the memory of the host ran out"},
    {128 + SIGINT, "interrupted (128 + the signal); what is finished is kept, marked partial, and named"},
    {128 + SIGTERM, "the same by SIGTERM"},
}};

/// Escapes text for roff.
std::string plain(std::string_view text) {
  std::string out;
  bool begins = true;
  for (const char c : text) {
    if (begins && (c == '.' || c == '\'')) out += "\\&";
    if (c == '\\') {
      out += "\\e";
    } else if (c == '-') {
      out += "\\-";
    } else {
      out += c;
    }
    begins = c == '\n';
  }
  return out;
}

std::string section(const DeclaredVerb& verb) {
  std::string out;
  if (verb.words.size() > 1) out += fmt::format(".SS {}\n", plain(fmt::format("{}", fmt::join(verb.words, " "))));
  out += plain(verb.help) + "\n";
  for (const DeclaredOption& option : verb.options) {
    out += fmt::format(".TP\n\\fB{}\\fR {}\n{}\n", plain(fmt::format("{}", fmt::join(option.names, ", "))),
                       plain(option.takes), plain(option.help));
  }
  if (!verb.footer.empty()) out += fmt::format(".PP\n.nf\n{}\n.fi\n", plain(verb.footer));
  return out;
}

std::string manual_page(const std::vector<DeclaredVerb>& verbs) {
  std::string out = fmt::format(".TH RAYWATT 1 \"\" \"raywatt {}\" \"User Commands\"\n", build_info().version);
  out += ".SH NAME\nraywatt \\- simulator of a mobile ray\\-tracing GPU\n.SH SYNOPSIS\n";
  out += ".B raywatt\nVERB [OPTIONS]\n.SH DESCRIPTION\n" + section(verbs.front()) + ".SH VERBS\n";
  for (std::size_t v = 1; v < verbs.size(); ++v) out += section(verbs[v]);
  out +=
      ".SH ENVIRONMENT\n.TP\n\\fBRAYWATT_PATH\\fR\nfolders of configurations, workloads and scenes, separated by "
      "colons, that are looked through first\n.TP\n\\fBRAYWATT_STORE\\fR\nfolder of the results of sweeps\n"
      ".SH EXIT STATUS\n";
  for (const auto& [exit, meaning] : kEndings) out += fmt::format(".TP\n{}\n{}\n", exit, plain(meaning));
  return out;
}

}  // namespace

void add_man(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("man", "The manual page: every verb with its options");
  verb->footer("Example: raywatt man | man -l -");
  verb->callback([&app] { fmt::print("{}", manual_page(declared_verbs(app))); });
}

}  // namespace tools
