#include "tests/benchmarks/peers/scenes.h"

#include <functional>

#include "contact_nn/dataset.h"
#include "contact_nn/random.h"

namespace quayside::peers {
namespace {

using namespace contact_nn;
using Eigen::AngleAxisd;
using Eigen::Vector3d;

const Box kCube{{1, 1, 1}};
const Box kContainer40{{6.096, 1.219, 1.2955}};
const Box kContainer20{{3.029, 1.219, 1.2955}};

constexpr double kBay = 10;  // half the edge of the space that pairs stand in [m]

Manifold manifold(const BoxPair& x) {
  static const auto exact = [] {
    ContactSettings settings;
    settings.model = Model::exact;
    return make_contact_module(settings);
  }();
  ContactCounters ignored;
  return exact->query(x.a, x.b, x.X_AB, ignored);
}

bool as_deep_as_wanted(const Manifold& m) { return m.gap <= -kLeastDepth && m.gap >= -kGreatestDepth && m.count > 0; }

// A stack at rest: offset by up to 30 mm, tilted by up to 1e-4 rad, 0.1 to 5 mm deep.
BoxPair stacked(Random& random) {
  const Box &a = kContainer40, &b = random.uniform() < 0.5 ? kContainer40 : kContainer20;
  BoxPair pair{a, b, Pose::Identity()};
  const double tilt = 1e-6 * std::pow(100, random.uniform()), depth = 1e-4 * std::pow(50, random.uniform());
  pair.X_AB.linear() = AngleAxisd(tilt, random.direction()).toRotationMatrix();
  pair.X_AB.translation() =
      Vector3d(random.uniform(-0.03, 0.03), random.uniform(-0.03, 0.03), a.half[2] + b.half[2] - depth);
  return pair;
}

// Stacked or side by side without any turn, as cases are written and simulations start.
BoxPair aligned(Random& random) {
  const Box &a = kContainer40, &b = random.uniform() < 0.5 ? kContainer40 : kContainer20;
  BoxPair pair{a, b, Pose::Identity()};
  const int axis = random.uniform() < 0.75 ? 2 : 1;
  Vector3d p = random.uniform() < 0.5 ? Vector3d(0, 0, 0) : Vector3d(random.uniform(-3, 3), 0, 0);
  p[axis] = a.half[axis] + b.half[axis] - 1e-4 * std::pow(50, random.uniform());
  pair.X_AB.translation() = p;
  return pair;
}

BoxPair containers(PoseDomain domain, const GapRange& gaps, Random& random) {
  return sample_pair(kContainer40, random.uniform() < 0.5 ? kContainer40 : kContainer20, domain, gaps, random);
}

// Cubes and containers alternate: the paper's boxes and ours.
BoxPair any_boxes(const GapRange& gaps, Random& random) {
  if (random.uniform() < 0.5) return sample_pair(kCube, kCube, PoseDomain::any, gaps, random);
  return containers(PoseDomain::any, gaps, random);
}

Pose somewhere(Random& random) {
  Pose X = Pose::Identity();
  X.linear() = random.rotation();
  for (int i = 0; i < 3; ++i) X.translation()[i] = random.uniform(-kBay, kBay);
  return X;
}

Scene scene(const std::string& name, const std::string& description, bool touching, std::size_t poses, Random& random,
            const std::function<BoxPair(Random&)>& draw, const std::function<bool(const Manifold&)>& wanted,
            const std::function<Pose(Random&)>& place = somewhere) {
  Scene scene{name, description, touching, {}};
  scene.pairs.reserve(poses);
  while (scene.pairs.size() < poses) {
    const BoxPair pair = draw(random);
    if (!wanted(manifold(pair))) continue;
    const Pose X_WA = place(random);
    scene.pairs.push_back({pair.a, pair.b, X_WA, X_WA * pair.X_AB});
  }
  return scene;
}

}  // namespace

std::vector<Scene> make_scenes(std::size_t poses, std::uint64_t seed) {
  Random random(seed);
  const GapRange touching{kGreatestDepth, 0}, apart{kGreatestDepth, kGreatestGap};
  std::vector<Scene> all;
  all.push_back(scene(
      "cubes", "two cubes of edge 2 m in any orientation, 0.01 to 10 mm deep", true, poses, random,
      [&](Random& r) { return sample_pair(kCube, kCube, PoseDomain::any, touching, r); }, as_deep_as_wanted));
  all.push_back(scene(
      "landings", "a container set down on a 40 ft container: any yaw, tilts to 3 degrees, 0.01 to 10 mm deep", true, poses,
      random, [&](Random& r) { return containers(PoseDomain::landing, touching, r); }, as_deep_as_wanted));
  all.push_back(scene(
      "stacked", "a container at rest on a 40 ft container: tilts to 1e-4 rad, 0.1 to 5 mm deep", true, poses, random,
      stacked, as_deep_as_wanted));
  all.push_back(scene(
      "aligned", "containers on and beside one another without any turn, along the world's axes, 0.1 to 5 mm deep", true, poses,
      random, aligned, as_deep_as_wanted, [](Random& r) {
        Pose X = somewhere(r);
        X.linear().setIdentity();
        return X;
      }));
  all.push_back(scene(
      "edge crossings", "cubes and containers, an edge across an edge, 0.01 to 10 mm deep", true, poses, random,
      [&](Random& r) { return any_boxes(touching, r); },
      [](const Manifold& m) { return as_deep_as_wanted(m) && m.contact_class == ContactClass::edge_edge && m.count == 1; }));
  all.push_back(scene(
      "vertex-face", "cubes and containers, one corner in a face, 0.01 to 10 mm deep", true, poses, random,
      [&](Random& r) { return any_boxes(touching, r); },
      [](const Manifold& m) { return as_deep_as_wanted(m) && m.contact_class != ContactClass::edge_edge && m.count == 1; }));
  all.push_back(scene(
      "grazing", "cubes and containers, any pose and landings, a nanometre to 0.01 mm deep", true, poses, random,
      [&](Random& r) {
        const GapRange grazing{kLeastDepth, 0};
        return r.uniform() < 0.5 ? any_boxes(grazing, r) : containers(PoseDomain::landing, grazing, r);
      },
      [](const Manifold& m) { return m.gap <= -kLeastGrazing && m.gap >= -kLeastDepth && m.count > 0; }));
  all.push_back(scene(
      "separated", "cubes and containers, 0.1 mm to 1 m apart", false, poses, random,
      [&](Random& r) {
        return r.uniform() < 0.5 ? any_boxes(apart, r) : containers(PoseDomain::landing, apart, r);
      },
      [](const Manifold& m) { return m.gap >= kLeastGap; }));
  return all;
}

}  // namespace quayside::peers
