#include "tests/allocations/count.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstdlib>
#include <map>
#include <vector>

#include <cxxabi.h>
#include <dlfcn.h>
#include <execinfo.h>

namespace test {
namespace {

constexpr int kGroups = 2, kFrames = 24;
constexpr std::size_t kSites = 4096;

struct Site {
  std::array<void*, kFrames> frames{};
  int depth = 0;
};

std::atomic<bool> counting = false;
std::atomic<int> current = 0;
std::array<std::atomic<std::uint64_t>, kGroups> counts{};
std::array<std::array<Site, kSites>, kGroups> sites_of{};
thread_local bool inside = false;  // backtrace() may allocate

[[maybe_unused]] void note() {
  if (!counting || inside) return;
  inside = true;
  const auto group = static_cast<std::size_t>(current.load());
  const std::uint64_t slot = counts[group]++;
  if (slot < kSites) {
    Site& site = sites_of[group][slot];
    site.depth = ::backtrace(site.frames.data(), kFrames);
  }
  inside = false;
}

std::string name_of(void* address) {
  Dl_info info{};
  if (::dladdr(address, &info) == 0 || info.dli_sname == nullptr) return {};
  int status = 0;
  char* plain = abi::__cxa_demangle(info.dli_sname, nullptr, nullptr, &status);
  std::string name = status == 0 ? plain : info.dli_sname;
  std::free(plain);
  return name;
}

/// Lists the call stack from the innermost function, without the heap, the standard library and this file.
std::vector<std::string> functions_of(const Site& site) {
  std::vector<std::string> names;
  for (int i = 0; i < site.depth; ++i) {
    std::string name = name_of(site.frames[static_cast<std::size_t>(i)]);
    const auto is_of = [&](const char* space) { return name.find(space) != std::string::npos; };
    if (is_of("hw::") || is_of("kernels::") || is_of("traces::") || is_of("sim::")) names.push_back(std::move(name));
  }
  return names;
}

bool is_known(const std::vector<std::string>& functions, const std::vector<std::string>& known) {
  return std::ranges::any_of(functions, [&](const std::string& name) {
    return std::ranges::any_of(known, [&](const std::string& k) { return name.find(k) != std::string::npos; });
  });
}

}  // namespace

CountAllocations::CountAllocations() {
  std::array<void*, 4> warm_up{};
  ::backtrace(warm_up.data(), 4);  // loads a library the first time
  for (auto& count : counts) count = 0;
  current = 0;
}
CountAllocations::~CountAllocations() { stop(); }
void CountAllocations::start() { counting = true; }
void CountAllocations::stop() { counting = false; }
void CountAllocations::group(int number) { current = number; }
std::uint64_t CountAllocations::count(int number) const { return counts[static_cast<std::size_t>(number)]; }

std::string CountAllocations::sites(int number, const std::vector<std::string>& known) const {
  const auto group = static_cast<std::size_t>(number);
  std::map<std::string, int> lines;
  for (std::size_t i = 0; i < std::min<std::size_t>(kSites, counts[group]); ++i) {
    const std::vector<std::string> functions = functions_of(sites_of[group][i]);
    if (is_known(functions, known)) continue;
    std::string line;
    for (std::size_t f = 0; f < std::min<std::size_t>(3, functions.size()); ++f) {
      line += (f == 0 ? "" : " < ") + functions[f].substr(0, 160);
    }
    lines[line] += 1;
  }
  std::string text;
  for (const auto& [line, times] : lines) text += "  " + std::to_string(times) + " in " + line + "\n";
  return text;
}

}  // namespace test

#ifdef RAYWATT_SANITIZED

bool test::can_count_allocations() { return false; }

#else

bool test::can_count_allocations() { return true; }

// These replace the C library's functions, and call those by their other names.
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);

void* malloc(std::size_t bytes) {
  test::note();
  return __libc_malloc(bytes);
}
void* calloc(std::size_t count, std::size_t bytes) {
  test::note();
  return __libc_calloc(count, bytes);
}
void* realloc(void* old, std::size_t bytes) {
  test::note();
  return __libc_realloc(old, bytes);
}
void* aligned_alloc(std::size_t alignment, std::size_t bytes) {
  test::note();
  return __libc_memalign(alignment, bytes);
}
int posix_memalign(void** out, std::size_t alignment, std::size_t bytes) {
  test::note();
  *out = __libc_memalign(alignment, bytes);
  return *out != nullptr ? 0 : ENOMEM;
}
}

#endif
