#include <sstream>

#include <fmt/format.h>
#include <pugixml.hpp>

#include "sim/io/file.h"
#include "sim/io/printable.h"
#include "tools/studies/baseline/check.h"

namespace tools {
namespace {

constexpr std::size_t kLongest = 1000;

/// XML has no place for control characters and broken UTF-8.
std::string clean(const std::string& text) { return sim::printable(text, kLongest); }

/// All that is to be said of a run that is not good.
std::string body(const RunCheck& run) {
  std::string out;
  std::istringstream error(run.error);
  for (std::string line; std::getline(error, line);) out += clean(line) + "\n";
  for (const std::string& why : run.refused) out += clean(why) + "\n";
  std::istringstream keys(changed_text(run.keys.changed) + changed_text(run.keys.of_one));
  for (std::string line; std::getline(keys, line);) out += clean(line) + "\n";
  if (run.names_unit()) out += clean(located_text(run)) + "\n";
  for (const Moved& moved : run.moved) out += clean(fmt::format("{}: {}", moved.path, moved_text(moved))) + "\n";
  return out;
}

constexpr const char* kMadeBy = " made by raywatt baseline check ";

}  // namespace

void check_junit(const std::filesystem::path& file, bool force) {
  sim::check_output(file, {.mark = kMadeBy, .kind = "JUnit file of this verb", .any = force});
}

void write_junit(const std::filesystem::path& file, const Suite& suite, const Checked& checked) {
  pugi::xml_document document;
  pugi::xml_node declaration = document.append_child(pugi::node_declaration);
  declaration.append_attribute("version") = "1.0";
  declaration.append_attribute("encoding") = "UTF-8";
  document.append_child(pugi::node_comment).set_value(kMadeBy);
  pugi::xml_node root = document.append_child("testsuite");
  std::size_t failures = 0, errors = 0;
  double seconds = 0;
  for (const RunCheck& run : checked.runs) {
    const bool is_error = !run.error.empty() || !run.refused.empty();
    errors += is_error ? 1 : 0;
    failures += !is_error && !run.moved.empty() ? 1 : 0;
    seconds += run.seconds;
  }
  root.append_attribute("name") = clean(suite.name()).c_str();
  root.append_attribute("tests") = checked.runs.size();
  root.append_attribute("failures") = failures;
  root.append_attribute("errors") = errors;
  root.append_attribute("time") = fmt::format("{:.3f}", seconds).c_str();
  for (const RunCheck& run : checked.runs) {
    pugi::xml_node test = root.append_child("testcase");
    test.append_attribute("classname") = clean(suite.name()).c_str();
    test.append_attribute("name") = clean(run.name).c_str();
    test.append_attribute("time") = fmt::format("{:.3f}", run.seconds).c_str();
    if (run.good()) continue;
    pugi::xml_node problem = test.append_child(run.error.empty() && run.refused.empty() ? "failure" : "error");
    problem.append_attribute("message") = clean(check_line(run)).c_str();
    problem.append_attribute("type") = !run.error.empty() ? "failed" : !run.refused.empty() ? "refused" : "moved";
    problem.append_child(pugi::node_pcdata).set_value(body(run).c_str());
  }
  std::ostringstream text;
  document.save(text, "  ");
  sim::write_file_atomically(file, text.str());
}

}  // namespace tools
