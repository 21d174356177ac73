#include "tools/studies/sweep/results/index/collect.h"

#include <algorithm>
#include <chrono>
#include <iterator>
#include <numeric>
#include <optional>
#include <thread>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/printable.h"
#include "sim/sha256.h"
#include "tools/studies/sweep/results/index/csv.h"
#include "tools/studies/sweep/results/index/index_file.h"
#include "tools/studies/sweep/spec/magnitude.h"

namespace tools::results {
namespace {

namespace fs = std::filesystem;

/// Held while an index is made.
sweep::Lock wait_for_lock(const fs::path& file) {
  for (;;) {
    if (std::optional<sweep::Lock> lock = sweep::Lock::attempt(file)) return std::move(*lock);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

/// Changes with everything that an index is made from.
std::string made_from(const std::vector<ListedPoint>& points, const sweep::Store& store) {
  sim::Sha256 all;
  all.add(fmt::format("{}\n{}\n", kIndexSchema, store.root().string()));
  for (const ListedPoint& point : points) {
    all.add(fmt::format("{} {}\n", point.n, point.id));
    for (const auto& [name, value] : point.axes) all.add(fmt::format("{}\n{}\n", name, value));
    all.add(state_mark(store, point.id) + "\n");
  }
  return all.hex_digest();
}

/// Contents of the index, if it and the table are as they were left and nothing has happened since.
std::optional<Collected> still_true(const fs::path& sweep, const std::string& made_from) {
  try {
    Database index = open_index(sweep / "index.sqlite");
    const SweepFacts facts = read_facts(index);
    const auto is = [&](const char* key, const std::string& value) {
      const auto found = facts.find(key);
      return found != facts.end() && found->second == value;
    };
    if (!is("made_from", made_from) || !is("csv", file_mark(sweep / "results.csv"))) return std::nullopt;
    Collected counts;
    Statement count = index.prepare("SELECT status, COUNT(*) FROM points GROUP BY status");
    while (count.step()) {
      const auto number = static_cast<std::size_t>(count.number(1));
      const std::string status = count.text(0);
      (status == "done"      ? counts.done
       : status == "failed"  ? counts.failed
       : status == "missing" ? counts.missing
                             : counts.damaged) = number;
    }
    counts.unchanged = true;
    return counts;
  } catch (const sim::InputError&) {
    return std::nullopt;
  } catch (const SqliteError&) {
    return std::nullopt;
  }
}

}  // namespace

Collected collect(const sweep::SweepFolder& folder) {
  const fs::path& path = folder.path();
  const sweep::Lock lock = wait_for_lock(path / "collect.lock");
  std::vector<ListedPoint> points = list_points(folder.points());
  if (points.empty()) throw sim::InputError(sim::printable((path / "points.jsonl").string()) + ": holds no point");
  const sweep::Store store = folder.store();
  const std::string from = made_from(points, store);
  if (const std::optional<Collected> counts = still_true(path, from)) return *counts;

  const Collection all = collect_points(std::move(points), store);
  sim::write_file_atomically(path / "results.csv", results_csv(all));
  sim::write_file_atomically(path / "index.sqlite", index_bytes(all, {{"store", store.root().string()},
                                                                      {"made_from", from},
                                                                      {"csv", file_mark(path / "results.csv")}}));
  Collected counts;
  for (const PointState& state : all.states) {
    switch (state.status) {
      case Status::kDone:
        ++counts.done;
        break;
      case Status::kFailed:
        ++counts.failed;
        break;
      case Status::kMissing:
        ++counts.missing;
        break;
      case Status::kDamaged:
        ++counts.damaged;
        break;
    }
  }
  return counts;
}

std::string summary_text(const Collected& collected) {
  std::string text = fmt::format("{} points: {} done", collected.points(), collected.done);
  if (collected.failed != 0) text += fmt::format(", {} failed", collected.failed);
  if (collected.damaged != 0) text += fmt::format(", {} damaged", collected.damaged);
  if (collected.missing != 0) text += fmt::format(", {} missing", collected.missing);
  return text;
}

namespace {

/// An axis whose values have a unit: its numbers stand in a column of their own, in the base unit that its name ends
/// with.
struct Quantity {
  std::size_t axis = 0;
  const char* unit = "";
};

/// Text of an axis at a point; empty if it has no such axis.
std::string value_at(const ListedPoint& point, const std::string& axis) {
  const auto found = std::ranges::find(point.axes, axis, &std::pair<std::string, std::string>::first);
  return found == point.axes.end() ? std::string() : found->second;
}

std::vector<Quantity> quantities_of(const Collection& all) {
  std::vector<Quantity> out;
  for (std::size_t a = 0; a < all.axes.size(); ++a) {
    for (const ListedPoint& point : all.points) {
      const std::optional<sweep::Magnitude> number = sweep::magnitude_of(value_at(point, all.axes[a]));
      using Kind = sweep::Magnitude::Kind;
      if (!number || number->kind == Kind::kNumber) continue;
      out.push_back({a, number->kind == Kind::kBytes ? "bytes" : number->kind == Kind::kTime ? "fs" : "hz"});
      break;
    }
  }
  return out;
}

/// Indices of names in their alphabetical order.
std::vector<std::size_t> sorted(const std::vector<std::string>& names) {
  std::vector<std::size_t> order(names.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t i) -> const std::string& { return names[i]; });
  return order;
}

}  // namespace

std::string results_csv(const Collection& all) {
  std::vector<std::string> header = {"n", "id", "status"};
  header.insert(header.end(), all.axes.begin(), all.axes.end());
  const std::vector<Quantity> quantities = quantities_of(all);
  for (const Quantity& q : quantities) header.push_back(fmt::format("{}_{}", all.axes[q.axis], q.unit));
  const std::vector<std::size_t> order = sorted(all.metrics);
  for (const std::size_t m : order) header.push_back(all.metrics[m]);
  std::string out = csv_line(header);
  for (std::size_t i = 0; i < all.points.size(); ++i) {
    const ListedPoint& point = all.points[i];
    out += fmt::format("{},{},{}", point.n, point.id, name_of(all.states[i].status));
    for (const std::string& axis : all.axes) out += "," + csv_cell(value_at(point, axis));
    for (const Quantity& q : quantities) {
      const std::optional<sweep::Magnitude> number = sweep::magnitude_of(value_at(point, all.axes[q.axis]));
      out += number ? fmt::format(",{}", number->value) : ",";
    }
    for (const std::size_t m : order) {
      const Value& cell = all.columns[m][i];
      out += ',';
      if (const auto* text = std::get_if<std::string>(&cell)) {
        out += csv_cell(*text);
      } else if (const auto* whole = std::get_if<std::int64_t>(&cell)) {
        fmt::format_to(std::back_inserter(out), "{}", *whole);
      } else if (const auto* real = std::get_if<double>(&cell)) {
        fmt::format_to(std::back_inserter(out), "{}", *real);
      }
    }
    out += '\n';
  }
  return out;
}

}  // namespace tools::results
