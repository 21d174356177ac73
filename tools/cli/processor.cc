#include <unistd.h>

#include "tools/host/process.h"

// This file alone is compiled for any x86-64 processor: it checks the host's processor before other code runs.

namespace tools {
namespace {

#if defined(__x86_64__)
[[gnu::constructor(101)]] void refuse_old_processors() {
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi2")) return;
  constexpr char kLine[] =
      "raywatt: needs a processor with AVX2, FMA and BMI2 (x86-64-v3); this one has not all of them\n";
  [[maybe_unused]] const auto written = ::write(STDERR_FILENO, kLine, sizeof kLine - 1);
  ::_exit(kBadInput);
}
#endif

}  // namespace
}  // namespace tools
