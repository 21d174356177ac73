#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "sim/error.h"

extern "C" {
// Interface of libFuzzer.
int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);
}

namespace fuzz {

inline std::string_view text_of(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

/// Returns a temporary folder of this process. Its one-line `sgrt-2016.yaml` is found before the project's own, which
/// takes a thousand times as long to read.
const std::filesystem::path& folder();

/// Writes a file of that name into it.
std::filesystem::path file_of(std::string_view bytes, const std::string& name);

/// Calls f, which may refuse its input by InputError or IoError. Any other exception ends the process: a finding.
template <class F>
void refusing(F&& f) {
  try {
    f();
  } catch (const sim::InputError&) {
  } catch (const sim::IoError&) {
  }
}

/// Copies a changed text into a mutator's buffer if it fits; otherwise mutates the bytes in the buffer.
std::size_t replace(std::uint8_t* data, std::size_t size, std::size_t most, std::string_view changed);

/// Mutates bytes by libFuzzer's own mutator.
std::string mutated_bytes(std::string bytes, std::size_t grow);

/// Changes, removes or repeats a value of the JSON. Returns an empty text if `text` is not JSON or is nested deeply.
std::string mutated_json(std::string_view text, unsigned seed);

/// Mutator for JSON inputs: three times of four by values, otherwise by bytes.
std::size_t mutate_json(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed);

}  // namespace fuzz
