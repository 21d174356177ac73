#pragma once
#include <cstdint>
#include <map>
#include <string>

#include "tools/studies/sweep/results/index/collection.h"
#include "tools/studies/sweep/results/index/sqlite.h"

namespace tools::results {

/// Version of an index's tables. A file with another number is made anew.
inline constexpr std::int64_t kIndexSchema = 1;

/// Description of an index: `store`, and `made_from`, which changes with anything it was made from.
using SweepFacts = std::map<std::string, std::string>;

/// The bytes of index.sqlite.
std::string index_bytes(const Collection& all, const SweepFacts& facts);

/// Opens an index. InputError if it is damaged or of another schema.
Database open_index(const std::filesystem::path& file);
SweepFacts read_facts(Database& index);

}  // namespace tools::results
