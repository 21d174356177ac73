#pragma once
#include <string>
#include <string_view>

namespace traces {

/// Returns the JSON chunk of a GLB file, whose header and chunk sizes must be valid.
std::string_view glb_json(std::string_view glb);

/// Replaces the JSON chunk of a GLB file, padded with blanks to a multiple of 4 bytes.
void set_glb_json(std::string& glb, std::string json);

}  // namespace traces
