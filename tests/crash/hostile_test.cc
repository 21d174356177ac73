#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <map>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "sim/hash.h"
#include "tests/tools/program.h"

// Tests verbs on damaged files: folders of runs and sweeps, traces, and inputs of pages. Every verb must end in time
// and within its memory, return one of its exit codes, and lose no data.

namespace test {
namespace {

namespace fs = std::filesystem;

/// Random number generator for the damage to one folder.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : seed_(seed) {}
  std::uint64_t below(std::uint64_t end) { return sim::hash(seed_, n_++) % end; }

 private:
  const std::uint64_t seed_;
  std::uint64_t n_ = 0;
};

using Files = std::map<std::string, std::string>;

/// Returns the regular files below a folder, by name.
Files files_in(const fs::path& folder) {
  Files files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_symlink() && entry.is_regular_file()) {
      files[entry.path().lexically_relative(folder).string()] = read_bytes(entry.path());
    }
  }
  return files;
}

std::size_t random_place(const std::string& bytes, Dice& dice) { return dice.below(bytes.size() + 1); }

/// Returns file contents with random damage of a kind that readers may handle badly.
std::string damaged(std::string bytes, const std::string& of_another, Dice& dice) {
  const std::size_t at = random_place(bytes, dice);
  switch (dice.below(10)) {
    case 0:
      return "";
    case 1:
      return bytes.substr(0, at);
    case 2:
      return bytes.substr(at) + bytes.substr(0, at);
    case 3:
      return bytes + bytes;
    case 4:
      return of_another;
    case 5:
      return std::string(100'000, '[');
    case 6: {  // replaces a number by an impossible one
      const std::size_t digit = bytes.find_first_of("0123456789", at);
      if (digit == std::string::npos) return bytes;
      constexpr const char* kNumbers[] = {"1e300", "-1", "18446744073709551616", "1e999", "0", "NaN", "4294967296"};
      return bytes.replace(digit, 1, kNumbers[dice.below(std::size(kNumbers))]);
    }
    case 7: {  // repeats a piece elsewhere
      const std::string piece = bytes.substr(at, 1 + dice.below(4000));
      return bytes.insert(random_place(bytes, dice), piece);
    }
    case 8:
      return bytes.erase(at, 1 + dice.below(200));
    default:
      for (std::uint64_t flips = 1 + dice.below(20); flips != 0 && !bytes.empty(); --flips) {
        bytes[dice.below(bytes.size())] = static_cast<char>(dice.below(256));
      }
      return bytes;
  }
}

void write(const fs::path& file, const std::string& bytes) {
  std::FILE* out = std::fopen(file.c_str(), "wb");
  ASSERT_NE(out, nullptr) << file;
  ASSERT_EQ(std::fwrite(bytes.data(), 1, bytes.size(), out), bytes.size());
  std::fclose(out);
}

/// Damages one to three files in a folder and returns their names.
std::vector<std::string> damage(const fs::path& folder, Dice& dice) {
  const Files files = files_in(folder);
  const auto any = [&] { return std::next(files.begin(), static_cast<std::ptrdiff_t>(dice.below(files.size()))); };
  std::vector<std::string> names;
  for (std::uint64_t n = 1 + dice.below(3); n != 0; --n) {
    const auto& [name, bytes] = *any();
    const fs::path file = folder / name;
    fs::remove_all(file);
    switch (dice.below(12)) {
      case 0:
        break;  // removes the file
      case 1:
        fs::create_directory(file);
        break;
      case 2:
        fs::create_symlink(file.filename(), file);
        break;
      case 3:
        fs::create_symlink("/dev/zero", file);
        break;
      default:
        write(file, damaged(bytes, any()->second, dice));
    }
    names.push_back(name);
  }
  return names;
}

/// Valid run folders, traces and sweeps, made once for all tests.
struct Seeds {
  TempFolder folder;
  fs::path run = folder.path() / "run", other = folder.path() / "other", sweep = folder.path() / "sweep",
           traces = folder.path() / "traces", spec;

  Seeds() {
    const auto good = [](const Words& words) {
      const ProcessResult ending = raywatt(words);
      EXPECT_EQ(ending.exit, 0) << ending.err;
    };
    const Words small = {"--resolution", "16x8", "--threads", "1"};
    const auto with = [&](Words words, const Words& more) {
      words.insert(words.end(), more.begin(), more.end());
      return words;
    };
    good(with({"run", "-o", run.string(), "--debug-images"}, small));
    good(with({"run", "-o", other.string(), "--set", "cores=2"}, small));
    fs::create_directory(traces);
    good(with({"trace", "record", (traces / "a.trace").string()}, small));
    spec = folder.write("spec.yaml", "schema: raywatt-sweep/1\nresolution: 16x8\naxes: {cores: [1, 2, 3]}\n");
    good({"sweep", "run", spec.string(), "-o", (sweep / "out").string(), "--store", (sweep / "store").string(), "-j",
          "1"});
  }
};

/// Runs a verb with limits of 10 s of processor time and 1 GiB of address space. Expects that it ends with one of its
/// own exit codes.
ProcessResult bounded(Words words, const fs::path& folder) {
  constexpr const char* kLimits[] = {"--as=1073741824", "--cpu=10", "--core=0", RAYWATT_PROGRAM};
  words.insert(words.begin(), std::begin(kLimits), std::end(kLimits));
  const ProcessResult ending = raywatt(words, {.folder = folder, .program = "/usr/bin/prlimit"});
  std::string line;
  for (const std::string& word : words) line += word + " ";
  EXPECT_TRUE(ending.exit >= 0 && (ending.exit <= 3 || ending.exit == 74)) << ending.exit << ": " << line << ending.err;
  EXPECT_TRUE(ending.exit == 0 || ending.exit == 1 || ending.err.starts_with("raywatt: ") ||
              ending.err.find("\nraywatt: ") != std::string::npos)
      << line << ending.err;
  return ending;
}

/// Copies valid inputs to a new folder, including a sweep's store.
fs::path copy_of(const fs::path& from, const TempFolder& to) {
  const fs::path copy = to.path() / from.filename();
  fs::copy(from, copy, fs::copy_options::recursive);
  const fs::path sweep = copy / "out" / "sweep.json";
  if (!fs::exists(sweep)) return copy;
  nlohmann::json description = read_json(sweep);
  description["store"] = (copy / "store").string();
  write(sweep, description.dump());
  return copy;
}

/// Returns the files that no verb may change: undamaged files of runs, traces and points.
Files lasting(const fs::path& folder, const std::vector<std::string>& hit) {
  Files files = files_in(folder);
  const bool is_sweep = fs::exists(folder / "store");
  std::erase_if(files, [&](const auto& file) {
    const fs::path name(file.first);
    if (!is_sweep) return std::ranges::find(hit, file.first) != hit.end();
    const auto is_beside = [&](const std::string& other) {
      return fs::path(other).parent_path() == name.parent_path();
    };
    return !file.first.starts_with("store/points/") || std::ranges::any_of(hit, is_beside);
  });
  return files;
}

void expect_kept(const Files& before, const fs::path& folder) {
  const Files now = files_in(folder);
  for (const auto& [name, bytes] : before) {
    EXPECT_TRUE(now.contains(name) && now.at(name) == bytes) << name << " was lost or changed";
  }
}

void try_run(const Seeds& seeds, const fs::path& folder, const TempFolder& work) {
  bounded({"compare", seeds.other.string(), folder.string()}, work.path());
  bounded({"energy", "price", folder.string()}, work.path());
  bounded({"run", (folder / "config.yaml").string(), "--resolution", "8x8", "--threads", "1", "-o",
           (work.path() / "again").string()},
          work.path());
}

void try_page(const Seeds& seeds, const fs::path& folder, const TempFolder& work) {
  bounded({"report", folder.string(), "-o", (work.path() / "a.html").string()}, work.path());
  bounded({"report", seeds.other.string(), folder.string(), "-o", (work.path() / "b.html").string()}, work.path());
}

void try_trace(const fs::path& folder, const TempFolder& work) {
  const std::string trace = (folder / "a.trace").string();
  bounded({"trace", "info", trace}, work.path());
  bounded({"trace", "replay", trace, "--threads", "1", "-o", (work.path() / "replayed").string()}, work.path());
}

/// Returns the valid reports in a store by number of cores, without values that differ between equal runs.
std::map<int, std::string> results_of(const fs::path& store) {
  std::map<int, std::string> results;
  for (const auto& [name, bytes] : files_in(store / "points")) {
    if (fs::path(name).filename() != "report.json") continue;
    nlohmann::json report = nlohmann::json::parse(bytes, nullptr, false);
    if (report.is_discarded()) continue;
    report.erase("host");
    report["provenance"].erase("argv");
    results[report["config"]["cores"]] = report.dump();
  }
  return results;
}

void try_sweep(const Seeds& seeds, const fs::path& folder, const TempFolder& work) {
  const std::string out = (folder / "out").string(), store = (folder / "store").string();
  bounded({"sweep", "status", out}, work.path());
  bounded({"sweep", "table", out}, work.path());
  bounded({"sweep", "best", out, "--max", "perf.fps"}, work.path());
  bounded({"report", out, "-o", (work.path() / "sweep.html").string()}, work.path());
  bounded({"sweep", "run", seeds.spec.string(), "-o", out, "--store", store, "-j", "1", "--quiet"}, work.path());
  // A sweep in a new folder uses valid points of the store and computes the others.
  const ProcessResult again = bounded({"sweep", "run", seeds.spec.string(), "-o", (work.path() / "new").string(),
                                       "--store", store, "-j", "1", "--quiet"},
                                      work.path());
  if (again.exit != 0) return;
  EXPECT_EQ(results_of(folder / "store"), results_of(seeds.sweep / "store"));
}

std::uint64_t folders() {
  const char* value = std::getenv("RAYWATT_HOSTILE");
  return value == nullptr ? 8 : std::strtoull(value, nullptr, 10);
}

TEST(Hostile, FoldersAreReadInTimeWithinTheirMemoryAndKept) {
#ifdef RAYWATT_SANITIZED
  GTEST_SKIP() << "the sanitizer has the address space";
#endif
  const Seeds seeds;
  for (std::uint64_t n = 0; n < folders(); ++n) {
    SCOPED_TRACE("folder " + std::to_string(n));
    Dice dice(n);
    const TempFolder work;
    const fs::path from[] = {seeds.run, seeds.sweep, seeds.traces, n % 8 < 4 ? seeds.run : seeds.sweep};
    const fs::path folder = copy_of(from[n % 4], work);
    const Files kept = lasting(folder, damage(folder, dice));
    if (n % 4 == 0) try_run(seeds, folder, work);
    if (n % 4 == 1) try_sweep(seeds, folder, work);
    if (n % 4 == 2) try_trace(folder, work);
    if (n % 4 == 3) try_page(seeds, n % 8 < 4 ? folder : folder / "out", work);
    expect_kept(kept, folder);
  }
}

}  // namespace
}  // namespace test
