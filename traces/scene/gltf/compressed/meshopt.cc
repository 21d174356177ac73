#include "traces/scene/gltf/compressed/meshopt.h"

#include <fmt/format.h>
#include <meshoptimizer.h>

#include "sim/io/printable.h"
#include "traces/scene/gltf/accessors.h"
#include "traces/scene/gltf/values.h"

namespace traces::gltf {
namespace {

std::string text_or(const tinygltf::Value& object, const char* key, const char* absent) {
  return object.Has(key) && object.Get(key).IsString() ? object.Get(key).Get<std::string>() : absent;
}

/// Checks the preconditions that the decoders do not check. Returns the fault, or null.
const char* fault_of(const std::string& mode, const std::string& filter, std::size_t count, std::size_t stride) {
  const bool attributes = mode == "ATTRIBUTES";
  if (!attributes && mode != "TRIANGLES" && mode != "INDICES") return "the mode is unknown";
  if (attributes && (stride == 0 || stride > 256 || stride % 4 != 0)) return "the stride is not one of 4, 8 .. 256";
  if (!attributes && stride != 2 && stride != 4) return "the stride of indices is not 2 or 4";
  if (mode == "TRIANGLES" && count % 3 != 0) return "the number of indices is not a multiple of 3";
  if (filter == "NONE") return nullptr;
  if (!attributes) return "indices take no filter";
  if (filter == "OCTAHEDRAL") return stride == 4 || stride == 8 ? nullptr : "the filter needs a stride of 4 or 8";
  if (filter == "QUATERNION") return stride == 8 ? nullptr : "the filter needs a stride of 8";
  return filter == "EXPONENTIAL" ? nullptr : "the filter is unknown";
}

std::vector<unsigned char> decode(Context& context, const tinygltf::Value& extension, const std::string& what) {
  const int index = index_or_none(extension, "buffer");
  const std::vector<unsigned char>& buffer = context.at(context.model.buffers, index, "buffers").data;
  const std::uint64_t offset = size_or(context, extension, "byteOffset", 0);
  const std::uint64_t size = size_or(context, extension, "byteLength", 0);
  const std::uint64_t count = size_or(context, extension, "count", 0);
  const std::uint64_t stride = size_or(context, extension, "byteStride", 0);
  const std::string mode = text_or(extension, "mode", ""), filter = text_or(extension, "filter", "NONE");
  if (offset > buffer.size() || size > buffer.size() - offset) context.refuse(what + " leaves its buffer");
  if (const char* fault = fault_of(mode, filter, count, stride)) {
    context.refuse(fmt::format("{}: {} (mode '{}', filter '{}', stride {}, count {})", what, fault,
                               sim::printable(mode), sim::printable(filter), stride, count));
  }
  context.budget.take(count, stride, what);
  std::vector<unsigned char> out(count * stride);
  const unsigned char* from = buffer.data() + offset;
  const int failed = mode == "ATTRIBUTES"  ? meshopt_decodeVertexBuffer(out.data(), count, stride, from, size)
                     : mode == "TRIANGLES" ? meshopt_decodeIndexBuffer(out.data(), count, stride, from, size)
                                           : meshopt_decodeIndexSequence(out.data(), count, stride, from, size);
  if (failed != 0) context.refuse(what + ": damaged, or of a later version than is supported");
  if (filter == "OCTAHEDRAL") meshopt_decodeFilterOct(out.data(), count, stride);
  if (filter == "QUATERNION") meshopt_decodeFilterQuat(out.data(), count, stride);
  if (filter == "EXPONENTIAL") meshopt_decodeFilterExp(out.data(), count, stride);
  return out;
}

}  // namespace

void expand_meshopt(Context& context, tinygltf::Model& model) {
  for (std::size_t i = 0; i < model.bufferViews.size(); ++i) {
    tinygltf::BufferView& view = model.bufferViews[i];
    for (const char* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"}) {
      const auto* extension = find_extension(view.extensions, name);
      if (extension == nullptr) continue;
      std::vector<unsigned char> bytes = decode(context, *extension, fmt::format("bufferViews[{}] ({})", i, name));
      view.buffer = static_cast<int>(model.buffers.size());
      view.byteOffset = 0;
      view.byteLength = bytes.size();
      model.buffers.emplace_back().data = std::move(bytes);
      break;
    }
  }
}

}  // namespace traces::gltf
