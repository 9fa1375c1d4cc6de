// Trajectories and events survive the way through a file, and bad files are refused with their line.
#include "harness/recording.h"

#include <cstring>
#include <fstream>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "harness/events_csv.h"

namespace quayside::harness {
namespace {

class Files : public testing::Test {
 protected:
  Files() {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    directory_ = std::filesystem::temp_directory_path() / ("quayside_recording_" + std::string(test->name()));
    std::filesystem::create_directories(directory_);
  }
  ~Files() override { std::filesystem::remove_all(directory_); }

  std::filesystem::path file(const std::string& name = "some.csv") const { return directory_ / name; }
  std::filesystem::path written(const std::string& text) const {
    std::ofstream(file(), std::ios::binary) << text;
    return file();
  }
  std::string text() const {
    std::ifstream stream(file(), std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }

 private:
  std::filesystem::path directory_;
};

std::uint64_t bits(double value) {
  std::uint64_t result;
  std::memcpy(&result, &value, sizeof value);
  return result;
}

// Every finite double has a decimal that reads back to the same bits: random patterns, denormals and zeros of both signs.
TEST_F(Files, TrajectoryReadsBackToTheSameBits) {
  std::mt19937_64 random(20240607);
  Recording recording;
  recording.names = {"load.position.z", "odd, \"quoted\"", "landed"};
  recording.units = {"m", "kg m²/s", ""};
  recording.columns.resize(3);
  for (int i = 0; i < 2000; ++i) {
    recording.times.push_back(i * 0.01);
    for (auto& column : recording.columns) {
      double value;
      do {
        const std::uint64_t pattern = random();
        std::memcpy(&value, &pattern, sizeof value);
      } while (!std::isfinite(value));
      column.push_back(value);
    }
  }
  using Limits = std::numeric_limits<double>;
  const std::vector<double> special{-0.0, 0.0, Limits::denorm_min(), Limits::max(), Limits::lowest(), 0.1, Limits::infinity()};
  std::copy(special.begin(), special.end(), recording.columns[0].begin());

  write_csv(recording, file());
  const Recording read = read_csv(file());
  EXPECT_EQ(read.names, recording.names);
  EXPECT_EQ(read.units, recording.units);
  ASSERT_EQ(read.times, recording.times);
  ASSERT_EQ(read.columns.size(), 3u);
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t row = 0; row < recording.times.size(); ++row) {
      ASSERT_EQ(bits(read.columns[c][row]), bits(recording.columns[c][row])) << recording.columns[c][row];
    }
  }
}

TEST_F(Files, TrajectoryIsWrittenAsPeopleReadIt) {
  write_csv({{"load.position.z", "landed"}, {"m", ""}, {0, 0.3}, {{5.182, 1e-300}, {0, 1}}}, file());
  EXPECT_EQ(text(), "time [s],load.position.z [m],landed\n0,5.182,0\n0.3,1e-300,1\n");
}

TEST_F(Files, ReadsWhatOtherProgramsWrite) {
  const Recording read = read_csv(written("\xEF\xBB\xBFtime [s],\"force, total [kN]\"\r\n0, 1.5\r\n\r\n1e-1,-2\r\n"));
  EXPECT_EQ(read.names, std::vector<std::string>{"force, total"});
  EXPECT_EQ(read.units, std::vector<std::string>{"kN"});
  EXPECT_EQ(read.times, (std::vector<double>{0, 0.1}));
  EXPECT_EQ(read.columns[0], (std::vector<double>{1.5, -2}));
}

TEST_F(Files, BadTrajectoriesAreRefusedWithTheirLine) {
  const auto refusal = [&](const std::string& text) -> std::string {
    try {
      read_csv(written(text));
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  };
  const auto says = [](const std::string& message, const std::string& part) { return message.find(part) != std::string::npos; };
  EXPECT_PRED2(says, refusal(""), "is empty");
  EXPECT_PRED2(says, refusal("z [m],time [s]\n"), "some.csv:1: the first column is \"z [m]\"; expected \"time [s]\"");
  EXPECT_PRED2(says, refusal("time [ms],z\n"), "expected \"time [s]\"");
  EXPECT_PRED2(says, refusal("time [s],z [m],z [m]\n"), "two columns");
  EXPECT_PRED2(says, refusal("time [s],z,\n"), "column 3 has no name");
  EXPECT_PRED2(says, refusal("time [s],z\n0,1\n1\n"), "some.csv:3: 1 cells");
  EXPECT_PRED2(says, refusal("time [s],z\n0,1\n1,2,3\n"), "some.csv:3: 3 cells");
  EXPECT_PRED2(says, refusal("time [s],z\n0,1\n\n1,a lot\n"), "some.csv:4: column \"z\": expected a number, found \"a lot\"");
  EXPECT_PRED2(says, refusal("time [s],z\n0,\n"), "expected a number");
  EXPECT_PRED2(says, refusal("time [s],z\n0,1,5\n"), "3 cells");
  EXPECT_PRED2(says, refusal("time [s],z\n0,1.5 m\n"), "expected a number");
  EXPECT_PRED2(says, refusal("time [s],z\n0,1e999\n"), "does not fit");
  EXPECT_PRED2(says, refusal("time [s],z\n1,1\n1,2\n"), "some.csv:3: time 1 s does not come after 1 s");
  EXPECT_PRED2(says, refusal("time [s],z\nnan,1\n"), "finite");
  EXPECT_PRED2(says, refusal("time [s],\"z\n0,1\n"), "quotation");
  EXPECT_THROW(read_csv(file("missing.csv")), std::runtime_error);
  EXPECT_THROW(read_csv(file().parent_path()), std::runtime_error);
  EXPECT_THROW(write_csv({}, file("no/such/directory.csv")), std::runtime_error);
}

TEST(Recording, FindsSignalsByNameAndVectorsByTheirStem) {
  const Recording recording{{"a.position.x", "a.position.y", "a.position.z", "a.orientation.w", "a.orientation.x",
                             "a.orientation.y", "a.orientation.z", "landed"},
                            std::vector<std::string>(8), {}, std::vector<std::vector<double>>(8)};
  EXPECT_EQ(recording.index("landed"), 7u);
  EXPECT_EQ(recording.indices("landed"), std::vector<std::size_t>{7});
  EXPECT_EQ(recording.indices("a.position"), (std::vector<std::size_t>{0, 1, 2}));
  EXPECT_EQ(recording.indices("a.orientation"), (std::vector<std::size_t>{3, 4, 5, 6}));
  try {
    recording.index("a.positon.z");
    FAIL();
  } catch (const std::out_of_range& error) {
    EXPECT_NE(std::string(error.what()).find("nearest: a.position.z"), std::string::npos) << error.what();
  }
  EXPECT_THROW(recording.indices("b"), std::out_of_range);
}

TEST(Recording, InterpolatesLinearlyWithinItsSpan) {
  const Recording recording{{"z"}, {"m"}, {0, 1, 3}, {{0, 10, 20}}};
  EXPECT_EQ(recording.at(0, 0), 0);
  EXPECT_EQ(recording.at(0, 0.25), 2.5);
  EXPECT_EQ(recording.at(0, 1), 10);
  EXPECT_EQ(recording.at(0, 2), 15);
  EXPECT_EQ(recording.at(0, 3), 20);
  EXPECT_THROW(recording.at(0, 3.001), std::out_of_range);
  EXPECT_THROW(recording.at(0, -0.001), std::out_of_range);
  EXPECT_THROW(recording.at(1, 1), std::out_of_range);
}

TEST_F(Files, EventsReadBackTheSame) {
  const std::vector<EngineEvents> engines{
      {"simbody",
       {{{1'000'000'001, EventKind::contact_made, "load/upper"},
         {1'500'000'000, EventKind::contact_broken, "load/upper", 1234.5, 1e6 / 3, 0.499999999},
         {1'500'000'000, EventKind::rope_slack, "rope.front_left"}},
        {{2'000'000'000, EventKind::contact_broken, "load/upper", 1, 2, 0.25}}}},
      {"mujoco", {{{1'000'000'000, EventKind::landed, "landed"}}, {}}}};
  write_events_csv(engines, file());
  EXPECT_EQ(text(),
            "time [s],engine,event,subject,impulse [N s],peak_force [N],duration [s]\n"
            "1,mujoco,landed,landed,,,\n"
            "1.000000001,simbody,contact_made,load/upper,,,\n"
            "1.5,simbody,contact_broken,load/upper,1234.5,333333.3333333333,0.499999999\n"
            "1.5,simbody,rope_slack,rope.front_left,,,\n"
            "2,simbody,contact_open,load/upper,1,2,0.25\n");

  const std::vector<EngineEvents> read = read_events_csv(file());
  ASSERT_EQ(read.size(), 2u);
  EXPECT_EQ(read[0].engine, "mujoco");
  EXPECT_EQ(read[1].engine, "simbody");
  ASSERT_EQ(read[1].record.events.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    const Event &expected = engines[0].record.events[i], &event = read[1].record.events[i];
    EXPECT_EQ(event.time, expected.time);
    EXPECT_EQ(event.kind, expected.kind);
    EXPECT_EQ(event.subject, expected.subject);
    EXPECT_EQ(event.impulse, expected.impulse);
    EXPECT_EQ(event.peak_force, expected.peak_force);
    EXPECT_EQ(event.duration, expected.duration);
  }
  ASSERT_EQ(read[1].record.open_contacts.size(), 1u);
  EXPECT_EQ(read[1].record.open_contacts[0].duration, 0.25);
}

TEST_F(Files, BadEventFilesAreRefused) {
  const std::string first = "time [s],engine,event,subject,impulse [N s],peak_force [N],duration [s]\n";
  EXPECT_NO_THROW(read_events_csv(written(first)));
  EXPECT_THROW(read_events_csv(written("")), std::runtime_error);
  EXPECT_THROW(read_events_csv(written("time [s],event\n")), std::runtime_error);
  EXPECT_THROW(read_events_csv(written(first + "1,simbody,exploded,load,,,\n")), std::runtime_error);
  EXPECT_THROW(read_events_csv(written(first + "soon,simbody,landed,load,,,\n")), std::runtime_error);
  EXPECT_THROW(read_events_csv(written(first + "1e300,simbody,landed,load,,,\n")), std::runtime_error);
  EXPECT_THROW(read_events_csv(written(first + "1,simbody,landed,load\n")), std::runtime_error);
}

}  // namespace
}  // namespace quayside::harness
