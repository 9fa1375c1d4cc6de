// The shared libraries that an FMU takes along, so that it runs where none of our packages are installed.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace quayside::harness {

struct BundledLibrary {
  std::string name;            // under which it is looked for: "libSimTKmath.so.3.7"
  std::filesystem::path file;  // where it is, all links followed
};

// What `library` needs, directly or not, but for what every Debian has (the C and C++ libraries, the loader). Throws
// std::runtime_error if something is missing.
std::vector<BundledLibrary> libraries_of(const std::filesystem::path& library);

// The copyright file of the Debian package that a file belongs to; empty if none is found.
std::filesystem::path copyright_of(const std::filesystem::path& file);

}  // namespace quayside::harness
