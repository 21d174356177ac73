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
  return sim::sha256_hex(digest_of(image.nodes) + digest_of(image.triangles));
}

}  // namespace traces
