#include <string_view>
#include <vector>

#include "sim/sha256.h"
#include "traces/accel/bvh_info.h"

namespace traces {
namespace {

template <class Record>
std::string digest_of(const std::vector<Record>& records) {
  return sim::sha256_hex({reinterpret_cast<const char*>(records.data()), records.size() * sizeof(Record)});
}

}  // namespace

std::string bvh_hash(const MemoryImage& image) {
  std::string parts = digest_of(image.nodes) + digest_of(image.triangles);
  if (image.has_levels()) parts += digest_of(image.instances);
  if (image.grid) parts += digest_of(std::vector{image.grid->lower(), image.grid->step()});
  return sim::sha256_hex(parts);
}

}  // namespace traces
