#include "harness/fmi/bundle.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>
#include <sstream>
#include <stdexcept>

namespace quayside::harness {

namespace fs = std::filesystem;

namespace {

// On every Debian 12, and better not doubled in a process: a second C or C++ library would not know of the first.
constexpr std::array<const char*, 8> kOfTheSystem{"libc.so.6",      "libm.so.6",     "libdl.so.2", "libpthread.so.0",
                                                  "libstdc++.so.6", "libgcc_s.so.1", "librt.so.1", "linux-vdso.so.1"};

std::string quoted(const std::string& argument) {
  std::string text = "'";
  for (const char c : argument) text += c == '\'' ? "'\\''" : std::string(1, c);
  return text + "'";
}

std::string output_of(const std::string& command) {
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  std::string text;
  std::array<char, 4096> buffer;
  while (pipe) {
    const std::size_t read = fread(buffer.data(), 1, buffer.size(), pipe.get());
    if (read == 0) break;
    text.append(buffer.data(), read);
  }
  return text;
}

}  // namespace

// The loader itself tells: lines "libz.so.1 => /lib/x86_64-linux-gnu/libz.so.1 (0x...)".
std::vector<BundledLibrary> libraries_of(const fs::path& library) {
  std::istringstream lines(output_of("ldd " + quoted(library.string()) + " 2>&1"));
  std::vector<BundledLibrary> libraries;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string name, arrow, file;
    words >> name >> arrow >> file;
    if (arrow != "=>") continue;
    if (std::find(kOfTheSystem.begin(), kOfTheSystem.end(), name) != kOfTheSystem.end()) continue;
    if (file == "not") throw std::runtime_error(fmt::format("{} needs {}, which is not there", library.string(), name));
    libraries.push_back({name, fs::canonical(file)});
  }
  if (libraries.empty()) throw std::runtime_error(fmt::format("{}: ldd does not tell what it needs", library.string()));
  std::sort(libraries.begin(), libraries.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
  return libraries;
}

fs::path copyright_of(const fs::path& file) {
  // Packages may know the file under /lib or under /usr/lib, which are the same.
  const std::string found = output_of("dpkg-query -S " + quoted("*/" + file.filename().string()) + " 2>/dev/null");
  const fs::path copyright = fs::path("/usr/share/doc") / found.substr(0, found.find_first_of(":, ")) / "copyright";
  std::error_code ignored;
  return !found.empty() && fs::exists(copyright, ignored) ? copyright : fs::path();
}

}  // namespace quayside::harness
