// The built program as a process: started with arguments, its output caught, its end awaited.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

namespace quayside::testing_cli {

// A directory of one test, gone with it.
class TemporaryDirectory {
 public:
  TemporaryDirectory();
  ~TemporaryDirectory();
  TemporaryDirectory(const TemporaryDirectory&) = delete;
  TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path write(const std::string& name, const std::string& text) const;

 private:
  std::filesystem::path path_;
};

std::string read(const std::filesystem::path& file);

struct Outcome {
  int exit_code = -1;  // −1: ended by a signal
  std::string out, err;
};

class Program {
 public:
  // Starts the program in `directory` (empty: here).
  explicit Program(const std::vector<std::string>& arguments, const std::filesystem::path& directory = {});
  void signal(int number) const;
  bool running();
  Outcome wait();

 private:
  TemporaryDirectory files_;
  pid_t process_ = 0;
  int status_ = 0;
  bool ended_ = false;
};

Outcome run(const std::vector<std::string>& arguments, const std::filesystem::path& directory = {});

// What the program writes when stdout and stderr are a terminal, with one more variable in its environment.
std::string run_on_terminal(const std::vector<std::string>& arguments, const std::string& variable, const std::string& value);

}  // namespace quayside::testing_cli
