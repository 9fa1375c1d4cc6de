#include "contact_nn/contact_command.h"

#include <filesystem>
#include <fstream>
#include <sstream>

#include <CLI/CLI.hpp>
#include <gtest/gtest.h>

#include "contact_nn/exact_module.h"
#include "contact_nn/onnx_file.h"

namespace quayside::contact_nn {
namespace {

std::string answers_to(const std::string& poses, double margin = 0) {
  const auto module = make_exact_module({});
  std::istringstream in(poses);
  std::ostringstream out;
  answer_queries(in, "poses.csv", *module, margin, out);
  return out.str();
}

std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

std::vector<std::string> fields_of(const std::string& line) {
  std::istringstream in(line);
  std::vector<std::string> fields;
  for (std::string field; std::getline(in, field, ',');) fields.push_back(field);
  return fields;
}

// Cubes of edge 2, one 1.99 above the other: they overlap by 10 mm over the whole face, the points are its corners,
// halfway between the surfaces at z = 0.99 and 1, so at 0.995.
TEST(ContactQuery, AnswersARow) {
  const auto lines = lines_of(answers_to("left one, 1,1,1, 1,1,1, 0,0,1.99, 1,0,0,0\n"));
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0].substr(0, 24), "id,gap,nx,ny,nz,class,n,");
  const auto fields = fields_of(lines[1]);
  ASSERT_EQ(fields.size(), 7u + 4 * 4);
  EXPECT_EQ(fields[0], "left one");
  EXPECT_NEAR(std::stod(fields[1]), -0.01, 1e-15);
  EXPECT_EQ(std::stod(fields[4]), 1);
  EXPECT_EQ(fields[5], "face_a");
  EXPECT_EQ(fields[6], "4");
  for (std::size_t i = 7; i < fields.size(); i += 4) {
    EXPECT_EQ(std::abs(std::stod(fields[i])), 1);
    EXPECT_NEAR(std::stod(fields[i + 2]), 0.995, 1e-15);
    EXPECT_NEAR(std::stod(fields[i + 3]), 0.01, 1e-15);
  }
}

TEST(ContactQuery, SeparatedPairsHavePointsOnlyWithinTheMargin) {
  const std::string row = "1,1,1,1,1,1,1,0,0,2.01,1,0,0,0\n";
  EXPECT_EQ(fields_of(lines_of(answers_to(row))[1])[5], "apart");
  EXPECT_EQ(fields_of(lines_of(answers_to(row))[1])[6], "0");
  EXPECT_EQ(fields_of(lines_of(answers_to(row, 0.02))[1])[6], "4");
}

TEST(ContactQuery, SkipsAHeaderAndEmptyLinesAndKeepsTheOrder) {
  const auto lines = lines_of(answers_to("id,ax,ay,az,bx,by,bz,px,py,pz,qw,qx,qy,qz\r\n"
                                         "b,1,1,1,1,1,1,0,0,3,1,0,0,0\r\n\n"
                                         "a,1,1,1,1,1,1,0,0,4,1,0,0,0\n"));
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_EQ(lines[1].substr(0, 4), "b,1,");
  EXPECT_EQ(lines[2].substr(0, 4), "a,2,");
}

TEST(ContactQuery, SaysWhichRowIsWrongAndWhy) {
  const auto message = [](const std::string& row) {
    try {
      answers_to("id,...\n" + row + "\n");
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  EXPECT_EQ(message("1,1,1,1,1,1,1,0,0,3,1,0,0"), "poses.csv:2: 12 numbers after the id, but 13 are needed: ax,ay,az, "
                                                  "bx,by,bz, px,py,pz, qw,qx,qy,qz");
  EXPECT_EQ(message("1,1,1,0,1,1,1,0,0,3,1,0,0,0"), "poses.csv:2: half extents must be positive");
  EXPECT_EQ(message("1,1,1,1,1,1,1,0,0,nan,1,0,0,0"), "poses.csv:2: every number must be finite");
  EXPECT_EQ(message("1,1,1,1,1,1,1,0,0,3,1,0,0,1"),
            "poses.csv:2: the quaternion has length 1.41421356 instead of 1");
  EXPECT_EQ(message("1,1,1,1,1,1,1,0,0,three,1,0,0,0"), "poses.csv:2: every field after the id must be a number");
}

TEST(ContactQuery, ReadsWhatDatasetWrites) {
  const auto pairs = sample_pairs(200, {PoseDomain::any}, {}, 1);
  std::ostringstream table;
  write_pairs(pairs, table);
  const auto lines = lines_of(answers_to(table.str()));
  ASSERT_EQ(lines.size(), 201u);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const double gap = std::stod(fields_of(lines[i + 1])[1]);
    // The rotation goes through a quaternion of 16 digits, on lever arms of up to 200 m.
    EXPECT_NEAR(gap, separation(pairs[i].a, pairs[i].b, pairs[i].X_AB), 1e-12);
  }
}

void run(std::vector<std::string> arguments) {
  CLI::App app;
  add_contact_commands(app);
  std::reverse(arguments.begin(), arguments.end());  // as CLI11 wants them
  app.parse(arguments);
}

TEST(ContactCommand, WorksFromPosesToAnswersWithANetworkOfItsOwn) {
  const std::string folder = testing::TempDir() + "contact_command_test/";
  std::filesystem::create_directory(folder);
  testing::internal::CaptureStdout();
  run({"contact", "dataset", "--domain", "side", "--pairs", "300", "-o", folder + "poses.csv"});
  run({"contact", "train", "--gate", "points", "--pairs", "1000", "--epochs", "2", "-o", folder + "gate.onnx"});
  run({"contact", "check", "--poses", "600", "--threads", "1", "--network", folder + "gate.onnx"});
  run({"contact", "query", folder + "poses.csv", "-o", folder + "committee.csv"});
  run({"contact", "query", folder + "poses.csv", "--model", "exact", "-o", folder + "exact.csv"});
  testing::internal::GetCapturedStdout();
  const auto content = [&](const char* name) {
    std::ostringstream text;
    text << std::ifstream(folder + name).rdbuf();
    return text.str();
  };
  EXPECT_EQ(lines_of(content("exact.csv")).size(), 301u);
  EXPECT_EQ(content("committee.csv"), content("exact.csv"));
  EXPECT_THROW(run({"contact", "query", folder + "missing.csv"}), std::invalid_argument);
  EXPECT_THROW(run({"contact", "train", "--gate", "mlp", "-o", "x"}), CLI::ParseError);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace quayside::contact_nn
