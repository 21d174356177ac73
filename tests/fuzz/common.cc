#include "tests/fuzz/common.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include <fcntl.h>
#include <unistd.h>

#include "tests/temp_folder.h"

namespace fuzz {
namespace {

/// Temporary folder of this process, with the small default configuration.
test::TempFolder& made() {
  static test::TempFolder folder;
  static const bool once = [] {
    folder.write("sgrt-2016.yaml", "energy: {events: {tni.box_test: {low: 1, nominal: 2, high: 3}}}\n");
    return ::setenv("RAYWATT_PATH", folder.path().c_str(), 1) == 0;
  }();
  if (!once) std::abort();
  return folder;
}

}  // namespace

const std::filesystem::path& folder() { return made().path(); }

std::filesystem::path file_of(std::string_view bytes, const std::string& name) {
  std::filesystem::path path = folder() / name;
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
  if (file < 0 || ::write(file, bytes.data(), bytes.size()) != static_cast<ssize_t>(bytes.size())) std::abort();
  ::close(file);
  return path;
}

std::size_t replace(std::uint8_t* data, std::size_t size, std::size_t most, std::string_view changed) {
  if (changed.empty() || changed.size() > most) return LLVMFuzzerMutate(data, size, most);
  std::memcpy(data, changed.data(), changed.size());
  return changed.size();
}

std::string mutated_bytes(std::string bytes, std::size_t grow) {
  const std::size_t size = bytes.size();
  bytes.resize(size + grow);
  bytes.resize(LLVMFuzzerMutate(reinterpret_cast<std::uint8_t*>(bytes.data()), size, bytes.size()));
  return bytes;
}

std::size_t mutate_json(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed) {
  if (seed % 4 == 0) return LLVMFuzzerMutate(data, size, most);
  return replace(data, size, most, mutated_json(text_of(data, size), seed / 4));
}

}  // namespace fuzz
