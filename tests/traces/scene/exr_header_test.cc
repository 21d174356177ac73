#include <array>

#include <gtest/gtest.h>

#include "tests/temp_folder.h"
#include "traces/scene/images.h"
#include "traces/scene/images/formats.h"

// Tests that headers of OpenEXR files are checked before the library allocates the memory that they claim.

namespace test {
namespace {

/// Returns the bytes of an OpenEXR attribute: name, kind, size, value.
std::string attribute(const std::string& name, const std::string& kind, const std::string& value, std::uint32_t size) {
  return name + '\0' + kind + '\0' + std::string(reinterpret_cast<const char*>(&size), 4) + value;
}
std::string attribute(const std::string& name, const std::string& kind, const std::string& value) {
  return attribute(name, kind, value, static_cast<std::uint32_t>(value.size()));
}

std::string window(const std::array<std::int32_t, 4>& corners) {
  return attribute("dataWindow", "box2i", {reinterpret_cast<const char*>(corners.data()), sizeof corners});
}

std::string problem(const std::string& attributes, char flags = 0) {
  return traces::exr_problem(std::string("\x76\x2f\x31\x01\x02", 5) + flags + std::string(2, '\0') + attributes + '\0',
                             64);
}

TEST(ExrHeader, OfAWrittenFileIsGood) {
  const TempFolder folder;
  traces::write_exr(folder.path() / "a.exr", 7, 2, std::array<float, 42>{});
  EXPECT_EQ(traces::exr_problem(read_bytes(folder.path() / "a.exr"), 14), "");
  EXPECT_EQ(traces::exr_problem(read_bytes(folder.path() / "a.exr"), 13), "7 x 2 pixels, allowed are 13");
}

TEST(ExrHeader, ClaimsNoMorePixelsThanAllowed) {
  EXPECT_EQ(problem(window({0, 0, 7, 7})), "");
  EXPECT_EQ(problem(window({-4, -4, 3, 4})), "8 x 9 pixels, allowed are 64");
  EXPECT_EQ(problem(window({0, 0, 0x74000007, 0})), "1946157064 x 1 pixels, allowed are 64");
  EXPECT_EQ(problem(window({-2147483647 - 1, -2147483647 - 1, 2147483647, 2147483646})),
            "4294967296 x 4294967295 pixels, allowed are 64");
  EXPECT_EQ(problem(window({1, 0, 0, 0})), "the image has no pixels");
}

TEST(ExrHeader, ClaimsNoAttributeLongerThanTheFile) {
  EXPECT_EQ(problem(attribute("note", "string", "abc", 4)), "damaged: ends early")
      << "the end of the header is in the note";
  EXPECT_EQ(problem(attribute("note", "string", "abc", 5)), "damaged: an attribute is longer than the file");
  EXPECT_EQ(problem(attribute("note", "string", "abc", 0xffffffff)), "damaged: an attribute is longer than the file");
  EXPECT_EQ(traces::exr_problem("\x76\x2f\x31\x01", 64), "damaged: ends early");
}

TEST(ExrHeader, HasAttributesOfKnownKindsAndTheirSizes) {
  EXPECT_EQ(problem(attribute("a", "float", "abcd")), "");
  EXPECT_EQ(problem(attribute("a", "float", "abcde")), "damaged: a float of 5 bytes");
  EXPECT_EQ(problem(attribute("a", "preview", "abcd")), "an attribute of the kind 'preview'");
  EXPECT_EQ(problem(attribute(std::string(256, 'a'), "float", "abcd")), "damaged: a name without an end");
}

TEST(ExrHeader, ClaimsUpToFourChannelsOfOnePartOfLines) {
  const std::string channel = std::string("R\0", 2) + std::string(16, '\0');
  const std::string four = channel + channel + channel + channel;
  EXPECT_EQ(problem(attribute("channels", "chlist", four + '\0')), "");
  EXPECT_EQ(problem(attribute("channels", "chlist", four + channel + '\0')), "5 channels, allowed are 1 to 4");
  for (const char flags : {'\x02', '\x08', '\x10'}) {
    EXPECT_EQ(problem("", flags), "tiled, deep or of several parts; allowed: one part of lines");
  }
  EXPECT_EQ(problem("", 0x04), "") << "long names";
}

}  // namespace
}  // namespace test
