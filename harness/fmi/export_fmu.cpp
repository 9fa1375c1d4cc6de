#include "harness/fmi/export_fmu.h"

#include <fmt/format.h>

#include <stdexcept>

#include "harness/fmi/archive.h"
#include "harness/fmi/bundle.h"
#include "harness/fmi/case_unit.h"
#include "harness/fmi/exported_case.h"

namespace quayside::harness {

namespace fs = std::filesystem;

namespace {

// Headers and archives that are compiled into the library and so are no files of the FMU.
constexpr const char* kCompiledIn[] = {"libsundials-dev", "libeigen3-dev"};

std::string licence_text(const std::vector<std::string>& packages) {
  std::string text = "This FMU holds the program Quayside " QUAYSIDE_VERSION
                     " and libraries that it uses, as packaged by Debian 12. Their copyrights and licences are beside "
                     "this file, one a package:\n\n";
  for (const std::string& package : packages) text += "  " + package + ".txt\n";
  return text;
}

}  // namespace

void export_fmu(const fs::path& case_file, const std::vector<std::string>& overrides, FmiVersion version,
                const fs::path& library, const fs::path& fmu) {
  if (!fs::exists(library)) {
    throw std::runtime_error(
        fmt::format("{}: the library for FMUs is not there; build the target quayside_fmu", library.string()));
  }
  std::string text = cases::case_text(case_file, overrides);
  const cases::Case description = cases::load_case(case_file, overrides);
  const CaseUnit unit(kModelIdentifier,
                      description);  // whatever is wrong with the case shows here and not at the importer's
  const DescriptionContents contents{description, unit.variables(), instantiation_token(text)};

  const std::string platform = version == FmiVersion::fmi2 ? "binaries/linux64/" : "binaries/x86_64-linux/";
  std::vector<ArchiveEntry> entries;
  entries.push_back({"modelDescription.xml", model_description(version, contents), {}});
  if (version == FmiVersion::fmi3) {
    entries.push_back({"terminalsAndIcons/terminalsAndIcons.xml", terminals(unit.variables()), {}});
  }
  entries.push_back({"documentation/index.html", documentation(contents), {}});
  entries.push_back({std::string("resources/") + kCaseResource, text, {}});
  if (!description.contact.network.empty()) {
    entries.push_back({std::string("resources/") + kNetworkResource, "", description.contact.network});
  }
  entries.push_back({platform + kModelIdentifier + ".so", "", library});

  std::vector<std::string> packages;
  const auto add_licence = [&](const fs::path& copyright) {
    if (copyright.empty()) return;
    const std::string package = copyright.parent_path().filename().string();
    for (const std::string& known : packages) {
      if (known == package) return;
    }
    packages.push_back(package);
    entries.push_back({"documentation/licenses/" + package + ".txt", "", fs::canonical(copyright)});
  };
  for (const BundledLibrary& bundled : libraries_of(library)) {
    entries.push_back({platform + bundled.name, "", bundled.file});
    add_licence(copyright_of(bundled.file));
  }
  for (const char* package : kCompiledIn) {
    const fs::path copyright = fs::path("/usr/share/doc") / package / "copyright";
    if (fs::exists(copyright)) add_licence(copyright);
  }
  entries.push_back({"documentation/licenses/license.txt", licence_text(packages), {}});
  write_archive(fmu, entries);
}

}  // namespace quayside::harness
