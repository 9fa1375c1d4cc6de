// What a case may ask for. The bounds are wide: they keep out slips of unit and of exponent, and what the arithmetic or
// the memory cannot carry, not unusual machines. The schema states the same bounds; a test compares them.
#pragma once

#include <cstddef>

namespace quayside::cases::limits {

// Both ends belong to the range.
struct Range {
  double low, high;
  const char* unit;  // empty: a plain number
};

// Time
constexpr Range kDuration{1e-3, 3600, "s"};           // a handling cycle takes minutes
constexpr Range kOutputInterval{1e-5, 10, "s"};       // down to a tenth of the shortest contact oscillation
constexpr Range kTime{0, 3600, "s"};                  // of script and expectations; the duration bounds it further
constexpr Range kTimeout{1e-3, 3600, "s"};            // of a call of an FMU
constexpr double kMaxRows = 200'000;                  // every trajectory is kept in memory: about 200 MB at 100 signals
constexpr Range kSolverStep{0, 1, "s"};               // 0: no bound, or chosen by the engine
constexpr Range kRelativeTolerance{1e-12, 1e-2, ""};  // below, rounding in double precision; above, no digits are left

// Masters
constexpr Range kMasterTolerance{1e-12, 0.1, ""};  // below, rounding; above, no digit is left
constexpr Range kRelaxation{0.01, 1, ""};          // less would need more rounds than there are

// Places and sizes
constexpr Range kPosition{-1000, 1000, "m"};  // a terminal; rounding stays below 1e-12 m, far from contact depths
constexpr Range kBodyEdge{1e-3, 100, "m"};    // contact depths are parts of a millimetre; ships are not bodies
constexpr Range kAngle{-360, 360, "degrees"};
constexpr Range kSkew{-30, 30, "degrees"};         // beyond, ropes of a spreader cross
constexpr Range kTrolleyPosition{-200, 200, "m"};  // the longest booms reach about 75 m
constexpr Range kTrolleyHeight{1, 100, "m"};       // the highest cranes lift to about 55 m above the rail
constexpr Range kRopeLength{0.5, 100, "m"};
constexpr Range kRopeDifference{-1, 1, "m"};  // trim, list and skew: beyond, ropes of the shorter side alone carry
constexpr Range kBoomAngle{-10, 80, "degrees"};
constexpr Range kTelescope{0, 15, "m"};
constexpr Range kSideShift{-2, 2, "m"};
constexpr Range kDeckHeight{0.3, 3, "m"};
constexpr Range kSheaves{0, 20, "m"};   // no trolley is longer; 0: all ropes from one line or point
constexpr Range kOffset{-15, 15, "m"};  // farther off than the longest box it would not stand on the lower one
constexpr Range kCentreOfGravity{-6.9, 6.9, "m"};  // half the longest box; the builder knows the box
constexpr double kQuaternionNormError = 1e-3;      // rounding of components written with three digits

// Masses and motion
constexpr Range kContainerMass{100, 100'000, "kg"};  // the heaviest lifts of ship-to-shore spreaders are about 80 t
constexpr Range kSpreaderMass{100, 100'000, "kg"};
constexpr Range kBodyMass{1e-3, 1e6, "kg"};   // lighter bodies would ring too fast on the usual contact stiffness
constexpr Range kVelocity{-100, 100, "m/s"};  // faster, boxes pass through one another within a step
constexpr Range kAngularVelocity{-100, 100, "rad/s"};
constexpr Range kGravity{-100, 100, "m/s²"};
constexpr Range kDriveSpeed{-10, 10, "m/s"};  // of a command; the fastest drives make 6 m/s
constexpr Range kTurningSpeed{-30, 30, "degrees/s"};  // booms make 3, rotators 10
constexpr Range kWindSpeed{0, 75, "m/s"};     // a category five hurricane
constexpr Range kRampTime{1e-3, 600, "s"};
constexpr Range kMaxTurningSpeed{1e-2, 30, "degrees/s"};
constexpr Range kMaxTurningAcceleration{1e-2, 60, "degrees/s²"};
constexpr Range kMaxTurningJerk{0, 1000, "degrees/s³"};  // 0: no limit
constexpr Range kMaxJerk{0, 100, "m/s³"};                // 0: no limit
constexpr Range kMaxSpeed{1e-3, 10, "m/s"};
constexpr Range kMaxAcceleration{1e-3, 20, "m/s²"};  // twice gravity: hoists have less than 1 m/s²

// Stiffness and contact
constexpr Range kRopeStiffness{1e3, 1e11, "N"};  // EA of one group; wire ropes have about 1e8
constexpr Range kDampingTime{0, 10, "s"};
constexpr Range kPivotDamping{0, 1e9, "N m s/rad"};
constexpr Range kDampingRatio{0, 2, ""};
constexpr Range kOverload{1000, 500'000, "kg"};
constexpr Range kSnag{1e3, 1e7, "N"};
constexpr Range kDrag{0, 3, ""};
constexpr Range kStiffness{1e3, 1e12, "N/m"};  // contacts, twistlocks; above, no step of an integrator is short enough
constexpr Range kRestitution{0.01, 1, ""};  // towards 0 the damping that it stands for has no bound
constexpr Range kReferenceSpeed{1e-3, 100, "m/s"};
constexpr Range kFriction{0, 10, ""};
constexpr Range kTransitionSpeed{1e-6, 1, "m/s"};  // explicit steps shrink with it; above, resting boxes visibly creep

// Expectations and conditions: any signal in its unit. Energies stay below 1e12 J with all masses and speeds above.
constexpr Range kSignal{-1e12, 1e12, "in the signal's unit"};
constexpr Range kTolerance{0, 1e12, "in the signal's unit"};

// Amounts
constexpr std::size_t kMaxFileBytes = 1'000'000;  // the largest legal case needs a tenth of it
constexpr std::size_t kMaxNodes = 50'000;         // values in one file
constexpr std::size_t kMaxDepth = 16;             // the format itself needs 5
constexpr std::size_t kMaxBodies = 200;           // containers, and as many bodies; pairs grow with the square
constexpr Range kBaysAndRows{1, 1000, ""};        // whole numbers
constexpr Range kTiers{1, 20, ""};
constexpr Range kSpacing{0, 100, "m"};            // not closer than the boxes are large
constexpr std::size_t kMaxStacks = 20;            // blocks of them
constexpr double kMaxStacked = 100'000;           // containers in one block
constexpr std::size_t kMaxUnits = 100;           // foreign FMUs, each a library of its own in memory
constexpr std::size_t kMaxEntries = 1000;         // of script and expectations
constexpr std::size_t kMaxText = 1000;            // characters of a title or a reason
constexpr std::size_t kMaxName = 40;              // characters; names become parts of signal names

}  // namespace quayside::cases::limits
