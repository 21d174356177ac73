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

/// A folder of this process alone. Its `sgrt-2016.yaml` is a configuration of a line, found before the project's own,
/// which takes some thousand times as long to read.
const std::filesystem::path& folder();

/// A file of that name in it, with these bytes.
std::filesystem::path file_of(std::string_view bytes, const std::string& name);

/// Calls f, which may refuse its input. Whatever else it throws ends the process: a finding.
template <class F>
void refusing(F&& f) {
  try {
    f();
  } catch (const sim::InputError&) {
  } catch (const sim::IoError&) {
  }
}

/// Puts a changed text into a mutator's buffer, if it fits; else changes the bytes that are there.
std::size_t replace(std::uint8_t* data, std::size_t size, std::size_t most, std::string_view changed);

/// Changes any bytes of it by what libFuzzer knows.
std::string mutated_bytes(std::string bytes, std::size_t grow);

/// JSON of which a value is another, gone, or there twice; empty if `text` is no JSON or is nested deeply.
std::string mutated_json(std::string_view text, unsigned seed);

/// A mutator of targets whose input is JSON: three times of four by values, else by bytes.
std::size_t mutate_json(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed);

}  // namespace fuzz
