#include <algorithm>
#include <cstdio>
#include <vector>

#include <sys/resource.h>
#include <unistd.h>

#include "tests/fuzz/common.h"
#include "tests/temp_folder.h"

// Runs a fuzz target on the files of given folders, without libFuzzer. Each file must end within five seconds, and all
// of them within 2 GiB.

namespace {

namespace fs = std::filesystem;

constexpr unsigned kMostSeconds = 5;
constexpr long kMostKiB = 2L << 20;

}  // namespace

/// libFuzzer's mutator is referenced by the targets, but never called here.
std::size_t LLVMFuzzerMutate(std::uint8_t*, std::size_t size, std::size_t) { return size; }

int main(int argc, char** argv) {
  std::vector<fs::path> files;
  for (int i = 1; i < argc; ++i) {
    for (const fs::directory_entry& entry : fs::directory_iterator(argv[i])) files.push_back(entry.path());
  }
  std::ranges::sort(files);
  for (const fs::path& file : files) {
    std::fprintf(stderr, "%s\n", file.c_str());
    const std::string bytes = test::read_bytes(file);
    ::alarm(kMostSeconds);
    LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
    ::alarm(0);
  }
  rusage used{};
  ::getrusage(RUSAGE_SELF, &used);
  std::fprintf(stderr, "%zu files, %ld MiB\n", files.size(), used.ru_maxrss >> 10);
  return files.empty() || used.ru_maxrss > kMostKiB ? 1 : 0;
}
