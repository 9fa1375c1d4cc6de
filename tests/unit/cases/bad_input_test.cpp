// Wrong input is refused with a message that says what to change, and no input does worse than that.
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

#include <gtest/gtest.h>

#include "cases/case.h"

namespace quayside::cases {
namespace {

namespace fs = std::filesystem;

const fs::path kBad = "tests/unit/cases/bad";
const fs::path kEveryKey = "tests/unit/cases/every_key.yaml";

// The message that refuses a case, or empty if it is accepted.
std::string refusal(const fs::path& file, const std::vector<std::string>& overrides = {}) {
  try {
    load_case(file, overrides);
    return "";
  } catch (const CaseError& error) {
    return error.what();
  }
}

// A directory for the files of one test, gone with it.
class TemporaryDirectory {
 public:
  TemporaryDirectory() {
    std::string name = (fs::temp_directory_path() / "quayside_cases_XXXXXX").string();
    path_ = mkdtemp(name.data());
  }
  ~TemporaryDirectory() { fs::remove_all(path_); }

  fs::path write(const std::string& text) const {
    const fs::path file = path_ / "case.yaml";
    fs::remove(file);  // file systems flush a file that is cut and rewritten: slow a thousand times over
    std::ofstream(file, std::ios::binary) << text;
    return file;
  }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

std::string read(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

// The first line of every bad file says what the message must hold: "# expect: :line: key.path: what is wrong, expected
// ...".
TEST(BadInput, EveryBadFileIsRefusedWithItsMessage) {
  int count = 0;
  for (const auto& entry : fs::directory_iterator(kBad)) {
    const fs::path file = entry.path();
    std::string first_line;
    std::ifstream stream(file);
    std::getline(stream, first_line);
    const std::string prefix = "# expect: ";
    ASSERT_EQ(first_line.substr(0, prefix.size()), prefix) << file;
    const std::string message = refusal(file);
    EXPECT_EQ(message.substr(0, file.string().size()), file.string());
    EXPECT_NE(message.find(first_line.substr(prefix.size())), std::string::npos)
        << file << "\n  want " << first_line.substr(prefix.size()) << "\n  got  " << message;
    EXPECT_NE(message.find("expected "), std::string::npos) << message;
    ++count;
  }
  EXPECT_GE(count, 30);
}

TEST(BadInput, MissingFileDirectoryAndUnreadableFile) {
  const TemporaryDirectory directory;
  const fs::path nowhere = directory.path() / "nowhere.yaml";
  EXPECT_EQ(refusal(nowhere), nowhere.string() + ": no such file, expected a case file (YAML)");
  EXPECT_EQ(refusal(directory.path()), directory.path().string() + ": a directory, expected a case file (YAML)");
  EXPECT_NE(refusal(directory.write("")).find("empty, expected a case"), std::string::npos);
  EXPECT_NE(refusal(std::string(10000, 'x')).find("expected a"), std::string::npos);  // longer than any name of a file
  const fs::path locked = directory.write("title: t\n");
  fs::permissions(locked, fs::perms::none);
  if (access(locked.c_str(), R_OK) != 0) {  // root may read everything
    EXPECT_NE(refusal(locked).find("cannot be read (Permission denied)"), std::string::npos);
  }
}

TEST(BadInput, LargeFilesAreRefusedUnread) {
  const TemporaryDirectory directory;
  const fs::path file = directory.write("title: t\n");
  fs::resize_file(file, 100'000'000);  // sparse: takes no space on the disk
  EXPECT_EQ(refusal(file), file.string() + ": too large, expected a case file of at most 1000 kB");
  EXPECT_EQ(refusal("/dev/zero"), "/dev/zero: too large, expected a case file of at most 1000 kB");  // and has no end
}

TEST(BadInput, LargeAndDeepDocumentsAreRefused) {
  const TemporaryDirectory directory;
  std::string bodies;
  for (int i = 0; i < 201; ++i) bodies += "\n  - {name: b" + std::to_string(i) + "}";
  EXPECT_NE(refusal(directory.write("title: t\nduration: 1\nbodies:" + bodies)).find("expected a list of at most 200"),
            std::string::npos);
  std::string values = "[0";
  for (int i = 0; i < 100'000; ++i) values += ",0";
  EXPECT_NE(refusal(directory.write("gravity: " + values + "]")).find("too many values"), std::string::npos);
  for (const std::string open : {"[", "{a: ", "- "}) {
    std::string deep;
    while (deep.size() < 900'000) deep += open;
    EXPECT_NE(refusal(directory.write(deep)), "") << open;
  }
  EXPECT_NE(refusal(directory.write("title: " + std::string(900'000, 'x') + "\n")).find("expected a text of 1 to 1000"),
            std::string::npos);
}

TEST(BadInput, OverridesAreNamedInTheMessage) {
  const auto message = [](const std::string& text) {
    const std::string prefix = kEveryKey.string() + ": override '" + text + "': ";
    const std::string message = refusal(kEveryKey, {text});
    EXPECT_EQ(message.substr(0, prefix.size()), prefix);
    return message.size() > prefix.size() ? message.substr(prefix.size()) : message;
  };
  EXPECT_EQ(message("duration"), "no '=', expected key.path=value");
  EXPECT_EQ(message("duration="), "no value, expected key.path=value");
  EXPECT_EQ(message("=3"), "an empty key, expected key.path=value");
  EXPECT_EQ(message("crane..type=none"), "an empty key, expected key.path=value");
  EXPECT_EQ(message("duration=long"), "duration: found 'long', expected a number from 0.001 to 3600 s");
  EXPECT_EQ(message("containers.load.mass=0"), "containers.0.mass: found '0', expected a number from 100 to 100000 kg");
  EXPECT_EQ(message("containers.ship.mass=1"), "containers has no entry 'ship', expected a name or an index below 4");
  EXPECT_EQ(message("containers.4.mass=1"), "containers has no entry '4', expected a name or an index below 4");
  EXPECT_EQ(message("containers.-1.mass=1"), "containers has no entry '-1', expected a name or an index below 4");
  EXPECT_EQ(message("duration.x=1"), "duration is '30', it has no key 'x'");
  EXPECT_EQ(
      message("crane.hoist.rope_lenght=1"),
      "crane.hoist: unknown key 'rope_lenght' (did you mean 'rope_length'?), expected one of: rope_length, range, max_speed, "
      "max_acceleration, max_jerk, emergency_stop");
  EXPECT_EQ(message("gravity=[0, 0"), "a list or mapping as a key, expected a word (is a closing bracket missing?)");
}

// Random damage to a good file: it is accepted or refused, and nothing else happens.
TEST(BadInput, DamagedFilesDoNoHarm) {
  const TemporaryDirectory directory;
  const std::string good = read(kEveryKey);
  std::mt19937 random(20240501);
  const auto below = [&](std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random); };
  const std::string signs = "[]{}:,-#&*!|>'\"%@`? \n\t0.e~<\xff";
  int refused = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    std::string text = good;
    switch (trial % 3) {
      case 0:
        text.resize(below(text.size()));
        break;
      case 1:
        text.erase(below(text.size()), 1 + below(40));
        break;
      default:
        for (int i = 0; i < 3; ++i) text[below(text.size())] = signs[below(signs.size())];
    }
    refused += !refusal(directory.write(text)).empty();
  }
  EXPECT_GT(refused, 500);  // most damage cannot go unnoticed; some hits comments, titles and digits
  for (int trial = 0; trial < 200; ++trial) {
    std::string noise(1 + below(200), ' ');
    for (char& c : noise) c = static_cast<char>(below(256));
    EXPECT_NE(refusal(directory.write(noise)), "");
  }
}

}  // namespace
}  // namespace quayside::cases
