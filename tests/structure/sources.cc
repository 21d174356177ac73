#include "tests/structure/sources.h"

#include <cctype>
#include <regex>

#include "tests/structure/repository.h"

namespace test {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kBlanks = " \t";

/// Returns the index after the literal that begins at `at`, or the end of the line.
std::size_t end_of_literal(const std::string& line, std::size_t at) {
  const char quote = line[at];
  for (std::size_t i = at + 1; i < line.size(); ++i) {
    if (line[i] == '\\') {
      ++i;
    } else if (line[i] == quote) {
      return i + 1;
    }
  }
  return line.size();
}

/// True if a literal begins at `at`. An apostrophe between digits is part of a number.
bool begins_literal(const std::string& line, std::size_t at) {
  if (line[at] == '"') return true;
  return line[at] == '\'' && (at == 0 || std::isalnum(static_cast<unsigned char>(line[at - 1])) == 0);
}

void take_line_apart(const std::string& line, SourceText& text, bool& goes_on) {
  std::size_t at = 0;
  const bool alone = line.find_first_not_of(kBlanks) == line.find("//");
  while (at < line.size()) {
    if (line.compare(at, 2, "//") == 0) {
      const std::size_t begin = line.find_first_not_of("/<! \t", at);
      const std::string comment = begin == std::string::npos ? "" : line.substr(begin);
      if (goes_on && alone && !comment.empty()) {
        text.comments.back() += " " + comment;
      } else {
        text.comments.push_back(comment);
      }
      goes_on = alone;
      return;
    }
    if (begins_literal(line, at)) {
      at = end_of_literal(line, at);
      text.code += "\"\"";
    } else {
      text.code += line[at++];
    }
  }
  goes_on = false;
}

}  // namespace

std::vector<Include> includes() {
  static const std::regex kInclude("^\\s*#\\s*include\\s*\"([^\"]+)\".*");
  std::vector<Include> found;
  for (const fs::path& file : source_files()) {
    int number = 0;
    for (const std::string& line : lines_of(file)) {
      ++number;
      std::smatch match;
      if (!line.starts_with('#') || !std::regex_match(line, match, kInclude)) continue;
      for (const fs::path& to : {(file.parent_path() / match[1].str()).lexically_normal(), fs::path(match[1].str())}) {
        if (!fs::exists(repository() / to)) continue;
        found.push_back({file, to, file.string() + ":" + std::to_string(number)});
        break;
      }
    }
  }
  return found;
}

SourceText split_code_and_comments(const fs::path& file) {
  SourceText text;
  bool goes_on = false;
  for (const std::string& line : lines_of(file)) {
    take_line_apart(line, text, goes_on);
    text.code += '\n';
  }
  return text;
}

}  // namespace test
