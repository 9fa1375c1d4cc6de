// The command line: exit codes, files, messages. Physics is tested elsewhere; the case here is the shortest that has events.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <set>
#include <sstream>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/acceptance/cli/program.h"

namespace quayside::testing_cli {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// A box falls by 0.1 m: √(2·0.1/9.81) = 0.1428 s.
const std::string kFallingBox = R"(title: A box falls
duration: 0.3
bodies:
  - {name: box, size: [1, 1, 1], mass: 1000, position: [0, 0, 0.6]}
contact: {model: exact, stiffness: 1e7}
expect:
  - {event: contact_made, subject: box/ground, between: [0.14, 0.15]}
  - {signal: box.position.z, at: 0.14, below: 0.51, above: 0.49}
  - {compare: mujoco_same_law, signal: box.position, rms: 1e-3}
)";

class CommandLine : public testing::Test {
 protected:
  // Runs the falling box into `out_`.
  Outcome run_box(std::vector<std::string> more = {}, const std::string& name = "out") {
    std::vector<std::string> arguments{"run", box_, "--out", (directory_.path() / name).string()};
    if (std::find(more.begin(), more.end(), "--engine") == more.end()) more.insert(more.end(), {"--engine", "simbody"});
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  }

  TemporaryDirectory directory_;
  const std::string box_ = directory_.write("box.yaml", kFallingBox).string();
  const fs::path out_ = directory_.path() / "out";
};

// Complaints are one line, "quayside: ...", on stderr alone.
void expect_refused(const Outcome& outcome, const std::string& part) {
  EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
  EXPECT_EQ(outcome.out, "");
  EXPECT_EQ(outcome.err.rfind("quayside: ", 0), 0u) << outcome.err;
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  EXPECT_NE(outcome.err.find(part), std::string::npos) << "want " << part << "\ngot  " << outcome.err;
}

TEST_F(CommandLine, HelpTeachesWithExamples) {
  const Outcome top = run({"--help"});
  EXPECT_EQ(top.exit_code, 0);
  for (const char* command : {"run", "validate", "signals", "compare", "contact"})
    EXPECT_NE(top.out.find(std::string("\n  ") + command), std::string::npos) << command;
  for (const char* command : {"run", "report", "validate", "signals", "compare"}) {
    const Outcome help = run({command, "--help"});
    EXPECT_EQ(help.exit_code, 0);
    EXPECT_NE(help.out.find("Examples:\n  quayside " + std::string(command)), std::string::npos) << help.out;
    EXPECT_EQ(help.err, "");
  }
  for (const char* code : {"0 done", "1 an expectation failed", "2 the input was refused", "3 the simulation", "130 stopped"})
    EXPECT_NE(run({"run", "--help"}).out.find(code), std::string::npos) << code;
}

TEST_F(CommandLine, VersionNamesTheEngines) {
  const Outcome version = run({"--version"});
  EXPECT_EQ(version.exit_code, 0);
  for (const char* part : {"quayside ", "simbody 3.", "sundials ", "mujoco "})
    EXPECT_NE(version.out.find(part), std::string::npos) << version.out;
}

TEST_F(CommandLine, RunWritesItsFilesAndTellsWhatItDid) {
  const Outcome outcome = run_box({"--engine", "simbody,mujoco_same_law,mujoco"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err;
  EXPECT_EQ(outcome.err, "");  // no progress bar where there is no terminal
  for (const char* part : {"A box falls", "mujoco_same_law", "box.position", "first contact", "✓"})
    EXPECT_NE(outcome.out.find(part), std::string::npos) << part << "\n" << outcome.out;

  std::set<std::string> files;
  for (const auto& entry : fs::directory_iterator(out_)) files.insert(entry.path().filename());
  EXPECT_EQ(files, (std::set<std::string>{"trajectory_simbody.csv", "trajectory_mujoco_same_law.csv", "trajectory_mujoco.csv",
                                          "events.csv", "summary.json", "report.html"}));
  const std::string trajectory = read(out_ / "trajectory_simbody.csv");
  EXPECT_EQ(trajectory.rfind("time [s],", 0), 0u);
  EXPECT_NE(trajectory.find("box.position.z [m]"), std::string::npos);
  // 0.3 s in intervals of 0.01 s: 31 rows and the names.
  EXPECT_EQ(std::count(trajectory.begin(), trajectory.end(), '\n'), 32);

  const json summary = json::parse(read(out_ / "summary.json"));
  EXPECT_EQ(summary.at("engines").size(), 3u);
  EXPECT_EQ(summary.at("expectations").size(), 3u);
  for (const json& expectation : summary.at("expectations")) EXPECT_EQ(expectation.at("verdict"), "passed");
  EXPECT_EQ(summary.at("command").get<std::string>().rfind("quayside run " + box_, 0), 0u);
}

TEST_F(CommandLine, RunGoesToRunsByDefault) {
  const Outcome outcome = run({"run", "box.yaml", "--engine", "simbody", "--quiet"}, directory_.path());
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.out, "");
  EXPECT_TRUE(fs::exists(directory_.path() / "runs" / "box" / "summary.json"));
}

TEST_F(CommandLine, RunGivesTheSummaryAsJson) {
  const Outcome outcome = run_box({"--json"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(json::parse(outcome.out), json::parse(read(out_ / "summary.json")));
}

TEST_F(CommandLine, EnginesThatWereNotRunLeaveExpectationsUnchecked) {
  const Outcome outcome = run_box();
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("not checked: mujoco_same_law was not run"), std::string::npos) << outcome.out;
}

TEST_F(CommandLine, OptionsOverrideTheCase) {
  const Outcome outcome = run_box({"--contact", "exact", "--law", "points", "--scene", "full", "--set",
                                   "solver.relative_tolerance=1e-7", "--set", "duration=0.2", "--json"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  const json summary = json::parse(outcome.out);
  EXPECT_EQ(summary.at("contact").at("law"), "points");
  EXPECT_EQ(summary.at("solver").at("relative_tolerance"), 1e-7);
  EXPECT_EQ(summary.at("case").at("duration"), 0.2);
  EXPECT_EQ(summary.at("scene").at("left_out").size(), 0u);
}

TEST_F(CommandLine, TheSameRunGivesTheSameBytes) {
  const std::vector<std::string> engines{"--engine", "simbody,mujoco_same_law,mujoco", "--quiet"};
  EXPECT_EQ(run_box(engines, "first").exit_code, 0);
  EXPECT_EQ(run_box(engines, "second").exit_code, 0);
  for (const char* file : {"trajectory_simbody.csv", "trajectory_mujoco_same_law.csv", "trajectory_mujoco.csv", "events.csv"})
    EXPECT_EQ(read(directory_.path() / "first" / file), read(directory_.path() / "second" / file)) << file;
}

TEST_F(CommandLine, AnExpectationThatFailsIsExitCode1) {
  const Outcome outcome = run_box({"--set", "expect.0.between=[0.2, 0.3]"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.out.find("✗"), std::string::npos) << outcome.out;
  EXPECT_EQ(outcome.err, "quayside: 1 of 3 expectations do not hold\n");
  EXPECT_TRUE(fs::exists(out_ / "summary.json"));
  // Nothing else tells which one it was when the tables are not printed.
  const Outcome quiet = run_box({"--set", "expect.0.between=[0.2, 0.3]", "--quiet"});
  EXPECT_EQ(quiet.exit_code, 1);
  EXPECT_NE(quiet.err.find("box.yaml:7: expected simbody: first contact_made"), std::string::npos) << quiet.err;
}

// A wall of cotton wool, hit at 100 m/s: the box is through it before it stops.
TEST_F(CommandLine, ASimulationThatCannotBeCompletedIsExitCode3) {
  const fs::path fast = directory_.write("fast.yaml", R"(title: Too fast
duration: 1
bodies:
  - {name: box, size: [1, 1, 1], mass: 1000, position: [0, 0, 2], velocity: [0, 0, -100]}
contact: {model: exact, stiffness: 1e3}
)");
  const Outcome outcome = run({"run", fast.string(), "--engine", "simbody,mujoco", "--out", out_.string()});
  EXPECT_EQ(outcome.exit_code, 3) << outcome.err;
  EXPECT_NE(outcome.err.find("simbody stopped at 0.01"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find(out_.string()), std::string::npos) << outcome.err;
  const json summary = json::parse(read(out_ / "summary.json"));
  EXPECT_TRUE(summary.at("engines").at("simbody").at("failure").is_string());
  const std::string trajectory = read(out_ / "trajectory_simbody.csv");
  EXPECT_GE(std::count(trajectory.begin(), trajectory.end(), '\n'), 3);  // names, the start, 0.01 s
}

TEST_F(CommandLine, AnInterruptedRunIsWritten) {
  for (const int signal : {SIGINT, SIGTERM}) {
    fs::remove_all(out_);
    // In real time it would take a quarter of an hour.
    Program program({"run", box_, "--engine", "simbody", "--real-time", "--set", "duration=1000", "--out", out_.string()});
    while (program.running() && !fs::exists(out_)) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    program.signal(signal);
    const Outcome outcome = program.wait();
    EXPECT_EQ(outcome.exit_code, 128 + signal) << outcome.err;
    EXPECT_NE(outcome.err.find("is in " + out_.string()), std::string::npos) << outcome.err;
    const json summary = json::parse(read(out_ / "summary.json"));
    EXPECT_EQ(summary.at("interrupted"), true);
    EXPECT_LT(summary.at("engines").at("simbody").at("simulated_s"), 1000);
    for (const json& expectation : summary.at("expectations")) EXPECT_EQ(expectation.at("verdict"), "not checked");
    EXPECT_TRUE(fs::exists(out_ / "trajectory_simbody.csv"));
    EXPECT_TRUE(fs::exists(out_ / "events.csv"));
  }
}

TEST_F(CommandLine, MistakesOnTheCommandLineAreRefused) {
  const std::string out = out_.string();
  expect_refused(run({}), "no command, expected one of: run, validate, signals, compare");
  expect_refused(run({"rum", box_}), "unknown command 'rum', expected one of: run");
  expect_refused(run({"run"}), "see 'quayside run --help'");
  expect_refused(run({"run", box_, "--fast"}), "--fast");
  expect_refused(run({"run", box_, "--engine", "bullet", "--out", out}), "bullet not in {simbody,mujoco_same_law,mujoco}");
  expect_refused(run({"run", box_, "--engine", "simbody,simbody", "--out", out}), "named twice");
  expect_refused(run({"run", box_, "--scene", "half", "--out", out}), "half not in {reduced,full}");
  expect_refused(run({"run", box_, "--contact", "spheres"}), "contact.model: found 'spheres', expected one of");
  expect_refused(run({"run", box_, "--law", "none"}), "contact.law: found 'none', expected one of");
  expect_refused(run({"run", box_, "--set", "duration"}), "override 'duration'");
  expect_refused(run({"run", box_, "--set", "duration=soon"}), "duration: found 'soon', expected a number");
  expect_refused(run({"validate", box_, "--jobs", "none"}), "--jobs");
  EXPECT_FALSE(fs::exists(out_)) << "refused, and yet something was made";
}

TEST_F(CommandLine, FilesThatAreNoCasesAreRefused) {
  for (const char* command : {"run", "signals"}) {
    expect_refused(run({command, "nowhere.yaml"}), "nowhere.yaml: no such file, expected a case file");
    // A name that is nearly right, with a wrong ending or none, beside it or in the folder `cases`.
    expect_refused(run({command, directory_.path().string() + "/bx.yml"}), "did you mean '" + box_ + "'?");
    expect_refused(run({command, "land_on_stak"}), "did you mean 'cases/land_on_stack.yaml'?");
    expect_refused(run({command, directory_.path().string()}), "a directory");
    expect_refused(run({command, ""}), "expected a case file");
    expect_refused(run({command, std::string(5000, 'x')}), "expected a case file");
    const fs::path large = directory_.write("large.yaml", "title: t\n");
    fs::resize_file(large, 100'000'000);
    expect_refused(run({command, large.string()}), "too large");
  }
}

// The first line of each says what the message must hold.
TEST_F(CommandLine, EveryBadCaseIsRefusedWithItsMessage) {
  int count = 0;
  for (const auto& entry : fs::directory_iterator("tests/unit/cases/bad")) {
    std::string first_line;
    std::ifstream stream(entry.path());
    std::getline(stream, first_line);
    const std::string mark = "# expect: ";
    ASSERT_EQ(first_line.rfind(mark, 0), 0u) << entry.path();
    expect_refused(run({"run", entry.path().string(), "--out", out_.string()}), first_line.substr(mark.size()));
    ++count;
  }
  EXPECT_GE(count, 30);
  EXPECT_FALSE(fs::exists(out_));
}

TEST_F(CommandLine, ExpectationsOfUnknownSignalsAreRefusedBeforeTheRun) {
  expect_refused(run_box({"--set", "expect.1.signal=box.positon.z"}), "expect.1.signal: found 'box.positon.z'");
  EXPECT_FALSE(fs::exists(out_));
}

TEST_F(CommandLine, DirectoriesThatCannotBeWrittenAreRefusedBeforeTheRun) {
  expect_refused(run_box({}, "box.yaml"), "box.yaml: cannot be made");        // a file
  expect_refused(run_box({}, "box.yaml/below"), "below: cannot be made");     // below a file
  expect_refused(run({"run", box_, "--out", "/proc/quayside"}), "/proc/quayside: cannot be made");  // not even for root
}

TEST_F(CommandLine, ResultsOfAnEarlierRunDoNotStay) {
  EXPECT_EQ(run_box({"--engine", "simbody,mujoco"}).exit_code, 0);
  EXPECT_TRUE(fs::exists(out_ / "trajectory_mujoco.csv"));
  EXPECT_EQ(run_box().exit_code, 0);
  EXPECT_FALSE(fs::exists(out_ / "trajectory_mujoco.csv"));
}

TEST_F(CommandLine, SignalsHaveUnitAndMeaning) {
  const Outcome outcome = run({"signals", box_});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  for (const char* part : {"box.position.z", "box.orientation.w", "contact.", "energy.residual", "rad/s", "kinetic energy"})
    EXPECT_NE(outcome.out.find(part), std::string::npos) << part << "\n" << outcome.out;

  // What is listed is what is recorded, in the same order.
  const json listed = json::parse(run({"signals", box_, "--json"}).out);
  EXPECT_EQ(run_box().exit_code, 0);
  std::string names = read(out_ / "trajectory_simbody.csv");
  names.resize(names.find('\n'));
  std::string expected = "time [s]";
  for (const json& output : listed.at("outputs")) {
    const std::string unit = output.at("unit");
    expected += "," + output.at("name").get<std::string>() + (unit.empty() ? "" : " [" + unit + "]");
  }
  EXPECT_EQ(names, expected);
}

TEST_F(CommandLine, CompareTellsHowFarRunsAreApart) {
  ASSERT_EQ(run_box({}, "a").exit_code, 0);
  ASSERT_EQ(run_box({"--set", "bodies.box.position=[0.25, 0, 0.6]"}, "b").exit_code, 0);
  const std::string a = (directory_.path() / "a").string(), b = (directory_.path() / "b").string();

  const Outcome same = run({"compare", a, a, "--json"});
  ASSERT_EQ(same.exit_code, 0) << same.err;
  const json nothing = json::parse(same.out).at("simbody");
  // The product of a quaternion with its conjugate rounds; all else is exactly the same.
  for (const auto& [name, signal] : nothing.at("signals").items()) EXPECT_LT(signal.at("max"), 1e-15) << name;
  EXPECT_EQ(nothing.at("events").at("only_first").size(), 0u);
  EXPECT_GE(nothing.at("events").at("matched").size(), 1u);

  const json apart = json::parse(run({"compare", a, b, "--json", "--signal", "box.position"}).out).at("simbody");
  EXPECT_EQ(apart.at("signals").size(), 1u);
  EXPECT_NEAR(apart.at("signals").at("box.position").at("rms"), 0.25, 1e-6);  // moved along the flat ground

  const Outcome told = run({"compare", a, b});
  EXPECT_EQ(told.exit_code, 0) << told.err;
  EXPECT_NE(told.out.find("box.position"), std::string::npos) << told.out;
  EXPECT_NE(told.out.find("contact_made"), std::string::npos) << told.out;
}

// Free fall from 0.6 m, "measured" 2 mm too high at times of its own: z = 0.6 − 4.905 t². Rows every 0.01 s interpolate it
// to ⅛·9.81·0.01² = 1.2e-4 m.
TEST_F(CommandLine, CompareTakesMeasuredData) {
  ASSERT_EQ(run_box().exit_code, 0);
  std::ostringstream measured;
  measured << "time [s],box.position.z [m]\n";
  for (const double t : {0.013, 0.047, 0.081, 0.115}) measured << t << "," << 0.602 - 4.905 * t * t << "\n";
  const std::string csv = directory_.write("measured.csv", measured.str()).string();
  for (const auto& arguments : {std::vector<std::string>{"compare", out_.string(), csv, "--json"},
                                std::vector<std::string>{"compare", csv, out_.string(), "--json"}}) {
    const Outcome outcome = run(arguments);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const json comparison = json::parse(outcome.out).at("simbody");
    EXPECT_EQ(comparison.at("samples"), 4);
    EXPECT_EQ(comparison.at("signals").size(), 1u);
    EXPECT_NEAR(comparison.at("signals").at("box.position.z").at("rms"), 0.002, 1.3e-4);
  }
}

TEST_F(CommandLine, CompareRefusesWhatCannotBeCompared) {
  ASSERT_EQ(run_box().exit_code, 0);
  const std::string out = out_.string();
  expect_refused(run({"compare", out}), "see 'quayside compare --help'");
  expect_refused(run({"compare", out, (directory_.path() / "nowhere").string()}), "does not exist");
  expect_refused(run({"compare", out, directory_.path().string()}), "holds no trajectory_<engine>.csv");
  expect_refused(run({"compare", out, box_}), "time [s]");
  expect_refused(run({"compare", out, directory_.write("other.csv", "time [s],other [m]\n0,1\n").string()}), "no signal in common");
  expect_refused(run({"compare", out, directory_.write("late.csv", "time [s],box.position.z [m]\n9,1\n").string()}),
                 "no time in common");
  expect_refused(run({"compare", out, out, "--engine", "mujoco"}), "nothing to compare");
  expect_refused(run({"compare", out, out, "--signal", "box.positon"}), "box.position");
}

// What a report's page is made of.
json page_data(const fs::path& report) {
  const std::string html = read(report), begin = "<script type=\"application/json\" id=\"data\">";
  const std::size_t from = html.find(begin) + begin.size();
  return json::parse(html.substr(from, html.find("</script>", from) - from));
}

TEST_F(CommandLine, ReportIsMadeAgainFromTheDirectory) {
  ASSERT_EQ(run_box({"--engine", "simbody,mujoco", "--set", "duration=0.2", "--set", "expect=[]"}).exit_code, 0);
  const json first = page_data(out_ / "report.html");
  fs::remove(out_ / "report.html");
  const Outcome outcome = run({"report", out_.string()});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.out, (out_ / "report.html").string() + "\n");
  const json again = page_data(out_ / "report.html");
  for (const char* part : {"summary", "scene", "events"}) EXPECT_EQ(again.at(part), first.at(part)) << part;
  // Curves come one after another; the last two of each engine, wall time and mean step, stand in no file.
  for (const char* engine : {"simbody", "mujoco"}) {
    const json &now = again.at("curves").at("engines").at(engine), &then = first.at("curves").at("engines").at(engine);
    const std::size_t count = now.at("names").size();
    ASSERT_EQ(then.at("names").size(), count + 2);
    EXPECT_EQ(then.at("names").at(count), "solver.wall_time");
    EXPECT_EQ(then.at("names").at(count + 1), "solver.mean_step");
    for (std::size_t i = 0; i < count; ++i)
      for (const char* part : {"names", "units", "counts"}) EXPECT_EQ(now.at(part).at(i), then.at(part).at(i));
    std::string data = now.at("data");
    data.resize(data.size() - 4);  // the last group of base64 also holds what follows
    EXPECT_EQ(then.at("data").get<std::string>().compare(0, data.size(), data), 0);
  }
}

TEST_F(CommandLine, ReportRefusesWhatIsNoRun) {
  expect_refused(run({"report", (directory_.path() / "nowhere").string()}), "does not exist");
  expect_refused(run({"report", box_}), "is a file");
  expect_refused(run({"report", directory_.path().string()}), "holds no summary.json");
  ASSERT_EQ(run_box().exit_code, 0);
  const std::string summary = read(out_ / "summary.json");
  const auto with = [&](const std::string& text) { std::ofstream(out_ / "summary.json") << text; };
  with(summary.substr(0, summary.size() / 2));
  expect_refused(run({"report", out_.string()}), "is not the summary of a run");
  json old = json::parse(summary);
  old.at("case").erase("text");
  with(old.dump());
  expect_refused(run({"report", out_.string()}), "please run the case again");
  with(summary);
  std::ofstream(out_ / "trajectory_simbody.csv") << "time [s],box.position.x [m]\n0,0\n";
  expect_refused(run({"report", out_.string()}), "lacks 'box.position.y'");
  fs::remove(out_ / "trajectory_simbody.csv");
  expect_refused(run({"report", out_.string()}), "trajectory_");
}

TEST_F(CommandLine, ValidateGivesALinePerCaseAndTheWorstExitCode) {
  const fs::path cases = directory_.path() / "cases";
  fs::create_directory(cases);
  const auto write = [&](const char* name, const std::string& text) { std::ofstream(cases / name) << text; };
  write("a_good.yaml", kFallingBox);
  Outcome outcome = run({"validate", cases.string()});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err;
  EXPECT_EQ(outcome.out.rfind("✓ a_good: 3 of 3 expectations hold", 0), 0u) << outcome.out;
  EXPECT_EQ(outcome.err, "");

  std::string wrong = kFallingBox;
  wrong.replace(wrong.find("[0.14, 0.15]"), 12, "[0.20, 0.25]");
  write("b_wrong.yaml", wrong);
  outcome = run({"validate", cases.string(), "--out", out_.string()});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.out.find("✗ b_wrong: 2 of 3 expectations hold"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("first contact_made of box/ground from 0.2 to 0.25 s"), std::string::npos) << outcome.out;
  EXPECT_LT(outcome.out.find("a_good"), outcome.out.find("b_wrong")) << "not in the order of the cases";
  EXPECT_TRUE(fs::exists(out_ / "a_good" / "summary.json"));

  write("c_refused.yaml", "title: no\n");
  outcome = run({"validate", cases.string(), "--engine", "simbody"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.out.find("✗ c_refused: refused: "), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.err.find("quayside: 1 of 3 cases refused"), std::string::npos) << outcome.err;

  const json summaries = json::parse(run({"validate", cases.string(), "--engine", "simbody", "--json", "--jobs", "1"}).out);
  ASSERT_EQ(summaries.size(), 3u);
  EXPECT_EQ(summaries.at(0).at("case").at("name"), "a_good");
  EXPECT_TRUE(summaries.at(2).contains("refused"));
}

TEST_F(CommandLine, ValidateStopsAllItsProcesses) {
  // 150,000 communication points: it is at work for seconds when the signal comes, right after its directory is there.
  Program program({"validate", box_, "--engine", "mujoco_same_law", "--set", "duration=1500", "--out", out_.string()});
  while (program.running() && !fs::exists(out_ / "box")) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  program.signal(SIGTERM);  // to the first process alone
  const Outcome outcome = program.wait();
  EXPECT_EQ(outcome.exit_code, 128 + SIGTERM) << outcome.err;
  EXPECT_NE(outcome.out.find("interrupted"), std::string::npos) << outcome.out;
  EXPECT_EQ(json::parse(read(out_ / "box" / "summary.json")).at("interrupted"), true);
}

TEST_F(CommandLine, ValidateRefusesDirectoriesWithoutCases) {
  const fs::path empty = directory_.path() / "empty";
  fs::create_directory(empty);
  expect_refused(run({"validate", empty.string()}), "holds no case");
  fs::create_directory(directory_.path() / "other");
  fs::copy(box_, directory_.path() / "other" / "box.yaml");
  expect_refused(run({"validate", box_, (directory_.path() / "other").string(), "--out", out_.string()}), "another case is called box");
}

// 0.3 s are 18 frames of 1/60 s: asked for 20, the case runs twice.
TEST_F(CommandLine, FramesAreCountedInWholeRuns) {
  const fs::path table = directory_.path() / "frames.csv";
  const Outcome outcome = run({"frames", box_, "--least", "20", "--table", table.string()});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  std::istringstream csv(read(table));
  std::string line;
  std::getline(csv, line);
  EXPECT_EQ(line, "case,frames,median [s],p99 [s],p99.9 [s],max [s],over 0.000833 s,slowest at [s],its steps");
  for (const char* name : {"box", "all"}) {
    std::getline(csv, line);
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream cells(line);
    std::string first;
    std::size_t frames = 0, steps = 0;
    double median = 0, p99 = 0, p999 = 0, max = 0, over = 0, at = 0;
    cells >> first >> frames >> median >> p99 >> p999 >> max >> over >> at >> steps;
    EXPECT_TRUE(cells) << line;
    EXPECT_EQ(first, name);
    EXPECT_EQ(frames, 36u);
    EXPECT_GT(median, 0);
    EXPECT_TRUE(median <= p99 && p99 <= p999 && p999 <= max) << line;
    EXPECT_EQ(over > 0, max > 1.0 / 1200) << line;
    EXPECT_TRUE(at >= 0 && at < 0.3 && steps > 0) << line;
  }
}

TEST_F(CommandLine, ColoursAreForTerminalsThatWantThem) {
  EXPECT_NE(run_on_terminal({"signals", box_}, "LANG", "C").find("\033["), std::string::npos);
  EXPECT_EQ(run_on_terminal({"signals", box_}, "NO_COLOR", "1").find("\033["), std::string::npos);
  EXPECT_EQ(run_on_terminal({"signals", box_}, "TERM", "dumb").find("\033["), std::string::npos);
  EXPECT_EQ(run({"signals", box_}).out.find("\033["), std::string::npos);
}

}  // namespace
}  // namespace quayside::testing_cli
