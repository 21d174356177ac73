#include "traces/scene/images.h"

#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "sim/error.h"
#include "sim/hash.h"
#include "sim/sha256.h"
#include "tests/temp_folder.h"
#include "traces/scene/images/formats.h"

namespace test {
namespace {

std::span<const std::byte> as_bytes(const std::string& text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

std::vector<std::uint8_t> noise(std::size_t count) {
  std::vector<std::uint8_t> out(count);
  for (std::size_t i = 0; i < count; ++i) out[i] = static_cast<std::uint8_t>(sim::hash(i));
  return out;
}

TEST(Png, ComesBackAsWritten) {
  const TempFolder folder;
  const std::vector<std::uint8_t> pixels = noise(5 * 3 * 3);
  traces::write_png(folder.path() / "a.png", 5, 3, pixels);
  const std::string file = read_bytes(folder.path() / "a.png");
  const traces::Texture back = traces::read_image(as_bytes(file), "a.png");
  ASSERT_EQ(back.width, 5U);
  ASSERT_EQ(back.height, 3U);
  for (std::size_t i = 0; i < 15; ++i) {
    const std::uint32_t r = pixels[3 * i], g = pixels[3 * i + 1], b = pixels[3 * i + 2];
    const std::uint32_t expected = r | (g << 8) | (b << 16) | 0xff000000U;
    EXPECT_EQ(back.texels[i], expected) << i;
  }
}

TEST(Png, OfDamagedDataGivesOneError) {
  const TempFolder folder;
  traces::write_png(folder.path() / "a.png", 64, 64, noise(64 * 64 * 3));
  std::string file = read_bytes(folder.path() / "a.png");
  file[file.size() / 2] ^= 0x55;
  testing::internal::CaptureStderr();
  EXPECT_THROW(traces::read_image(as_bytes(file), "a.png"), sim::InputError);
  std::fputs("heard again", stderr);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "heard again");
}

TEST(Exr, ComesBackAsWritten) {
  const TempFolder folder;
  std::vector<float> pixels(7 * 2 * 3);
  for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = 100 * sim::hash_to_unit_float(sim::hash(i));
  traces::write_exr(folder.path() / "a.exr", 7, 2, pixels);
  const traces::FloatImage back = traces::read_exr(folder.path() / "a.exr");
  EXPECT_EQ(back.width, 7U);
  EXPECT_EQ(back.height, 2U);
  EXPECT_EQ(back.rgb, pixels);
}

TEST(Images, EqualPixelsGiveEqualBytesASecondLater) {
  const TempFolder folder;
  const std::vector<std::uint8_t> pixels = noise(64 * 64 * 3);
  const std::vector<float> floats(64 * 64 * 3, 0.25F);
  const auto write = [&](const std::string& name) {
    traces::write_png(folder.path() / (name + ".png"), 64, 64, pixels);
    traces::write_exr(folder.path() / (name + ".exr"), 64, 64, floats);
  };
  write("a");
  const auto now = std::chrono::system_clock::now();
  std::this_thread::sleep_until(std::chrono::floor<std::chrono::seconds>(now) + std::chrono::seconds(1));
  write("b");
  EXPECT_EQ(read_bytes(folder.path() / "a.png"), read_bytes(folder.path() / "b.png"));
  EXPECT_EQ(read_bytes(folder.path() / "a.exr"), read_bytes(folder.path() / "b.exr"));
}

TEST(Images, NothingButTheFileIsLeft) {
  const TempFolder folder;
  traces::write_png(folder.path() / "a.png", 1, 1, noise(3));
  traces::write_png(folder.path() / "a.png", 1, 1, noise(3));
  const auto files = std::filesystem::directory_iterator(folder.path());
  EXPECT_EQ(std::distance(begin(files), end(files)), 1);
}

TEST(Images, AFolderThatIsNotThereIsAnIoError) {
  EXPECT_THROW(traces::write_png("/nowhere/a.png", 1, 1, noise(3)), sim::IoError);
  EXPECT_THROW(traces::write_exr("/nowhere/a.exr", 1, 1, std::array<float, 3>{}), sim::IoError);
}

TEST(Images, AFullDiskIsAnIoError) {
  const TempFolder folder;
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const rlimit tight{10, before.rlim_max};
  setrlimit(RLIMIT_FSIZE, &tight);
  EXPECT_THROW(traces::write_png(folder.path() / "a.png", 1, 1, noise(3)), sim::IoError);
  setrlimit(RLIMIT_FSIZE, &before);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

std::uint32_t crc(std::string_view bytes) {
  std::uint32_t c = ~0U;
  for (const char byte : bytes) {
    c ^= static_cast<unsigned char>(byte);
    for (int bit = 0; bit < 8; ++bit) c = (c >> 1) ^ ((c & 1U) != 0 ? 0xedb88320U : 0U);
  }
  return ~c;
}

std::string big_endian(std::uint32_t value) {
  std::string out;
  for (int shift = 24; shift >= 0; shift -= 8) out += static_cast<char>(value >> shift);
  return out;
}

TEST(Images, ADecompressionBombIsRefusedByItsHeader) {
  const TempFolder folder;
  traces::write_png(folder.path() / "a.png", 1, 1, noise(3));
  std::string file = read_bytes(folder.path() / "a.png");
  file.replace(16, 8, big_endian(60'000) + big_endian(60'000));
  file.replace(29, 4, big_endian(crc(std::string_view(file).substr(12, 17))));
  try {
    traces::read_image(as_bytes(file), "bomb.png");
    FAIL();
  } catch (const sim::InputError& error) {
    EXPECT_STREQ(error.what(), "bomb.png: 60000 x 60000 pixels, allowed are 134217728");
  }
}

TEST(Images, OfAChunkLongerThanTheFileAreRefused) {
  const std::string png("\x89PNG\r\n\x1a\n\x42\0\0\0tEXt\0\0\0\0", 20);
  try {
    traces::read_image(as_bytes(png), "long.png");
    FAIL() << "taken";
  } catch (const sim::InputError& error) {
    EXPECT_STREQ(error.what(), "long.png: damaged: a chunk is longer than the file");
  }
}

TEST(Images, OtherFormatsAndDamagedFilesAreRefused) {
  for (const std::string& bytes : {std::string(), std::string("BM"), std::string("\x89PNG\r\n\x1a\n"),
                                   std::string("\xff\xd8\xff\xe0 and no more"), std::string(1000, '\xff')}) {
    EXPECT_THROW(traces::read_image(as_bytes(bytes), "x"), sim::InputError);
  }
  const TempFolder folder;
  EXPECT_THROW(traces::read_exr(folder.write("a.exr", "\x76\x2f\x31\x01 and no more")), sim::InputError);
  EXPECT_THROW(traces::read_exr(folder.write("b.exr", "something else")), sim::InputError);
}

TEST(Text, HasTheSamePixelsOnEveryHost) {
  const traces::GreyImage text = traces::draw_text("Energy of a pixel in nJ: 0 to 1.234e+05");
  EXPECT_EQ(text.height, traces::kTextHeight);
  EXPECT_EQ(text.pixels.size(), std::size_t{text.width} * text.height);
  EXPECT_EQ(sim::sha256_hex(std::string(text.pixels.begin(), text.pixels.end())),
            "21c440ac54e80a1dd278f7745a93d0e8836974d508e7d2d5b1b5f7a16111ad5a");
}

TEST(Text, GrowsToTheRightWithItsLength) {
  const traces::GreyImage one = traces::draw_text("H"), two = traces::draw_text("HH");
  EXPECT_GT(two.width, one.width);
  for (std::uint32_t y = 0; y < one.height; ++y) {
    for (std::uint32_t x = 0; x < one.width; ++x) {
      EXPECT_EQ(one.pixels[y * one.width + x], two.pixels[y * two.width + x]) << x << ", " << y;
    }
  }
}

// Tests that headers of OpenEXR files are checked before the library allocates the memory that they claim.

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

TEST(ImageWriters, StoreNotesWithThePixels) {
  const std::array<traces::ImageNote, 2> notes = {{{"Scene", "cornell"}, {"Unit", "rays"}}};
  const std::string png = traces::png_bytes(1, 1, 3, std::array<std::uint8_t, 3>{1, 2, 3}, notes);
  EXPECT_NE(png.find("tEXtScene" + std::string(1, '\0') + "cornell"), std::string::npos);
  EXPECT_NE(png.find("tEXtUnit" + std::string(1, '\0') + "rays"), std::string::npos);

  const std::array<traces::ImageChannel, 1> channel = {{{"rays"}}};
  const std::string exr = traces::exr_bytes(1, 1, channel, std::array<float, 1>{7}, notes);
  EXPECT_NE(exr.find("Scene" + std::string("\0string\0\7\0\0\0cornell", 19)), std::string::npos);
}

TEST(ImageWriters, KeepChannelsOfBothKindsApart) {
  const std::array<traces::ImageChannel, 3> channels = {{{"p"}, {"q", true}, {"s"}}};
  const std::vector<float> values = {0.1F, 2048, -1e30F, 0.2F, 0.5F, 1e-30F};
  const TempFolder folder;
  traces::write_exr(folder.path() / "a.exr", 1, 2, channels, values, {});
  EXPECT_EQ(traces::read_exr(folder.path() / "a.exr").rgb, values);
  const std::string exr = read_bytes(folder.path() / "a.exr");
  EXPECT_NE(exr.find(std::string("q\0\1\0\0\0", 6)), std::string::npos) << "type 1: 16 bits";
  EXPECT_NE(exr.find(std::string("s\0\2\0\0\0", 6)), std::string::npos) << "type 2: 32 bits";
}

TEST(ImageWriters, ReportTheErrorOfTheirLibrary) {
  const auto refusal = [](const auto& write) -> std::string {
    try {
      write();
    } catch (const sim::IoError& error) {
      return error.what();
    }
    return "nothing";
  };
  const std::vector<std::uint8_t> wide(3'000'003);
  EXPECT_EQ(refusal([&] { traces::png_bytes(1'000'001, 1, 3, wide); }),
            "no PNG file of 1000001 x 1 pixels: Invalid IHDR data");
  EXPECT_EQ(refusal([&] { traces::write_png("a.png", 1'000'001, 1, wide); }),
            "a.png: no PNG file of 1000001 x 1 pixels: Invalid IHDR data");
  traces::Texture texture;
  texture.name = "wood";
  texture.width = 1'000'001;
  texture.height = 1;
  texture.texels.resize(1'000'001);
  EXPECT_EQ(refusal([&] { traces::encode_png(texture); }),
            "texture 'wood': no PNG file of 1000001 x 1 pixels: Invalid IHDR data");
  const std::array<traces::ImageChannel, 1> channel = {{{"a"}}};
  const std::array<traces::ImageNote, 1> note = {{{"channels", "no text"}}};
  EXPECT_EQ(
      refusal([&] { traces::exr_bytes(1, 1, channel, std::array<float, 1>{}, note); }),
      "no OpenEXR file of 1 x 1 pixels: Cannot assign a value of type \"string\" to image attribute \"channels\" of "
      "type \"chlist\".");
}

}  // namespace
}  // namespace test
