#include "contact_nn/paper/tuning.h"

#include <filesystem>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

namespace quayside::contact_nn::paper {
namespace {

class Tuning : public testing::Test {
 protected:
  Tuning() {
    options.problem.sizes = {60, 40, 50};
    options.networks = 6;
    options.threads = 2;
    options.epochs = 5;
    options.file = (folder / "tuning.csv").string();
  }
  ~Tuning() override { std::filesystem::remove_all(folder); }

  static void expect_same(const std::vector<TunedNetwork>& a, const std::vector<TunedNetwork>& b) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
      EXPECT_EQ(a[i].number, b[i].number);
      EXPECT_EQ(a[i].recipe.hidden, b[i].recipe.hidden);
      EXPECT_EQ(a[i].best_epoch, b[i].best_epoch);
      EXPECT_NEAR(a[i].validation.absolute, b[i].validation.absolute, 1e-8);  // nine digits are written
      EXPECT_NEAR(a[i].external.square, b[i].external.square, 1e-8);
    }
  }

  std::filesystem::path folder = [] {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    const auto path = std::filesystem::path(testing::TempDir()) / (std::string("quayside_tuning_") + test->name());
    std::filesystem::remove_all(path);
    std::filesystem::create_directories(path);
    return path;
  }();
  TuningOptions options;
};

TEST_F(Tuning, RecipesStayInTheirRangesAndDependOnTheNumberAlone) {
  for (int k = 0; k < 200; ++k) {
    const Recipe r = random_recipe(options, k);
    for (int units : r.hidden) EXPECT_TRUE(units >= 5 && units <= 30);
    EXPECT_TRUE(r.adaptation >= 0.001 && r.adaptation <= 0.2);
    EXPECT_TRUE(r.momentum >= 0 && r.momentum <= 0.98);
    EXPECT_TRUE(r.amplitude >= 0.03 && r.amplitude <= 2);
    EXPECT_EQ(r.adaptation, random_recipe(options, k).adaptation);
  }
}

// Stopped after two networks, its last line cut as if the machine had died while writing, and continued with another
// number of threads: the same networks as in one go.
TEST_F(Tuning, ContinuesWhereItStopped) {
  const auto whole = tune(options);
  ASSERT_EQ(whole.size(), 6u);

  std::filesystem::remove(options.file);
  std::atomic<bool> stop{false};
  options.stop = &stop;
  options.threads = 1;
  options.progress = [&](int finished, int) { stop = finished >= 2; };
  EXPECT_EQ(tune(options).size(), 2u);
  std::ofstream(options.file, std::ios::app) << "3,12,";

  stop = false;
  options.progress = [](int, int) {};
  expect_same(tune(options), whole);
  expect_same(tune(options), whole);  // and nothing is left to do
}

TEST_F(Tuning, MoreNetworksAreAddedToAFinishedFile) {
  tune(options);
  options.networks = 8;
  int in_this_run = 0;
  options.progress = [&](int, int count) { in_this_run = count; };
  EXPECT_EQ(tune(options).size(), 8u);
  EXPECT_EQ(in_this_run, 2);
}

TEST_F(Tuning, RefusesAFileOfOtherSettings) {
  tune(options);
  options.problem.reading = Reading::unfiltered;
  EXPECT_THROW(tune(options), std::invalid_argument);
}

TEST_F(Tuning, RefusesDamagedRowsAndFoldersThatDoNotExist) {
  tune(options);
  std::ofstream(options.file, std::ios::app) << "seven,1,2\n";
  EXPECT_THROW(tune(options), std::invalid_argument);
  options.file = (folder / "missing" / "tuning.csv").string();
  EXPECT_THROW(tune(options), std::runtime_error);
}

TEST_F(Tuning, TheTableBeginsWithTheBestOnTheValidationSet) {
  options.networks = 9;
  const auto networks = tune(options);
  std::ostringstream out;
  print(networks, out);
  const auto best = std::min_element(networks.begin(), networks.end(), [](const auto& a, const auto& b) {
    return a.validation.absolute < b.validation.absolute;
  });
  const std::string text = out.str(), rule = "|---|---|---|---|---|---|---|---|---|\n";
  EXPECT_EQ(text.find("| " + std::to_string(best->number) + " |", text.find(rule)), text.find(rule) + rule.size());
  EXPECT_NE(text.find("| momentum |"), std::string::npos);
}

}  // namespace
}  // namespace quayside::contact_nn::paper
