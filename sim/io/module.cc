#include "sim/io/module.h"

#include <array>
#include <string>
#include <system_error>

#include <dlfcn.h>
#include <fmt/format.h>

#include "sim/error.h"

namespace sim {

void* load_module(const std::filesystem::path& built, const char* symbol, std::string_view purpose) {
  std::error_code ignored;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", ignored).parent_path();
  const std::array candidates = {program / built.filename(),
                                 program / ".." / "lib" / "raywatt" / "modules" / built.filename(), built};
  std::string tried;
  for (const std::filesystem::path& candidate : candidates) {
    if (!std::filesystem::exists(candidate, ignored)) {
      tried += fmt::format("; {}: no such file", candidate.string());
    } else if (void* module = dlopen(candidate.c_str(), RTLD_NOW | RTLD_LOCAL); module == nullptr) {
      tried += fmt::format("; {}", dlerror());
    } else if (void* found = dlsym(module, symbol); found == nullptr) {
      tried += fmt::format("; {}: of another version", candidate.string());
      dlclose(module);
    } else {
      return found;
    }
  }
  throw IoError(fmt::format("the module {} cannot be loaded{}", purpose, tried));
}

}  // namespace sim
