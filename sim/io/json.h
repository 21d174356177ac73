#pragma once
#include <string>

#include <nlohmann/json.hpp>

#include "sim/error.h"

namespace sim {

/// JSON from outside. InputError for what is nested deeper than any file of ours, and would exhaust the stack of
/// whoever walks through it; nlohmann's exceptions for what is no JSON.
template <class Json>
Json parse_json(const std::string& text) {
  constexpr int kDeepest = 64;
  return Json::parse(text, [](int depth, typename Json::parse_event_t, Json&) {
    if (depth > kDeepest) throw InputError("is nested too deeply; allowed: 64 levels");
    return true;
  });
}

}  // namespace sim
