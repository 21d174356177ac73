#include <algorithm>
#include <array>
#include <cctype>
#include <string>

#include <gtest/gtest.h>

#include "tests/structure/repository.h"
#include "tests/structure/sources.h"

// Tests that retired words and phrases occur in no source. docs/glossary.md has the words to use. Names in strings,
// which users see, are not tested.

namespace test {
namespace {

namespace fs = std::filesystem;

/// A retired word and its replacement.
struct Retired {
  std::string_view word, now;
  std::string_view below = "";  ///< folder in which it is retired; empty: everywhere
};

/// Words that are retired in code and in comments.
constexpr std::array kWords = {
    Retired{"islands", "partitions"},
    Retired{"Islands", "Partitions"},
    Retired{"freeze", "stall", "hw_models"},
    Retired{"thaw", "resume"},
    Retired{"take_line", "fill"},
    Retired{"touch_cache", "issue_loads"},
    Retired{"pass_hits", "issue_loads_that_hit"},
    Retired{"forked_", "both_children_hit_"},
    Retired{"DramForms", "DramClosedForms"},
    Retired{"DramFigures", "DramMeasurements"},
    Retired{"MatteRecord", "DiffuseRecord"},
    Retired{"OpticsRecord", "SpecularRecord"},
    Retired{"OfferedTiles", "RunTiles"},
    Retired{"scene_sheet", "scene_info"},
    Retired{"pronounce", "write_verdict"},
    Retired{"miss register", "MSHR"},
    Retired{"miss registers", "MSHRs"},
    Retired{"test bench", "harness"},
};

/// Identifiers that are retired in code. In comments they are ordinary words.
constexpr std::array kIdentifiers = {
    Retired{"horizon", "lookahead", "sim"},
    Retired{"horizon", "lookahead", "hw_models"},
    Retired{"Wheel", "TimingWheel", "hw_models"},
    Retired{"Pieces", "SectorMask", "hw_models"},
    Retired{"Why", "CycleReason"},
    Retired{"pick", "round_robin", "hw_models"},
    Retired{"held", "short_stack_size", "hw_models"},
    Retired{"stacked", "stack_depth", "hw_models"},
    Retired{"Plan", "ScheduledCommand", "hw_models"},
    Retired{"floors", "rank_ready", "hw_models"},
    Retired{"mixed", "lerp", "shader_kernels"},
    Retired{"either", "logical_or"},
    Retired{"split", "div_mod", "shader_kernels"},
    Retired{"Between", "SampleNeighbours"},
    Retired{"Demands", "FrameRequirements", "shader_kernels"},
    Retired{"Keep", "RetainedRecords"},
};

bool is_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

/// Returns the index of a whole word in a text, or npos.
std::size_t find_word(const std::string& text, std::string_view word) {
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
    const std::size_t end = at + word.size();
    if ((at == 0 || !is_word(text[at - 1])) && (end == text.size() || !is_word(text[end]))) return at;
  }
  return std::string::npos;
}

bool is_below(const fs::path& file, std::string_view folder) {
  return folder.empty() || file.generic_string().starts_with(std::string(folder) + "/");
}

/// Returns all source files except those of this folder, whose lists contain the words.
std::vector<fs::path> sources_with_words() {
  std::vector<fs::path> files = source_files();
  std::erase_if(files, [](const fs::path& file) { return is_below(file, "tests/structure"); });
  return files;
}

TEST(Words, ThatAreRetiredAreInNoSource) {
  for (const fs::path& file : sources_with_words()) {
    const SourceText text = split_code_and_comments(file);
    for (const Retired& retired : kWords) {
      if (!is_below(file, retired.below)) continue;
      EXPECT_EQ(find_word(text.code, retired.word), std::string::npos)
          << file.string() << ": " << retired.word << " is " << retired.now << " now";
      for (const std::string& comment : text.comments) {
        EXPECT_EQ(find_word(comment, retired.word), std::string::npos)
            << file.string() << ": " << retired.word << " is " << retired.now << " now: " << comment;
      }
    }
    for (const Retired& retired : kIdentifiers) {
      if (!is_below(file, retired.below)) continue;
      EXPECT_EQ(find_word(text.code, retired.word), std::string::npos)
          << file.string() << ": " << retired.word << " is " << retired.now << " now";
    }
  }
}

/// Phrases that no comment, page or message may contain; CONTRIBUTING.md has replacements.
constexpr std::array kPhrases = {"nobody",    "somebody",    "whoever",     "foresees", "foresee",
                                 "told",      "likewise",    "anew",        "so many",  "so much",
                                 "as may be", "as often as", "has come to", "of which", "is over since"};

/// True for text files that people read: sources, pages, configurations and scripts.
bool is_read(const fs::path& file) {
  const std::string type = file.extension().string(), name = file.filename().string();
  const bool script = type.empty() && (is_below(file, "tools") || is_below(file, "docs") || is_below(file, ".ci"));
  constexpr std::array kTypes = {".h", ".cc", ".md", ".yaml", ".txt", ".cmake", ".sh", ".py", ".js", ".mjs", ".css"};
  return (script || std::ranges::find(kTypes, type) != kTypes.end()) && !is_below(file, "tests/fuzz/corpus") &&
         file != "tests/structure/words_test.cc" && name != "LICENSE";
}

TEST(Words, OfTheRetiredStyleAreInNoText) {
  std::size_t files = 0;
  for (const fs::path& file : repository_files()) {
    if (!is_read(file)) continue;
    ++files;
    std::size_t number = 0;
    for (std::string line : lines_of(file)) {
      ++number;
      std::ranges::transform(line, line.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
      for (const std::string_view phrase : kPhrases) {
        EXPECT_EQ(find_word(line, phrase), std::string::npos) << file.string() << ":" << number << ": " << phrase;
      }
    }
  }
  EXPECT_GT(files, 500U) << "the scan finds the texts";
}

}  // namespace
}  // namespace test
