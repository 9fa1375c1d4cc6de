#include "tests/acceptance/cli/program.h"

#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <fstream>
#include <pty.h>
#include <spawn.h>
#include <sstream>
#include <stdexcept>
#include <sys/wait.h>
#include <unistd.h>

namespace quayside::testing_cli {

namespace fs = std::filesystem;

namespace {

std::vector<char*> argument_pointers(std::vector<std::string>& words) {
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  return pointers;
}

std::vector<std::string> command_words(const std::vector<std::string>& arguments) {
  std::vector<std::string> words{QUAYSIDE_PROGRAM};
  words.insert(words.end(), arguments.begin(), arguments.end());
  return words;
}

}  // namespace

TemporaryDirectory::TemporaryDirectory() {
  std::string name = (fs::temp_directory_path() / "quayside_cli_XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary directory");
  path_ = name;
}

TemporaryDirectory::~TemporaryDirectory() { fs::remove_all(path_); }

fs::path TemporaryDirectory::write(const std::string& name, const std::string& text) const {
  std::ofstream(path_ / name, std::ios::binary) << text;
  return path_ / name;
}

std::string read(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

Program::Program(const std::vector<std::string>& arguments, const fs::path& directory) {
  auto words = command_words(arguments);
  auto pointers = argument_pointers(words);
  const std::string out = (files_.path() / "out").string(), err = (files_.path() / "err").string();
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out.c_str(), O_WRONLY | O_CREAT, 0600);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, err.c_str(), O_WRONLY | O_CREAT, 0600);
  if (!directory.empty()) posix_spawn_file_actions_addchdir_np(&actions, directory.c_str());
  const int error = posix_spawn(&process_, words.front().c_str(), &actions, nullptr, pointers.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) throw std::runtime_error("cannot start " + words.front());
}

void Program::signal(int number) const { kill(process_, number); }

bool Program::running() {
  if (!ended_) ended_ = waitpid(process_, &status_, WNOHANG) == process_;
  return !ended_;
}

Outcome Program::wait() {
  if (!ended_) waitpid(process_, &status_, 0);
  ended_ = true;
  return {WIFEXITED(status_) ? WEXITSTATUS(status_) : -1, read(files_.path() / "out"), read(files_.path() / "err")};
}

Outcome run(const std::vector<std::string>& arguments, const fs::path& directory) {
  return Program(arguments, directory).wait();
}

std::string run_on_terminal(const std::vector<std::string>& arguments, const std::string& variable, const std::string& value) {
  int terminal = -1;
  const pid_t process = forkpty(&terminal, nullptr, nullptr, nullptr);
  if (process < 0) throw std::runtime_error("no terminal");
  if (process == 0) {
    setenv("TERM", "xterm", 1);
    setenv(variable.c_str(), value.c_str(), 1);
    auto words = command_words(arguments);
    auto pointers = argument_pointers(words);
    execv(pointers[0], pointers.data());
    _exit(127);
  }
  std::string text;
  char block[4096];
  for (ssize_t n; (n = ::read(terminal, block, sizeof block)) > 0;) text.append(block, static_cast<std::size_t>(n));
  close(terminal);
  waitpid(process, nullptr, 0);
  return text;
}

}  // namespace quayside::testing_cli
