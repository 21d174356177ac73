#include <gtest/gtest.h>

#include "sim/error.h"
#include "tests/traces/scene/tiny_gltf_file.h"
#include "traces/scene/gltf/source.h"

// Tests of URIs of buffers and images: data: URIs as in RFC 2397, and file names.

namespace test {
namespace {

using traces::gltf::data_of;

std::string fault_of(const std::string& uri) {
  try {
    data_of(uri, "buffers[0]");
  } catch (const sim::InputError& error) {
    return error.what();
  }
  return "nothing";
}

TEST(DataUri, TakesAnyMediaTypeWithParametersOrNone) {
  for (const char* header :
       {"data:;base64", "data:application/octet-stream;base64", "data:application/octet-stream;charset=utf-8;base64",
        "data:text/plain;charset=US-ASCII;format=flowed;base64", "DATA:image/png;BASE64"}) {
    EXPECT_EQ(data_of(std::string(header) + ",AQID", ""), "\x01\x02\x03") << header;
  }
}

TEST(DataUri, WithoutBase64HoldsPercentEncodedBytes) {
  EXPECT_EQ(data_of("data:,a%20b%2C,%ff", ""), "a b,,\xff");
  EXPECT_EQ(data_of("data:text/plain;charset=utf-8,%00+", ""), std::string("\0+", 2));
  EXPECT_EQ(data_of("data:,", ""), "");
}

TEST(DataUri, Base64OfEveryRest) {
  // Test vectors of RFC 4648, section 10.
  EXPECT_EQ(data_of("data:;base64,", ""), "");
  EXPECT_EQ(data_of("data:;base64,Zg==", ""), "f");
  EXPECT_EQ(data_of("data:;base64,Zm8=", ""), "fo");
  EXPECT_EQ(data_of("data:;base64,Zm9v", ""), "foo");
  EXPECT_EQ(data_of("data:;base64,Zm9vYg", ""), "foob") << "padding left out";
  EXPECT_EQ(data_of("data:;base64,Zm9vYmE%3D", ""), "fooba") << "padding percent-encoded";
  std::string digits;
  for (int i = 0; i < 1'000'000; ++i) digits += "+/+/";
  EXPECT_EQ(data_of("data:;base64," + digits, "").size(), 3'000'000U);
  EXPECT_EQ(data_of("data:;base64," + digits, "").substr(2'999'997), "\xfb\xff\xbf");
}

TEST(DataUri, FaultsAreNamed) {
  EXPECT_SAYS(fault_of("data:;base64"),
              "buffers[0]: the URI 'data:;base64' has no comma; allowed: data:[type/subtype]");
  EXPECT_SAYS(fault_of("data:octets,a"), "has the media type 'octets', which is not type/subtype");
  EXPECT_SAYS(fault_of("data:;utf8,a"), "has the parameter 'utf8', which is neither name=value nor base64");
  EXPECT_SAYS(fault_of("data:;base64;charset=utf-8,AAAA"), "has parameters after ;base64");
  EXPECT_SAYS(fault_of("data:;base64,AA-A"), "has the character '-' in its data, which is not base64");
  EXPECT_SAYS(fault_of("data:;base64,AA=A"), "has the character '=' in its data");
  EXPECT_SAYS(fault_of("data:;base64,AAAAA"), "has base64 data that ends within a byte");
  EXPECT_SAYS(fault_of("data:,100%"), "has a '%' in its data that is not followed by two hexadecimal digits");
}

/// Returns the bytes with all of them percent-encoded.
std::string percent_encoded(const std::string& bytes) {
  std::string out;
  for (const char c : bytes) {
    const auto byte = static_cast<unsigned char>(c);
    out += {'%', "0123456789abcdef"[byte / 16], "0123456789abcdef"[byte % 16]};
  }
  return out;
}

TEST(GltfUri, BuffersInOddDataUrisGiveTheSameScene) {
  TinyGltf file;
  const std::string plain = nlohmann::json::parse(file.text())["buffers"][0]["uri"];
  const std::string data = plain.substr(plain.find(',') + 1);
  for (const std::string& uri :
       {"data:;base64," + data, "data:application/octet-stream;charset=utf-8;base64," + data,
        "data:application/x-bin," + percent_encoded(file.binary), "data:," + percent_encoded(file.binary + "more")}) {
    file.json["buffers"][0]["uri"] = uri;
    const traces::Scene scene = load(file);
    EXPECT_EQ(scene.meshes.at(0).positions.at(1), glm::vec3(1, 0, 0)) << uri;
    EXPECT_TRUE(scene.warnings.empty());
  }
}

TEST(GltfUri, BuffersOfTooFewBytesAreRefused) {
  TinyGltf file;
  file.json["buffers"][0]["uri"] = "data:;base64,AAAA";
  EXPECT_SAYS(refusal(file.text()), "buffers[0]: its URI holds 3 bytes; allowed: byteLength, 44, or more");
  file.json["buffers"][0]["uri"] = "data:application/octet-stream,";
  file.json["buffers"][0]["byteLength"] = 0;
  EXPECT_SAYS(refusal(file.text()), "buffers[0]: its URI holds no bytes");
  file.json["buffers"].push_back({{"byteLength", 4}});
  file.json["buffers"][0] = nlohmann::json::object();
  EXPECT_SAYS(refusal(file.text()), "buffers[1]: has no URI; allowed for the first buffer of a GLB file");
  TinyGltf image;
  image.json["images"] = {{{"uri", "data:image/png;base64"}}};
  EXPECT_SAYS(refusal(image.text()), "images[0]: the URI 'data:image/png;base64' has no comma");
}

TEST(GltfUri, FilesMayBeLongerThanTheBufferAndHaveAPlusInTheirName) {
  const TempFolder folder;
  TinyGltf file;
  folder.write("a+b c.bin", file.binary + "more");
  file.json["buffers"][0]["uri"] = "a+b%20c.bin";
  EXPECT_EQ(traces::load_gltf(folder.write("a.gltf", file.text())).instances.size(), 1U);
}

}  // namespace
}  // namespace test
