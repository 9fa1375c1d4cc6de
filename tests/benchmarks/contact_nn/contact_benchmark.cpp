// Time of one contact evaluation between two 40 ft boxes, by law, pose and motion.
//
//   flat:    stacked, offset by 30/20 mm, tilted by 1e-5 rad, 1 mm deep
//   aligned: stacked exactly, 1 mm deep
//   corner:  a corner in a face, 2 mm deep
//   near:    apart, with overlapping bounding spheres
//   far:     apart
#include <benchmark/benchmark.h>

#include "contact_nn/batch.h"
#include "contact_nn/contact.h"
#include "contact_nn/dataset.h"
#include "contact_nn/manifold.h"
#include "contact_nn/pieces.h"
#include "contact_nn/separating_axes.h"
#include "tests/unit/contact_nn/poses.h"

namespace quayside::contact_nn {
namespace {

using namespace test;
using Eigen::Vector3d;

Pose flat() { return pose({0.03, 0.02, 2.591 - 1e-3}, rotation(1e-5, Vector3d(1, 2, 3))); }
Pose aligned() { return pose({0, 0, 2.591 - 1e-3}); }
Pose corner() {
  const Eigen::Matrix3d R = rotation(0.3, Vector3d::UnitZ()) * rotation(0.1, Vector3d::UnitX()) * rotation(0.2, Vector3d::UnitY());
  return at_depth(kContainer, kContainer, pose({1, 0.5, 0}, R), Vector3d::UnitZ(), 2e-3);
}
Pose near_miss() { return pose({7, 3.9, 2.9}, rotation(0.3, Vector3d(1, 1, 1))); }
Pose far_away() { return pose({0, 0, 9}, rotation(0.3, Vector3d(1, 1, 1))); }

// A slightly different pose each time, so that nothing is taken out of the loop.
Pose varied(Pose X_AB, int i) {
  X_AB.translation().z() += 1e-9 * (i & 7);
  return X_AB;
}

void force(benchmark::State& state, Law law, bool elastic, Pose (*pose_of)()) {
  ContactSettings settings;
  settings.model = Model::exact;
  settings.law = law;
  if (elastic) settings.restitution = 1, settings.friction = 0;
  const auto module = make_contact_module(settings);
  ContactCounters counters;
  RelativeVelocity V;
  V.v_A = {0.01, 0.02, -0.1};
  V.w_A = {0.01, 0.02, 0.03};
  const Pose X_AB = pose_of();
  int i = 0;
  for (auto _ : state)
    benchmark::DoNotOptimize(module->force(kContainer, kContainer, varied(X_AB, ++i), V, counters));
}

void query(benchmark::State& state, Model model, Pose (*pose_of)()) {
  ContactSettings settings;
  settings.model = model;
  const auto module = make_contact_module(settings);
  ContactCounters counters;
  const Pose X_AB = pose_of();
  int i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(module->query(kContainer, kContainer, varied(X_AB, ++i), counters));
}

void separation_of(benchmark::State& state, Pose (*pose_of)()) {
  const Pose X_AB = pose_of();
  int i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(separation(kContainer, kContainer, varied(X_AB, ++i)));
}

void possible_pieces_of(benchmark::State& state, Pose (*pose_of)()) {
  const Pose X_AB = pose_of();
  int i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(possible_pieces(kContainer, kContainer, varied(X_AB, ++i)));
}

// 64 pairs, time of all of them: all in contact, or all from 0.1 mm to 1 m apart.
std::vector<BoxPair> yard(bool touching) {
  std::vector<BoxPair> pairs;
  for (const BoxPair& pair : sample_pairs(1000, {PoseDomain::landing, PoseDomain::any},
                                          touching ? GapRange{0.01, 0} : GapRange{0.01, 1}, 1)) {
    const double gap = separation(pair.a, pair.b, pair.X_AB);
    if ((touching ? gap < 0 : gap > 1e-4) && pairs.size() < 64) pairs.push_back(pair);
  }
  return pairs;
}

void queries_one_by_one(benchmark::State& state, bool touching) {
  const auto pairs = yard(touching);
  std::vector<Manifold> answers(pairs.size());
  for (auto _ : state) {
    for (std::size_t i = 0; i < pairs.size(); ++i)
      answers[i] = contact_manifold(pairs[i].a, pairs[i].b, pairs[i].X_AB, 0);
    benchmark::DoNotOptimize(answers.data());
    benchmark::ClobberMemory();
  }
}
void separations_one_by_one(benchmark::State& state, bool touching) {
  const auto pairs = yard(touching);
  std::vector<double> gaps(pairs.size());
  for (auto _ : state) {
    for (std::size_t i = 0; i < pairs.size(); ++i) gaps[i] = separation(pairs[i].a, pairs[i].b, pairs[i].X_AB);
    benchmark::DoNotOptimize(gaps.data());
    benchmark::ClobberMemory();
  }
}
void separations_in_a_batch(benchmark::State& state, bool touching) {
  const auto pairs = yard(touching);
  std::vector<GapAndAxis> answers(pairs.size());
  for (auto _ : state) {
    separations(pairs.data(), pairs.size(), answers.data());
    benchmark::DoNotOptimize(answers.data());
    benchmark::ClobberMemory();
  }
}

void find_touching_in_a_batch(benchmark::State& state, bool touching) {
  const auto pairs = yard(touching);
  std::vector<std::size_t> found(pairs.size());
  for (auto _ : state) benchmark::DoNotOptimize(find_touching(pairs.data(), pairs.size(), 0, found.data()));
}

BENCHMARK_CAPTURE(queries_one_by_one, touching, true);
BENCHMARK_CAPTURE(queries_one_by_one, apart, false);
BENCHMARK_CAPTURE(separations_one_by_one, touching, true);
BENCHMARK_CAPTURE(separations_in_a_batch, touching, true);
BENCHMARK_CAPTURE(separations_one_by_one, apart, false);
BENCHMARK_CAPTURE(separations_in_a_batch, apart, false);
BENCHMARK_CAPTURE(find_touching_in_a_batch, touching, true);
BENCHMARK_CAPTURE(find_touching_in_a_batch, apart, false);
BENCHMARK_CAPTURE(force, potential/flat, Law::potential, false, flat);
BENCHMARK_CAPTURE(force, potential/aligned, Law::potential, false, aligned);
BENCHMARK_CAPTURE(force, potential/corner, Law::potential, false, corner);
BENCHMARK_CAPTURE(force, potential/near, Law::potential, false, near_miss);
BENCHMARK_CAPTURE(force, potential/far, Law::potential, false, far_away);
BENCHMARK_CAPTURE(force, potential_elastic/flat, Law::potential, true, flat);
BENCHMARK_CAPTURE(force, potential_elastic/aligned, Law::potential, true, aligned);
BENCHMARK_CAPTURE(force, potential_elastic/corner, Law::potential, true, corner);
BENCHMARK_CAPTURE(force, points/flat, Law::points, false, flat);
BENCHMARK_CAPTURE(force, points/aligned, Law::points, false, aligned);
BENCHMARK_CAPTURE(force, points/corner, Law::points, false, corner);
BENCHMARK_CAPTURE(force, points/near, Law::points, false, near_miss);
BENCHMARK_CAPTURE(query, exact/flat, Model::exact, flat);
BENCHMARK_CAPTURE(query, exact/aligned, Model::exact, aligned);
BENCHMARK_CAPTURE(query, exact/corner, Model::exact, corner);
BENCHMARK_CAPTURE(query, exact/near, Model::exact, near_miss);
BENCHMARK_CAPTURE(query, committee/flat, Model::committee, flat);
BENCHMARK_CAPTURE(query, committee/corner, Model::committee, corner);
BENCHMARK_CAPTURE(separation_of, flat, flat);
BENCHMARK_CAPTURE(possible_pieces_of, flat, flat);

}  // namespace
}  // namespace quayside::contact_nn
