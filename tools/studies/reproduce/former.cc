#include "tools/studies/reproduce/former.h"

#include <map>

#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/json.h"
#include "sim/sha256.h"

namespace tools::reproduce {

namespace fs = std::filesystem;

namespace {

using sim::Json;

constexpr std::uint64_t kMostResultBytes = 64 << 20;  ///< results of whole papers have some 200 KB
constexpr std::uint64_t kMostOfScene = 8ULL << 30;

/// Everything that rows depend on beside their own case.
bool is_same_run(const Json& former, const Json& head) {
  for (const auto& [key, value] : head.items()) {
    if (key == "partial" || key == "provenance") continue;
    if (!former.contains(key) || former[key] != value) return false;
  }
  for (const auto& [key, value] : head.at("provenance").items()) {
    if (key != "argv" && former.at("provenance").at(key) != value) return false;
  }
  return former.at("partial").get<bool>();
}

Row row_of(const Json& entry) {
  const auto text = [&](const char* key) { return entry.at(key).get<std::string>(); };
  Row row{.figure = {text("experiment"), text("scene"), text("setting"), text("figure")},
          .stand_in = text("stand_in"),
          .width = entry.at("resolution").at(0).get<std::uint32_t>(),
          .height = entry.at("resolution").at(1).get<std::uint32_t>(),
          .program = text("program"),
          .reference = text("reference"),
          .measured = {},
          .why_not = entry.value("why_not", ""),
          .published = {}};
  if (entry.at("measured").is_number()) row.measured = entry.at("measured").get<double>();
  return row;
}

Former read_former(const Json& former, const Json& head) {
  Former out{.rows = former.at("rows").size(), .finished = {}};
  if (!is_same_run(former, head)) return out;
  const Json& digests = former.at("scenes");
  std::map<std::string, bool> unchanged;
  for (const Json& entry : former.at("rows")) {
    Row row = row_of(entry);
    const auto [at, is_new] = unchanged.try_emplace(row.stand_in, false);
    if (is_new) at->second = digests.value(row.stand_in, "") == digest_of_file(row.stand_in);
    if (at->second) out.finished.push_back(std::move(row));
  }
  return out;
}

}  // namespace

std::string digest_of_file(const fs::path& scene) {
  std::error_code unreadable;
  if (!fs::is_regular_file(scene, unreadable)) return {};
  return sim::sha256_hex(sim::read_file(scene, kMostOfScene));
}

Former load_former(const fs::path& folder, const Json& head) {
  try {
    return read_former(sim::parse_json(sim::read_file(folder / "reproduce.json", kMostResultBytes)), head);
  } catch (const sim::InputError&) {
  } catch (const sim::JsonError&) {
  }
  return {};
}

}  // namespace tools::reproduce
