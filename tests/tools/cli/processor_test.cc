#include <filesystem>

#include <gtest/gtest.h>

#include "tests/tools/program.h"

// Tests the program on older processors, emulated by QEMU (`tools/validate package` installs it).

namespace test {
namespace {

ProcessResult on_processor(const char* name) {
  return raywatt({"-cpu", name, RAYWATT_PROGRAM, "--version"}, {.program = "/usr/bin/qemu-x86_64"});
}

struct Processors : testing::Test {
  void SetUp() override {
#ifdef RAYWATT_SANITIZED
    GTEST_SKIP() << "sanitizers look at the processor first";
#elif !defined(__x86_64__)
    GTEST_SKIP() << "any processor of this kind will do";
#endif
    if (!std::filesystem::exists("/usr/bin/qemu-x86_64"))
      GTEST_SKIP() << "there is no qemu-x86_64 (Debian's qemu-user)";
  }
};

TEST_F(Processors, WithoutAvx2GetOneLineAndNoCrash) {
  for (const char* name : {"Nehalem", "SandyBridge", "qemu64"}) {
    const ProcessResult ending = on_processor(name);
    EXPECT_EQ(ending.exit, 2) << name << ": " << ending.err;
    EXPECT_EQ(ending.out, "") << name;
    EXPECT_NE(ending.err.find("raywatt: needs a processor with AVX2, FMA and BMI2 (x86-64-v3)"), std::string::npos)
        << name << ": " << ending.err;
  }
}

TEST_F(Processors, WithAvx2AreTaken) {
  const ProcessResult ending = on_processor("Haswell");
  EXPECT_EQ(ending.exit, 0) << ending.err;
  EXPECT_TRUE(ending.out.starts_with("raywatt ")) << ending.out;
}

}  // namespace
}  // namespace test
