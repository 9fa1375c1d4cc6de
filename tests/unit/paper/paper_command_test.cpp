#include "contact_nn/paper/paper_command.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <CLI/CLI.hpp>
#include <gtest/gtest.h>

#include "contact_nn/onnx_file.h"

namespace quayside::contact_nn {
namespace {

namespace fs = std::filesystem;

class PaperCommand : public testing::Test {
 protected:
  ~PaperCommand() override { fs::remove_all(folder); }

  static void run(const std::string& line) {
    CLI::App app;
    CLI::App* contact = app.add_subcommand("contact");
    add_paper_commands(*contact);
    app.parse("contact " + line);
  }

  std::string path(const std::string& name) const { return (folder / name).string(); }

  static long lines(const std::string& file) {
    std::ifstream in(file);
    return std::count(std::istreambuf_iterator<char>(in), {}, '\n');
  }

  fs::path folder = [] {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    const fs::path path = fs::path(testing::TempDir()) / (std::string("quayside_paper_") + test->name());
    fs::remove_all(path);
    fs::create_directories(path);
    return path;
  }();
};

TEST_F(PaperCommand, TrihedraWritesARowPerPose) {
  run("trihedra --poses 50 --subset octant --out " + path("patterns.csv"));
  EXPECT_EQ(lines(path("patterns.csv")), 51);
}

TEST_F(PaperCommand, TrihedraRefusesAFeatureThatIsNone) {
  EXPECT_THROW(run("trihedra --subset vertex_face --of-a 3"), std::invalid_argument);
  EXPECT_THROW(run("trihedra --subset diagonal"), CLI::ParseError);
}

TEST_F(PaperCommand, EvaluateWritesTablesFiguresAndNetworks) {
  run("evaluate --table 1 --scale 0.002 --starts 1 --out " + folder.string());
  EXPECT_EQ(lines(path("tables.csv")), 12);
  EXPECT_EQ(lines(path("figure5.csv")), 101);
  EXPECT_TRUE(fs::exists(path("figure5.svg")));
  const NetworkFile file = read_network(path("with_discontinuities.onnx"), "paper_impact/1");
  EXPECT_EQ(file.network.architecture(), "6x20x18x4 tanh");
}

TEST_F(PaperCommand, TuneWritesARowPerNetwork) {
  run("tune --subset vertex_face --networks 2 --epochs 2 --out " + path("tuning.csv"));
  EXPECT_EQ(lines(path("tuning.csv")), 4);  // settings, names, two networks
}

}  // namespace
}  // namespace quayside::contact_nn
