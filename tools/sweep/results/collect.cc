#include "tools/sweep/results/collect.h"

#include <cerrno>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/printable.h"
#include "sim/sha256.h"
#include "tools/sweep/results/index_file.h"
#include "tools/sweep/results/results_csv.h"

namespace tools::results {

namespace fs = std::filesystem;

namespace {

constexpr std::uint64_t kMostListBytes = std::uint64_t{1} << 30;

/// Held while an index is made. The kernel frees it when the process ends, however that happens.
class CollectorLock {
 public:
  explicit CollectorLock(const fs::path& file) : fd_(::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666)) {
    struct flock whole {};
    whole.l_type = F_WRLCK;
    whole.l_whence = SEEK_SET;
    int result = fd_;
    while (fd_ >= 0 && (result = ::fcntl(fd_, F_OFD_SETLKW, &whole)) != 0 && errno == EINTR) {
    }
    if (result < 0) {
      const int error = errno;
      if (fd_ >= 0) ::close(fd_);
      throw sim::IoError(fmt::format("{}: cannot be locked: {}", sim::printable(file.string()),
                                     std::generic_category().message(error)));
    }
  }
  ~CollectorLock() { ::close(fd_); }
  CollectorLock(const CollectorLock&) = delete;
  CollectorLock& operator=(const CollectorLock&) = delete;

 private:
  int fd_;
};

/// Changes with everything that an index is made from.
std::string made_from(const std::string& list, const std::vector<ListedPoint>& points, const fs::path& store) {
  sim::Sha256 all;
  all.add(fmt::format("{}\n{}\n{}\n", kIndexSchema, store.string(), list));
  for (const ListedPoint& point : points) all.add(state_mark(store, point.id) + "\n");
  return all.hex();
}

/// What the index says, if it and the table are as they were left and nothing has happened since.
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

Collected collect(const fs::path& sweep, const fs::path& store) {
  const fs::path list_file = sweep / "points.jsonl";
  const std::string shown = sim::printable(list_file.string());
  if (!fs::exists(list_file)) {
    throw sim::InputError(fmt::format("{}: no such file: the folder holds no sweep", shown));
  }
  const fs::path where = fs::absolute(store).lexically_normal();
  const CollectorLock lock(sweep / ".collect.lock");
  const std::string list = sim::read_file(list_file, kMostListBytes);
  std::vector<ListedPoint> points = parse_point_list(list, shown);
  const std::string from = made_from(list, points, where);
  if (const std::optional<Collected> counts = still_true(sweep, from)) return *counts;

  const Collection all = collect_points(std::move(points), where);
  sim::write_file_atomically(sweep / "results.csv", results_csv(all));
  sim::write_file_atomically(
      sweep / "index.sqlite",
      index_bytes(all, {{"store", where.string()}, {"made_from", from}, {"csv", file_mark(sweep / "results.csv")}}));
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

}  // namespace tools::results
