#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "sim/error.h"

extern "C" {
// Entry points that libFuzzer defines.
int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);
}

namespace fuzz {

inline std::string_view text_of(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

/// Returns the temporary folder of this process. It contains a one-line `sgrt-2016.yaml` that replaces the project's,
/// because that takes a thousand times as long to read.
const std::filesystem::path& folder();

/// Writes bytes to a file `name` in folder() and returns its path.
std::filesystem::path file_of(std::string_view bytes, const std::string& name);

/// Calls `f` and ignores InputError and IoError, which refuse invalid input. Other exceptions are bugs and end the
/// process.
template <class F>
void ignore_input_errors(F&& f) {
  try {
    f();
  } catch (const sim::InputError&) {
  } catch (const sim::IoError&) {
  }
}

/// Copies `changed` into libFuzzer's buffer if it fits into `most` bytes; otherwise mutates the bytes in the buffer.
/// Returns the new size.
std::size_t replace(std::uint8_t* data, std::size_t size, std::size_t most, std::string_view changed);

/// Returns `bytes` after a mutation by libFuzzer's own mutator. They may grow by `grow` bytes.
std::string mutated_bytes(std::string bytes, std::size_t grow);

/// Returns JSON with one value changed, removed or repeated. Returns an empty text if `text` is not JSON or is nested
/// too deeply.
std::string mutated_json(std::string_view text, unsigned seed);

/// Custom mutator for JSON inputs of a fuzz test. Mutates a JSON value in three of four calls, otherwise bytes.
std::size_t mutate_json(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed);

}  // namespace fuzz
