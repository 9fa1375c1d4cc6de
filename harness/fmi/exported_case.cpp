#include "harness/fmi/exported_case.h"

#include <fmt/format.h>

#include <fstream>
#include <sstream>

namespace quayside::harness {

namespace {

// Fowler, Noll and Vo's hash, variant 1a.
std::uint64_t hash(const std::string& text, std::uint64_t basis) {
  for (const unsigned char c : text) basis = (basis ^ c) * 0x100000001b3u;
  return basis;
}

}  // namespace

std::string instantiation_token(const std::string& case_text) {
  const std::string text = std::string(QUAYSIDE_VERSION) + '\n' + case_text;
  const std::uint64_t a = hash(text, 0xcbf29ce484222325u), b = hash(text, a);
  return fmt::format("{{{:08x}-{:04x}-{:04x}-{:04x}-{:012x}}}", a >> 32, (a >> 16) & 0xffff, a & 0xffff, b >> 48,
                     b & 0xffffffffffff);
}

std::string exported_case_text(const std::filesystem::path& resources) {
  const std::filesystem::path file = resources / kCaseResource;
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  if (!stream)
    throw cases::CaseError(fmt::format("{}: cannot be read; it belongs to the FMU's resources", file.string()));
  return text.str();
}

cases::Case load_exported_case(const std::filesystem::path& resources) {
  cases::Case description = cases::load_case(resources / kCaseResource);
  const std::filesystem::path network = resources / kNetworkResource;
  if (!description.contact.network.empty()) description.contact.network = network.string();
  return description;
}

}  // namespace quayside::harness
