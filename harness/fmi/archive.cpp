#include "harness/fmi/archive.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zip.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <memory>
#include <stdexcept>

namespace quayside::harness {

namespace fs = std::filesystem;

namespace {

constexpr time_t kFileTime = 946684800;                    // 2000-01-01: zip files know no time before 1980
constexpr zip_uint32_t kCompression = 3;                   // of 1 to 9: a third of the time of 6, 5 % larger
constexpr zip_uint64_t kLargestUnpacked = 4'000'000'000u;  // an FMU with libraries has some 30 MB [bytes]
constexpr zip_int64_t kMostEntries = 100'000;

struct Closer {
  void operator()(zip_t* archive) const { zip_discard(archive); }
  void operator()(zip_file_t* file) const { zip_fclose(file); }
};

std::string error_text(int code) {
  zip_error_t error;
  zip_error_init_with_code(&error, code);
  const std::string text = zip_error_strerror(&error);
  zip_error_fini(&error);
  return text;
}

// A name that stays inside of the folder it is unpacked to.
bool stays_inside(const std::string& name) {
  if (name.empty() || name.front() == '/' || name.find('\\') != std::string::npos ||
      name.find(':') != std::string::npos) {
    return false;
  }
  for (const fs::path& part : fs::path(name)) {
    if (part == "..") return false;
  }
  return true;
}

bool is_link(zip_t* archive, zip_uint64_t index) {
  zip_uint8_t system = 0;
  zip_uint32_t attributes = 0;
  zip_file_get_external_attributes(archive, index, 0, &system, &attributes);
  return system == ZIP_OPSYS_UNIX && (attributes >> 16 & S_IFMT) == S_IFLNK;
}

}  // namespace

void write_archive(const fs::path& path, const std::vector<ArchiveEntry>& entries) {
  int code = 0;
  std::unique_ptr<zip_t, Closer> archive(zip_open(path.c_str(), ZIP_CREATE | ZIP_TRUNCATE, &code));
  if (!archive) throw std::runtime_error(fmt::format("{}: cannot be written: {}", path.string(), error_text(code)));
  const auto demand = [&](bool good, const std::string& name) {
    if (!good) throw std::runtime_error(fmt::format("{}: {}: {}", path.string(), name, zip_strerror(archive.get())));
  };
  for (const ArchiveEntry& entry : entries) {
    zip_source_t* source = entry.file.empty()
                               ? zip_source_buffer(archive.get(), entry.bytes.data(), entry.bytes.size(), 0)
                               : zip_source_file(archive.get(), entry.file.c_str(), 0, -1);
    demand(source, entry.name);
    const zip_int64_t index = zip_file_add(archive.get(), entry.name.c_str(), source, ZIP_FL_ENC_UTF_8);
    if (index < 0) zip_source_free(source);
    demand(index >= 0, entry.name);
    zip_set_file_compression(archive.get(), static_cast<zip_uint64_t>(index), ZIP_CM_DEFLATE, kCompression);
    zip_file_set_mtime(archive.get(), static_cast<zip_uint64_t>(index), kFileTime, 0);
  }
  demand(zip_close(archive.get()) == 0, "cannot be written");
  archive.release();
}

TemporaryFolder::TemporaryFolder() {
  std::string pattern = (fs::temp_directory_path() / "quayside_fmu_XXXXXX").string();
  if (!mkdtemp(pattern.data())) {
    throw std::runtime_error(fmt::format("{}: cannot be made: {}", pattern, std::strerror(errno)));
  }
  path_ = pattern;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

void unpack_archive(const fs::path& path, const fs::path& folder) {
  const auto refuse = [&](const std::string& why) {
    throw std::invalid_argument(fmt::format("{}: {}", path.string(), why));
  };
  int code = 0;
  const std::unique_ptr<zip_t, Closer> archive(zip_open(path.c_str(), ZIP_RDONLY | ZIP_CHECKCONS, &code));
  if (!archive) refuse("no zip archive that can be read: " + error_text(code));
  const zip_int64_t count = zip_get_num_entries(archive.get(), 0);
  if (count > kMostEntries) refuse(fmt::format("{} files in one FMU are too many", count));
  zip_uint64_t total = 0;
  for (zip_int64_t i = 0; i < count; ++i) {
    zip_stat_t entry;
    if (zip_stat_index(archive.get(), i, 0, &entry) != 0) refuse(zip_strerror(archive.get()));
    if (!stays_inside(entry.name))
      refuse(fmt::format("its file '{}' would leave the folder it is unpacked to", entry.name));
    if (is_link(archive.get(), i))
      refuse(fmt::format("its file '{}' is a link, which an FMU has no use for", entry.name));
    total += entry.size;
    if (entry.size > kLargestUnpacked || total > kLargestUnpacked) refuse("unpacked it would have more than 4 GB");
  }

  std::vector<char> buffer(1 << 16);
  for (zip_int64_t i = 0; i < count; ++i) {
    const std::string name = zip_get_name(archive.get(), i, 0);
    const fs::path target = folder / name;
    if (name.back() == '/') {
      fs::create_directories(target);
      continue;
    }
    fs::create_directories(target.parent_path());
    const std::unique_ptr<zip_file_t, Closer> file(zip_fopen_index(archive.get(), i, 0));
    if (!file) refuse(fmt::format("{}: {}", name, zip_strerror(archive.get())));
    std::ofstream out(target, std::ios::binary);
    zip_int64_t read = 0, written = 0;
    while ((read = zip_fread(file.get(), buffer.data(), buffer.size())) > 0) {
      written += read;
      if (static_cast<zip_uint64_t>(written) > kLargestUnpacked) refuse(name + ": larger than it says");
      out.write(buffer.data(), read);
    }
    if (read < 0) refuse(fmt::format("{}: {}", name, zip_file_strerror(file.get())));
    if (!out.flush())
      throw std::runtime_error(fmt::format("{}: cannot be written; is the disk full?", target.string()));
  }
}

}  // namespace quayside::harness
