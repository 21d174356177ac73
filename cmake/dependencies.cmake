# Everything is a system package; tools/packages.txt lists their Debian names.
find_package(PkgConfig REQUIRED)
find_package(Threads REQUIRED)

find_package(embree 3 QUIET)
if(NOT embree_FOUND)
  find_package(embree 4 REQUIRED)
endif()
# OpenImageIO's own CMake files ask for packages that Debian's -dev package does not pull in.
pkg_check_modules(OIIO REQUIRED IMPORTED_TARGET OpenImageIO)
find_package(glm REQUIRED)
find_package(TinyGLTF REQUIRED)
find_package(yaml-cpp REQUIRED)
find_package(CLI11 REQUIRED)
find_package(fmt REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(OpenSSL REQUIRED COMPONENTS Crypto)
