// A case: what to simulate, as it stands in a case file. Plain data, checked when it is loaded; no physics.
//
// SI units; angles in degrees where a person writes them (skew, rpy) and converted by whoever builds the scene. A
// position of a container is the centre of its bottom face, that of a plain body the centre of its box.
#pragma once

#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Geometry>

namespace quayside::cases {

// A case file was refused. The message reads "file:line: key.path: what is wrong, and what was expected".
class CaseError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

enum class ContainerType { iso20, iso40, iso40_high_cube, iso45 };  // "20ft", "40ft", "40ft_hc", "45ft"

// What is not given comes from the machine. Of angles all in degrees instead of m.
struct DriveSpec {
  std::optional<double> position;          // at the start [m]
  std::optional<double> max_speed;         // [m/s]
  std::optional<double> max_acceleration;  // [m/s²]
  std::optional<double> max_jerk;          // [m/s³]; 0: the acceleration may jump
  std::optional<double> emergency_stop;    // its deceleration [m/s²]
  std::optional<Eigen::Vector2d> range;    // of its value, between limit switches [m]
};

struct CraneSpec {
  std::string type = "none";               // "quayside", "rtg", "reach_stacker" or "none"
  // quayside, rtg
  double trolley_position = 0;             // along the boom, y of the world [m]
  double trolley_height = 0;               // of the upper sheaves above the ground [m]
  double rope_length = 0;                  // rest length of the hoist ropes at the start [m]
  DriveSpec gantry, trolley, hoist;        // no gantry position: the crane does not travel
  DriveSpec trim, list, skew;              // differences of rope length; no position: the crane has no such drive
  // reach_stacker
  DriveSpec travel, boom, telescope, rotation, side_shift;
  std::optional<double> pivot_damping;     // of each pivot [N m s/rad]
  // What trips the machine; not given: nothing does.
  std::optional<double> overload;          // load under the ropes, spreader and all [kg]
  std::optional<double> snag;              // tension of any one rope group [N]
  std::optional<Eigen::Vector2d> trolley_sheaves;   // rectangle along x and y [m]
  std::optional<Eigen::Vector2d> spreader_sheaves;  // [m]
  std::optional<double> rope_stiffness;             // EA of one group [N]
  std::optional<double> rope_damping_time;          // [s]
};

struct SpreaderSpec {
  ContainerType size = ContainerType::iso40;
  bool twin = false;                        // two 20 ft containers; `size` is then iso40
  bool flippers = false;                    // guides at its corners, down
  std::vector<std::string> picks_up;        // containers that its open twistlocks can close on
  double skew = 0;                          // about the vertical [degrees]
  std::optional<double> mass;               // spreader and headblock together [kg]
  std::optional<double> lock_stiffness;     // per twistlock [N/m]
};

// A tractor with its trailer.
struct MafiSpec {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  // of the middle of the deck [m]
  double heading = 0;                                  // of its path against the world's x [degrees]
  DriveSpec drive;
  ContainerType size = ContainerType::iso40;           // for which the corner guides stand
  std::optional<double> deck_height;                   // [m]
  std::optional<double> deck_mass;                     // [kg]
  std::optional<double> stiffness, damping_ratio;      // of the suspension: one of four springs [N/m], and -
  bool guides = true;
  bool twistlocks = false;                             // hold what stands on it
  std::vector<std::string> stuck;                      // "front_left", ...: twistlocks that do not open
};

// Wind over everything that can move; the script sets its speed.
struct WindSpec {
  double direction = 0;  // where to, against the world's x towards y [degrees]
  double drag = 1.2;     // coefficient of a box
};

struct ContainerSpec {
  std::string name;
  ContainerType type = ContainerType::iso40;
  double mass = 0;                                   // gross [kg]
  bool on_spreader = false;                          // "on: spreader"
  bool on_mafi = false;                              // "on: mafi"
  std::optional<std::string> on_top_of;              // name of another container, offset by `offset`
  Eigen::Vector2d offset = Eigen::Vector2d::Zero();  // of the position on the lower one, along its edges [m]
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  double yaw = 0;                                    // against the world, or the container it stands on [degrees]
  Eigen::Vector3d centre_of_gravity = Eigen::Vector3d::Zero();  // from the box's centre [m]
  bool fixed = false;                                // part of the ground
};

// Containers of one kind in a block: bays along x, rows along y, so many tiers high, called NAME_bay_row_tier from 1 on.
struct StackSpec {
  std::string name;
  ContainerType type = ContainerType::iso40;
  double mass = 0;                                         // of each [kg]
  Eigen::Vector3d position = Eigen::Vector3d::Zero();      // of the bottom of the first
  int bays = 1, rows = 1, tiers = 1;
  Eigen::Vector2d spacing = Eigen::Vector2d::Zero();       // from bay to bay, from row to row [m]
};

struct BodySpec {
  std::string name;
  Eigen::Vector3d size = Eigen::Vector3d::Ones();    // full edges [m]
  double mass = 0;                                   // [kg]; uniform density; 0 if fixed without one
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();  // R_WB
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();       // in the world frame [rad/s]
  bool fixed = false;
};

struct ContactSpec {  // see contact_nn::ContactSettings
  std::string model = "committee";
  std::string law = "potential";
  double stiffness = 6e8;
  double restitution = 0.3;
  double reference_speed = 0.5;
  double friction = 0.4;
  std::string friction_law = "regularised";
  double transition_speed = 1e-3;
  std::string network;
};

struct SolverSpec {
  double relative_tolerance = 1e-6;
  double max_step = 0;     // [s]; 0: no bound
  double mujoco_step = 0;  // [s]; 0: chosen by the engine
  std::string integrator = "bdf";  // of Simbody
  std::string mujoco_integrator = "rk4";
  std::string free_bodies = "tree";  // in Simbody
};

// A line of the script. It fires once, `after` seconds from the moment its condition first holds, and gives commands.
struct ScriptEntry {
  enum class Condition { at, landed, contact, locked, signal_above, signal_below };
  Condition condition = Condition::at;
  double time = 0;         // at [s]
  std::string signal;      // signal_above, signal_below
  double threshold = 0;
  double after = 0;        // [s]
  std::vector<std::pair<std::string, double>> speeds;   // drive and speed [m/s; of angles degrees/s]
  std::vector<std::pair<std::string, double>> ramps;    // drive and time within which it gets there [s]
  bool emergency_stop = false;                          // of all drives, for good
  std::vector<std::pair<std::string, bool>> commands;   // "twistlocks": closed?
};

// How units are stepped together: see harness/masters/method.h.
struct MasterSpec {
  std::string method = "gauss_seidel";
  double tolerance = 1e-6;  // relative, of connected values
  double relaxation = 1;
};

// A foreign FMU that runs along.
struct UnitSpec {
  std::string name;
  std::filesystem::path fmu;  // as written; relative to the case file's folder
  std::vector<std::pair<std::string, double>> parameters;  // booleans: 0 or 1
  double timeout = 60;         // of every call [s]
  std::filesystem::path file;  // where `fmu` is
};

// From an output to an input. "UNIT.VARIABLE" for a unit's variable; else a signal of the scene, or command.<drive> and
// command.<command>, which take that drive or command away from the script.
struct ConnectionSpec {
  std::string from, to;
};

// What a run must show. Vector signals ("load.position") are compared as vectors.
struct Expectation {
  enum class Kind { value, comparison, event };
  enum class Moment { end, time, minimum, maximum };
  Kind kind = Kind::value;
  std::string signal;
  // value: |signal at moment − value| ≤ tolerance, or signal at moment below / above a bound
  Moment moment = Moment::end;
  double time = 0;
  std::optional<double> value, tolerance, below, above;
  std::string engine = "simbody";
  // comparison: distance of `signal` between simbody and another engine over the run
  std::string compare;
  std::optional<double> rms, max;
  // event: the first event of this kind (and subject) lies within a time window
  std::string event, subject;
  double earliest = 0, latest = 0;
  std::string why;  // the reason, printed with the result
  int line = 0;
};

struct Case {
  std::filesystem::path file;
  std::string text;   // as of `case_text`: with all overrides in it
  std::string name;   // stem of the file
  std::string title;
  double duration = 0;  // [s]
  CraneSpec crane;
  std::optional<SpreaderSpec> spreader;
  std::optional<MafiSpec> mafi;
  std::optional<WindSpec> wind;
  std::vector<ContainerSpec> containers;
  std::vector<StackSpec> stacks;
  std::vector<BodySpec> bodies;
  bool ground = true;   // a flat ground at z = 0
  Eigen::Vector3d gravity{0, 0, -9.81};
  ContactSpec contact;
  SolverSpec solver;
  bool allow_overlap = false;
  double output_interval = 0.01;  // [s]
  std::vector<UnitSpec> units;
  std::vector<ConnectionSpec> connections;
  MasterSpec master;
  bool sampled_contact = false;   // "coupling: sampled": contact forces at communication points only
  std::vector<ScriptEntry> script;
  std::vector<Expectation> expectations;
};

// Overrides are "key.path=value" as on the command line, applied before checking. Throws CaseError.
Case load_case(const std::filesystem::path& file, const std::vector<std::string>& overrides = {});

// From the text of a case, as if it stood in `file`. Throws CaseError.
Case parse_case(const std::string& text, const std::filesystem::path& file);

// The text of a case file that loads as this one does with these overrides. Throws CaseError.
std::string case_text(const std::filesystem::path& file, const std::vector<std::string>& overrides = {});

// The JSON Schema of the format (draft 2020-12), as text.
const char* case_schema();

}  // namespace quayside::cases
