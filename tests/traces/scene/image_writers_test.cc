#include <array>
#include <vector>

#include <gtest/gtest.h>

#include "sim/error.h"
#include "tests/temp_folder.h"
#include "traces/scene/images.h"
#include "traces/scene/images/formats.h"

namespace test {
namespace {

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
