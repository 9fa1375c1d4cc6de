// Families of poses, each a situation that a collision detector meets.
#pragma once

#include <string>
#include <vector>

#include "tests/benchmarks/peers/contender.h"

namespace quayside::peers {

struct Scene {
  std::string name, description;
  bool touching;
  std::vector<Placed> pairs;
};

// The depths and gaps that are drawn [m]. Depths from a hundredth of a millimetre, where single precision ends, to a hundredth of
// a metre, which a container reaches in a hard landing: deeper, "the" impact point means less and less. Shallower ones have a
// scene of their own.
inline constexpr double kLeastDepth = 1e-5;
inline constexpr double kGreatestDepth = 1e-2;
inline constexpr double kLeastGrazing = 1e-9;
inline constexpr double kLeastGap = 1e-4;
inline constexpr double kGreatestGap = 1;

// Boxes are the paper's cubes of edge 2 and ISO containers. Every pair stands somewhere in a bay of 20 m, turned at random.
// The same seed gives the same poses on every machine.
std::vector<Scene> make_scenes(std::size_t poses, std::uint64_t seed);

}  // namespace quayside::peers
