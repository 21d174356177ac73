#include "traces/scene/images.h"

#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <thread>

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "sim/error.h"
#include "sim/hash.h"
#include "sim/sha256.h"
#include "tests/temp_folder.h"

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

}  // namespace
}  // namespace test
