#pragma once
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "sim/io/json.h"

namespace tools::pages {

using sim::Json;

/// How people read the values of a column.
enum class Show : std::uint8_t {
  kText,
  kNumber,   ///< four digits
  kSi,       ///< four digits with a metric prefix
  kPercent,  ///< a share of 1
};

struct Column {
  std::string field, title;
  Show show = Show::kText;
  std::string unit = {};
};

/// Rows that charts, tables and downloads of a page share.
class Dataset {
 public:
  explicit Dataset(std::vector<Column> columns) : columns_(std::move(columns)) {}
  void row(std::vector<Json> cells) { rows_.push_back(std::move(cells)); }
  bool empty() const { return rows_.empty(); }
  Json json() const;

 private:
  std::vector<Column> columns_;
  std::vector<Json> rows_;
};

/// A figure that people look at first. Low and high are null where there is no band.
struct Headline {
  std::string id, name;
  Json value;
  Show show = Show::kNumber;
  std::string unit = {};
  Json low = {}, high = {};
  std::string note = {};  ///< what the band is, or what the figure means
};

/// A part of a page under a heading of its own. Its id is what links name.
class Section {
 public:
  Section(std::string id, std::string title, std::string lead = {});

  void text(std::string words);
  /// A chart of a dataset. `about` describes it for screen readers; `chart` holds its kind and options
  /// (tools/report_page/src/specs.js).
  void chart(std::string id, std::string title, std::string about, std::string dataset, Json chart);
  void table(std::string id, std::string title, std::string dataset);
  /// A block of another type, which a script of that name draws.
  void block(std::string type, std::string id, std::string title, Json more);
  const Json& json() const { return json_; }

 private:
  Json json_;
};

/// All that a page shows of one subject, before anybody has drawn it: a run, a pair of runs, a sweep.
class View {
 public:
  explicit View(std::string name);

  /// The first sentence, what qualifies it, and links {words, id of a section}.
  void verdict(std::string sentence, std::string more, std::vector<std::pair<std::string, std::string>> links);
  void fact(std::string name, std::string value);
  void notice(std::string words);
  void headline(const Headline& figure);
  void data(const std::string& name, const Dataset& rows) { json_["data"][name] = rows.json(); }
  void add(const Section& section) { json_["sections"].push_back(section.json()); }
  const Json& json() const { return json_; }
  std::string name() const { return json_["name"].get<std::string>(); }

 private:
  Json json_;
};

// Reports come from outside: nothing is taken for granted.
/// Value at a path of keys; null if there is nothing.
const Json& at(const Json& json, std::initializer_list<std::string_view> keys);
/// A number at a path; `otherwise` if there is none.
double number_at(const Json& json, std::initializer_list<std::string_view> keys, double otherwise = 0);
/// A text at a path, printable; empty if there is none.
std::string text_at(const Json& json, std::initializer_list<std::string_view> keys);

/// A number of four digits: "1.253", "31.9 k".
std::string number_text(double value);

/// So many of what `one` names: "1 core", "4 cores", "31.9 k triangles".
std::string counted(double count, std::string_view one);

/// Share in percent with as many digits as a reader uses: "53.7 %".
std::string percent_text(double share);

}  // namespace tools::pages
