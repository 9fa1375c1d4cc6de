// Zip archives, as FMUs are: written reproducibly, unpacked with suspicion.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace quayside::harness {

// A file of an archive: its name in there, and its bytes or where they are.
struct ArchiveEntry {
  std::string name;
  std::string bytes;
  std::filesystem::path file;  // empty: `bytes` are meant
};

// All times of files are the same, so that equal contents make equal archives. Throws std::runtime_error.
void write_archive(const std::filesystem::path& archive, const std::vector<ArchiveEntry>& entries);

// A folder of our own among the temporary files, gone with this object.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

// Throws std::invalid_argument for what is no archive, for names that leave the folder, links, and archives that are
// too large when unpacked; nothing is written before all names have been checked.
void unpack_archive(const std::filesystem::path& archive, const std::filesystem::path& folder);

}  // namespace quayside::harness
